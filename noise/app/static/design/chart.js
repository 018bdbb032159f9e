// Noise map over speed and interference with the current point.
import { api } from "../api.js";
import { made } from "../dom.js";

const AGAIN = 500, AFTER = 1000; // ms
const DETAILS = 3; // maps, from coarse to fine
const LEAST_SHARE = 0.1; // share of the work from which the time left is estimated

export class Chart {
  constructor(panel, design) {
    this.design = design;
    this.box = made("div", { className: "chart" });
    this.said = made("p", { className: "soft" });
    this.progress = made("progress", { max: 1, ariaLabel: "Map", hidden: true });
    panel.append(made("section", { className: "shown" }, made("h2", { textContent: "Map" }), this.box, this.progress, this.said));
  }

  // Update the map after a change of the design.
  changed() {
    clearTimeout(this.later);
    this.following = null;
    this.box.classList.toggle("old", this.box.hasChildNodes());
    this.progress.hidden = true;
    this.said.textContent = this.box.hasChildNodes() ? "Map of the previous design; it updates after the last change." : "Map follows after the last change.";
    this.later = setTimeout(() => this.#follow(), AFTER);
    this.point();
  }

  // Request a coarse map first, then finer ones.
  async #follow() {
    const stated = this.design.stated(), mine = this.following = {};
    const wanted = () => mine === this.following && !this.design.hidden();
    for (let detail = 0; detail < DETAILS; detail++) {
      const words = detail ? `${this.legend} Computing a finer map` : "Computing the map";
      const answer = await asked("design/chart", { ...stated, detail }, wanted, (since, share) => {
        Object.assign(this.progress, { hidden: false, value: share });
        this.said.textContent = `${words}: ${left(since, share)}`;
      });
      if (!answer) return;
      this.progress.hidden = true;
      this.said.textContent = answer.error;
      if (!answer.found) return;
      this.legend = `${answer.found.legend}.`;
      this.box.classList.remove("old");
      this.box.innerHTML = answer.found.html; // as on pages
      const isPreview = detail < DETAILS - 1; // near its boundaries it may differ from what is heard
      this.box.classList.toggle("preview", isPreview);
      if (isPreview) this.box.querySelector(".plot").append(made("p", { className: "uncertain", textContent: "Preview" }));
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
}

// Time left at the rate so far; too little done says nothing of it.
const left = (since, share) => (share < LEAST_SHARE ? `${Math.floor(since)} s so far` : `about ${Math.ceil(since * (1 - share) / share)} s left`);

// Poll until the answer is known or no longer wanted; `tell` gets the elapsed time [s] and the share that is done.
async function asked(path, stated, wanted, tell) {
  const began = performance.now(), since = () => (performance.now() - began) / 1000;
  tell(0, 0);
  while (wanted()) {
    const answer = await api(path, stated, () => {}).catch((error) => ({ known: true, found: null, error: error.message }));
    if (answer.known) return wanted() ? answer : null;
    if (wanted()) tell(since(), answer.share);
    await new Promise((resolve) => { setTimeout(resolve, AGAIN); });
  }
  return null;
}
