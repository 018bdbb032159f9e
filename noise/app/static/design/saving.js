// A design saved as a rig file.
import { api } from "../api.js";
import { made } from "../dom.js";

export class Saving {
  constructor(panel, design) {
    this.design = design;
    this.name = made("input", { id: "design-name", type: "text", value: "design", spellcheck: false, autocomplete: "off", oninput: () => { this.again = null; } });
    this.text = made("p", { className: "saved", role: "status" });
    const save = made("button", { type: "button", textContent: "Save rig file", onclick: () => this.#save() });
    panel.append(made("section", { className: "saving" }, made("h2", { textContent: "Save" }),
      made("div", { className: "tools" }, made("label", { htmlFor: "design-name", textContent: "Name" }), this.name, save), this.text));
  }

  // A name that is taken is written over where it is asked for a second time.
  async #save() {
    const name = this.name.value.trim();
    try {
      const { file, command } = await api("design/rig", { ...this.design.stated(), name, replace: this.again === name }, () => {});
      this.again = null;
      this.text.textContent = `Saved as ${file}. To simulate it: ${command}`;
    } catch (error) {
      this.text.textContent = error.message;
      this.again = /is there already/.test(error.message) ? name : null;
    }
  }
}
