// Which noise is where over speed and interference, the point that is heard in it, and what would end its noise.
import { api } from "../api.js";
import { made } from "../dom.js";

const SVG = "http://www.w3.org/2000/svg", AGAIN = 700, AFTER = 1000; // ms
const WIDTH = 400, HEIGHT = 136, LEFT = 46, ABOVE = 8, BELOW = 30;
const MARKS = { creak: "Cr", squawk: "Sk", squeal: "Sl", none: "", unknown: "?" };

export class Chart {
  constructor(panel, design) {
    this.design = design;
    this.box = made("div", { className: "chart" });
    this.said = made("p", { className: "soft", textContent: "The map comes when nothing has changed for a second." });
    this.ask = made("button", { type: "button", textContent: "What would end the noise?" });
    this.helps = made("ul", { className: "helps" });
    this.ask.addEventListener("click", () => this.help());
    panel.append(made("section", { className: "shown" }, made("h2", { textContent: "Map" }), this.box, this.said),
      made("section", {}, made("h2", { textContent: "What to change" }), made("div", { className: "tools" }, this.ask), this.helps));
  }

  // A design has changed: the map follows when there is time.
  changed() {
    clearTimeout(this.later);
    this.box.classList.toggle("old", Boolean(this.known));
    this.helps.replaceChildren();
    this.later = setTimeout(() => this.#follow(), AFTER);
    this.point();
  }

  async #follow() {
    const stated = this.design.stated(), mine = this.following = {};
    const answer = await asked("design/chart", stated, () => mine === this.following && !this.design.hidden());
    if (!answer) return;
    this.said.textContent = answer.error || "Cr creak, Sk squawk, Sl squeal, blank no noise: at constant speed, at this support and temperature; simulated at some points, told by stability at others.";
    if (answer.found) this.#draw(answer.found);
  }

  #draw(found) {
    this.known = found;
    this.box.classList.remove("old");
    const { speed_rad_s: speeds, interference_mm: fits, labels, levels_dba: levels } = found;
    const svg = node("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": summary(found) });
    const xs = edges(speeds), ys = edges(fits.length > 1 ? fits : [fits[0] * 0.9, fits[0] * 1.1]);
    this.x = (speed) => LEFT + (WIDTH - LEFT - 4) * Math.min(1, Math.max(0, (speed - xs[0]) / (xs.at(-1) - xs[0])));
    this.y = (fit) => ABOVE + (HEIGHT - ABOVE - BELOW) * (1 - Math.min(1, Math.max(0, (fit - ys[0]) / (ys.at(-1) - ys[0]))));
    labels.forEach((row, j) => row.forEach((label, i) => {
      const y = fits.length > 1 ? [ys[j], ys[j + 1]] : [ys[0], ys.at(-1)];
      const left = this.x(xs[i]), width = this.x(xs[i + 1]) - left, top = this.y(y[1]), height = this.y(y[0]) - top;
      const cell = node("rect", { x: left, y: top, width: width + 0.3, height: height + 0.3, class: `cell ${label}` });
      const level = levels[j][i] === null ? "" : `, ${levels[j][i]} dB(A)`;
      cell.append(node("title", {}, `${label} at ${speeds[i].toFixed(1)} rad/s, ${fits[j]} mm${level}`));
      svg.append(cell);
      if (MARKS[label]) svg.append(node("text", { x: left + width / 2, y: top + height / 2 + 3, class: `mark ${label}` }, MARKS[label]));
    }));
    const top = speeds.at(-1);
    for (const speed of [0, 2, 4, 6, 8, 10, 12, 16, 20].filter((one) => one <= top)) svg.append(node("text", { x: this.x(speed), y: HEIGHT - 17, class: "tick" }, String(speed)));
    svg.append(node("text", { x: (LEFT + WIDTH) / 2, y: HEIGHT - 4, class: "tick" }, "speed, rad/s"));
    for (const fit of [fits[0], fits.at(-1)]) svg.append(node("text", { x: LEFT - 4, y: this.y(fit) + 4, class: "tick end" }, fit.toFixed(3)));
    svg.append(node("text", { x: LEFT - 4, y: (HEIGHT - BELOW) / 2 + 4, class: "tick end" }, "mm"));
    this.dot = node("circle", { r: 5, class: "here" });
    svg.append(this.dot);
    this.box.replaceChildren(svg);
    this.point();
  }

  // Where on the map it is.
  point() {
    if (!this.dot) return;
    const at = {
      cx: this.x(Math.abs(this.design.speed ?? this.design.controls.values.get("speed"))).toFixed(1),
      cy: this.y(this.design.controls.values.get("interference")).toFixed(1),
    };
    for (const [key, value] of Object.entries(at)) if (this.dot.getAttribute(key) !== value) this.dot.setAttribute(key, value);
  }

  async help() {
    const stated = this.design.stated(), mine = this.helping = {}, heard = this.design.speed;
    const constant = this.design.controls.values.get("motion") === "constant";
    this.helps.replaceChildren(made("li", { textContent: "Being simulated, some seconds ..." }));
    const answer = await asked("design/helps", constant || !heard ? stated : { ...stated, speed: Number(heard.toFixed(2)) }, () => mine === this.helping && JSON.stringify(stated) === JSON.stringify(this.design.stated()));
    if (!answer) return;
    if (!answer.found) {
      this.helps.replaceChildren(made("li", { textContent: answer.error }));
      return;
    }
    const { noise, speed_rad_s: speed, changes } = answer.found, at = `turning evenly at ${Number(speed.toPrecision(3))} rad/s`;
    if (!changes.length) {
      const why = ["creak", "squawk", "squeal"].includes(noise) ? `No single change within reason ends the ${noise}, ${at}.` : `There is no noise, ${at}.`;
      this.helps.replaceChildren(made("li", { textContent: why }));
      return;
    }
    this.helps.replaceChildren(...changes.map(({ name, factor, steady }) => {
      const key = { support_stiffness: "support", interference: "interference" }[name] ?? `change.${name}`;
      const { label, unit } = this.design.controls.declared.get(key), percent = 100 * (factor - 1);
      const text = `${label} ${percent > 0 ? "+" : "−"}${Math.abs(percent).toFixed(1)} %`;
      const press = made("button", { type: "button", textContent: text });
      press.addEventListener("click", () => {
        const value = this.design.controls.values.get(key) * factor;
        this.design.put({ ...stated, values: { ...stated.values, [key]: Number(value.toPrecision(4)) } });
      });
      return made("li", {}, press, ` ends the ${noise}, ${at}${steady ? "" : "; a little more brings it back"}`);
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

function node(name, attributes, text = "") {
  const made_ = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made_.setAttribute(key, value);
  if (text) made_.textContent = text;
  return made_;
}

function edges(values) {
  const inner = values.slice(1).map((value, i) => (value + values[i]) / 2);
  return [values[0], ...inner, values.at(-1)];
}

function summary({ labels }) {
  const all = labels.flat(), share = (label) => Math.round(100 * all.filter((one) => one === label).length / all.length);
  const found = ["creak", "squawk", "squeal", "none"].filter((label) => share(label)).map((label) => `${label} ${share(label)} %`);
  return `Noise over speed and interference: ${found.join(", ")} of the map`;
}
