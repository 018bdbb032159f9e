// What is kept of a design.
import { api, told } from "../api.js";
import { made } from "../labels/list.js";

export class Saving {
  constructor(panel, design) {
    this.design = design;
    const name = made("input", { id: "design-name", type: "text", value: "design", spellcheck: false, autocomplete: "off" });
    const save = made("button", { type: "button", className: "save", textContent: "Save rig file" });
    this.said = made("p", { className: "saved", role: "status" });
    this.name = name;
    save.addEventListener("click", () => this.rig());
    name.addEventListener("input", () => { this.again = null; });
    panel.append(made("section", { className: "saving" },
      made("h2", { textContent: "Keep it" }),
      made("div", { className: "tools" }, made("label", { htmlFor: "design-name", textContent: "Name" }), name, save), this.said));
  }

  async rig() {
    const name = this.name.value.trim();
    try {
      const found = await api("design/rig", { ...this.design.stated(), name, replace: this.again === name });
      this.said.textContent = `Saved as ${found.file}; ${found.command}`;
      this.again = name;
    } catch (error) {
      this.said.textContent = error.message;
      this.again = /is there already/.test(error.message) ? name : null;
      told("");
    }
  }
}
