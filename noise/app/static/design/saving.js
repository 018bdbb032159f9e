// What is kept of a design: a rig file, both designs as WAVs, or as a page to send.
import { api } from "../api.js";
import { made } from "../dom.js";

const AGAIN = 500; // ms

export class Saving {
  constructor(panel, design) {
    this.design = design;
    this.name = made("input", { id: "design-name", type: "text", value: "design", spellcheck: false, autocomplete: "off" });
    this.seconds = made("input", { id: "design-seconds", type: "number", value: 4, min: 0.5, max: 60, step: "any" });
    this.said = made("p", { className: "saved", role: "status" });
    const button = (textContent, does) => {
      const made_ = made("button", { type: "button", textContent });
      made_.addEventListener("click", does);
      return made_;
    };
    this.name.addEventListener("input", () => { this.again = ""; });
    panel.append(made("section", { className: "saving" },
      made("h2", { textContent: "Keep it" }),
      made("div", { className: "tools" }, made("label", { htmlFor: "design-name", textContent: "Name" }), this.name, button("Save rig file", () => this.#rig())),
      made("div", { className: "tools" }, made("label", { htmlFor: "design-seconds", textContent: "Seconds" }), this.seconds,
        button("Save A and B as WAVs", () => this.#set(false)), button("Make a page to send", () => this.#set(true))),
      this.said));
  }

  #rig() {
    return this.#kept("rig", "design/rig", this.design.stated(), ({ file, command }) => { this.said.textContent = `Saved as ${file}; ${command}`; });
  }

  #set(page) {
    const asked = { designs: this.design.both(), seconds: Number(this.seconds.value), page };
    return this.#kept(page ? "page" : "set", "design/set", asked, (state) => this.#follow(state));
  }

  async #follow(state) {
    for (; state.running; state = await api("design/set")) {
      this.said.textContent = `Being made: ${state.done} of ${state.total} steps`;
      await new Promise((resolve) => { setTimeout(resolve, AGAIN); });
    }
    this.said.textContent = state.error ? `Not made: ${state.error}` : `Saved as ${state.result}`;
  }

  // A name that is taken is written over where it is said a second time.
  async #kept(what, path, asked, then) {
    const name = this.name.value.trim(), key = `${what} ${name}`;
    try {
      const found = await api(path, { ...asked, name, replace: this.again === key }, () => {});
      this.again = "";
      await then(found);
    } catch (error) {
      this.said.textContent = error.message;
      this.again = /is there already/.test(error.message) ? key : "";
    }
  }
}
