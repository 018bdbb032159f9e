// Noise map over speed and interference with the current point, and advice on ending the noise.
import { api } from "../api.js";
import { made } from "../dom.js";

const AGAIN = 500, AFTER = 1000; // ms
const FIRST = 3, WORK = [1, 3, 9]; // expected duration of the coarsest map [s]; relative durations of the maps
const SEARCH = 10; // expected duration of advice [s]
const QUESTION = "What would end the noise?";

export class Chart {
  constructor(panel, design) {
    this.design = design;
    this.box = made("div", { className: "chart" });
    this.said = made("p", { className: "soft" });
    this.progress = made("progress", { max: 1, ariaLabel: "Map", hidden: true });
    this.took = { map: FIRST, search: SEARCH }; // [s]
    this.ask = made("button", { type: "button", textContent: QUESTION, onclick: () => this.help() });
    this.helps = made("ul", { className: "helps" });
    panel.append(made("section", { className: "shown" }, made("h2", { textContent: "Map" }), this.box, this.progress, this.said),
      made("section", {}, made("h2", { textContent: "What to change" }), made("div", { className: "tools" }, this.ask), this.helps));
  }

  // Update the map after a change of the design.
  changed() {
    clearTimeout(this.later);
    this.following = null;
    this.box.classList.toggle("old", this.box.hasChildNodes());
    this.helps.replaceChildren();
    this.progress.hidden = true;
    this.said.textContent = `Map updates about ${Math.ceil(this.took.map)} s after the last change.`;
    this.later = setTimeout(() => this.#follow(), AFTER);
    this.point();
  }

  // Request a coarse map first, then finer ones.
  async #follow() {
    const stated = this.design.stated(), mine = this.following = {};
    const wanted = () => mine === this.following && !this.design.hidden();
    for (const [detail, work] of WORK.entries()) {
      const words = detail ? `${this.legend} Computing a finer map` : "Computing the map";
      const answer = await asked("design/chart", { ...stated, detail }, wanted, (since) => {
        const all = this.took.map * work;
        Object.assign(this.progress, { hidden: false, value: Math.min(0.95, since / all) });
        this.said.textContent = `${words}: ${left(all, since)}`;
      });
      if (!answer) return;
      this.progress.hidden = true;
      this.said.textContent = answer.error;
      if (!answer.found) return;
      this.took.map = Math.max(0.5, answer.took / work);
      this.legend = `${answer.found.legend}.`;
      this.box.classList.remove("old");
      this.box.innerHTML = answer.found.html; // as on pages
      this.point();
    }
    this.said.textContent = `${this.legend} At constant speed, for this support and temperature; partly simulated, partly from stability analysis.`;
  }

  // Show the current point on the map.
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
    const stated = this.design.stated(), mine = this.helping = {}, { speed: heard, controls: { values } } = this.design;
    const about = values.get("motion") === "constant" || !heard ? stated : { ...stated, speed: Number(heard.toFixed(2)) };
    const wanted = () => mine === this.helping && JSON.stringify(stated) === JSON.stringify(this.design.stated());
    this.ask.disabled = true;
    const answer = await asked("design/helps", about, wanted, (since) => {
      this.ask.textContent = `Searching: ${left(this.took.search, since)}`;
    });
    this.ask.disabled = false;
    this.ask.textContent = QUESTION;
    if (!answer) return;
    this.took.search = Math.max(1, answer.took);
    this.helps.replaceChildren(...(answer.found ? this.#offers(answer.found, stated) : [made("li", { textContent: answer.error })]));
  }

  #offers({ noise, speed_rad_s: speed, changes }, stated) {
    const at = `at a constant ${Number(speed.toPrecision(3))} rad/s`, { declared, values } = this.design.controls;
    if (!changes.length) {
      const isNoise = ["creak", "squawk", "squeal"].includes(noise);
      return [made("li", { textContent: isNoise ? `No single change of a plausible size ends the ${noise} ${at}.` : `There is no noise to end ${at}.` })];
    }
    return changes.map(({ name, factor }) => {
      const key = { support_stiffness: "support", interference: "interference" }[name] ?? `change.${name}`;
      const percent = 100 * (factor - 1), value = Number((values.get(key) * factor).toPrecision(4));
      const textContent = `${declared.get(key).label} ${percent > 0 ? "+" : "−"}${Math.abs(percent).toFixed(1)} %`;
      const press = made("button", { type: "button", textContent, onclick: () => this.design.put({ ...stated, values: { ...stated.values, [key]: value } }) });
      return made("li", {}, press, ` ends the ${noise} ${at}`);
    });
  }
}

const left = (all, since) => (since < all ? `about ${Math.ceil(all - since)} s left` : `${Math.floor(since)} s so far, longer than expected`);

// Poll until the answer is known or no longer wanted; `tell` gets the elapsed time [s].
async function asked(path, stated, wanted, tell) {
  const began = performance.now(), since = () => (performance.now() - began) / 1000;
  while (wanted()) {
    tell(since());
    const answer = await api(path, stated, () => {}).catch((error) => ({ known: true, found: null, error: error.message }));
    if (answer.known) return wanted() ? { ...answer, took: since() } : null;
    await new Promise((resolve) => { setTimeout(resolve, AGAIN); });
  }
  return null;
}
