// Jury view: setup, blind voting, result.
import { made, stylesheet } from "../dom.js";
import { Result } from "./result.js";
import { Setup } from "./setup.js";
import { Voting } from "./voting.js";

export function mount(panel) {
  stylesheet(new URL("./jury.css", import.meta.url));
  const parts = ["setup", "voting", "result"].map((name) => made("section", { className: `jury ${name}`, hidden: true }));
  panel.replaceChildren(...parts);
  const show = (shown) => { for (const part of parts) part.hidden = part !== shown; panel.scrollTop = 0; };
  const goes = {
    async setup() { show(parts[0]); await setup.open(); },
    async voting(jury) { setup.clear(); result.clear(); show(parts[1]); await voting.open(jury); },
    async result(jury) { show(parts[2]); await result.open(jury); },
  };
  const setup = new Setup(parts[0], goes);
  const voting = new Voting(parts[1], goes);
  const result = new Result(parts[2], goes);
  document.addEventListener("view-shown", ({ detail }) => { if (detail !== "jury") voting.player.stop(); });
  goes.setup();
  return { voting };
}
