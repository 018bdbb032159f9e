// What a press has dropped, and the way back. Going back can be undone as well.
import { made } from "../dom.js";

export class Undo {
  // `state` gives all that can be gone back to, `restore` goes there.
  constructor(panel, state, restore) {
    this.said = made("p", { role: "status" });
    this.button = made("button", { type: "button", hidden: true });
    this.button.addEventListener("click", async () => {
      const { before, again } = this.offered, now = state();
      await restore(before);
      this.offer(again ? "Redone." : "Undone.", now, !again);
    });
    panel.append(made("div", { className: "undo" }, this.said, this.button));
  }

  offer(text, before, again = false) {
    this.offered = { text, before, again };
    this.said.textContent = text;
    this.button.textContent = again ? "Redo" : "Undo";
    this.button.hidden = false;
  }
}
