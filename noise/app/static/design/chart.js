// Which noise is where over speed and interference, the point that is heard in it, and what would end its noise.
import { api } from "../api.js";
import { made } from "../dom.js";

const AGAIN = 700, AFTER = 1000; // ms
const USUAL = 30; // that the first map takes [s]

export class Chart {
  constructor(panel, design) {
    this.design = design;
    this.box = made("div", { className: "chart" });
    this.said = made("p", { className: "soft" });
    this.progress = made("progress", { max: 1, ariaLabel: "Map", hidden: true });
    this.took = USUAL;
    this.ask = made("button", { type: "button", textContent: "What would end the noise?", onclick: () => this.help() });
    this.helps = made("ul", { className: "helps" });
    panel.append(made("section", { className: "shown" }, made("h2", { textContent: "Map" }), this.box, this.progress, this.said),
      made("section", {}, made("h2", { textContent: "What to change" }), made("div", { className: "tools" }, this.ask), this.helps));
  }

  // A design has changed: the map follows when there is time.
  changed() {
    clearTimeout(this.later);
    this.box.classList.toggle("old", Boolean(this.known));
    this.helps.replaceChildren();
    this.later = setTimeout(() => this.#follow(), AFTER);
    if (!this.progress.hidden) return;
    this.said.textContent = `Map updates about ${Math.ceil(this.took)} s after the last change.`;
    this.point();
  }

  async #follow() {
    const stated = this.design.stated(), mine = this.following = {};
    const began = performance.now();
    const answer = await asked("design/chart", stated, () => {
      if (mine !== this.following || this.design.hidden()) return false;
      const since = (performance.now() - began) / 1000, left = Math.ceil(this.took - since);
      Object.assign(this.progress, { hidden: false, value: Math.min(0.95, since / this.took) });
      this.said.textContent = left > 0 ? `Computing the map: about ${left} s left.` : "Computing the map: it takes longer than expected.";
      return true;
    });
    if (!answer) return;
    this.progress.hidden = true;
    this.took = Math.max(2, (performance.now() - began) / 1000);
    this.said.textContent = answer.error || `${answer.found.legend}. At constant speed, for this support and temperature; partly simulated, partly from stability analysis.`;
    if (!answer.found) return;
    this.known = true;
    this.box.classList.remove("old");
    this.box.innerHTML = answer.found.html; // as pages have it
    this.point();
  }

  // Where on the map it is.
  point() {
    const map = this.box.querySelector(".map"), here = map?.querySelector(".asked");
    if (!here) return;
    const { values } = this.design.controls, at = { speed: Math.abs(this.design.speed ?? values.get("speed")), interference: values.get("interference") };
    const share = (key) => {
      const [low, high] = map.dataset[key].split(" ").map(Number);
      return `${(100 * Math.min(1, Math.max(0, (at[key] - low) / (high - low)))).toFixed(1)}%`;
    };
    here.hidden = false;
    Object.assign(here.style, { left: share("speed"), bottom: share("interference") });
  }

  async help() {
    const stated = this.design.stated(), mine = this.helping = {}, heard = this.design.speed;
    const constant = this.design.controls.values.get("motion") === "constant";
    this.ask.disabled = true;
    this.ask.textContent = "Searching, some seconds ...";
    const answer = await asked("design/helps", constant || !heard ? stated : { ...stated, speed: Number(heard.toFixed(2)) }, () => mine === this.helping && JSON.stringify(stated) === JSON.stringify(this.design.stated()));
    this.ask.disabled = false;
    this.ask.textContent = "What would end the noise?";
    if (!answer) return;
    if (!answer.found) {
      this.helps.replaceChildren(made("li", { textContent: answer.error }));
      return;
    }
    const { noise, speed_rad_s: speed, changes } = answer.found, at = `at a constant ${Number(speed.toPrecision(3))} rad/s`;
    if (!changes.length) {
      const why = ["creak", "squawk", "squeal"].includes(noise) ? `No single change of a plausible size ends the ${noise} ${at}.` : `There is no noise to end ${at}.`;
      this.helps.replaceChildren(made("li", { textContent: why }));
      return;
    }
    this.helps.replaceChildren(...changes.map(({ name, factor, steady }) => {
      const key = { support_stiffness: "support", interference: "interference" }[name] ?? `change.${name}`;
      const { label, unit } = this.design.controls.declared.get(key), percent = 100 * (factor - 1);
      const textContent = `${label} ${percent > 0 ? "+" : "−"}${Math.abs(percent).toFixed(1)} %`;
      const value = Number((this.design.controls.values.get(key) * factor).toPrecision(4));
      const press = made("button", { type: "button", textContent, onclick: () => this.design.put({ ...stated, values: { ...stated.values, [key]: value } }) });
      return made("li", {}, press, ` ends the ${noise} ${at}${steady ? "" : "; a slightly larger change brings it back"}`);
    }));
  }
}

// Ask until it is known, or nobody wants to know any more.
async function asked(path, stated, wanted) {
  while (wanted()) {
    const answer = await api(path, stated, () => {}).catch((error) => ({ known: true, found: null, error: error.message }));
    if (answer.known) return wanted() ? answer : null;
    await new Promise((resolve) => { setTimeout(resolve, AGAIN); });
  }
  return null;
}
