// The scale that votes give: a point for each sound on its 95 % interval, and the same as a table.
import { api } from "../api.js";
import { drawn, made } from "../dom.js";

const HEADS = ["Sound", "Value", "95 % interval", "Chosen", "Not chosen", "No difference"];
const MEANS = "The mean is 0. If two values differ by 1.1, the higher sound is chosen three times in four; by 2.2, nine times in ten. The intervals describe these votes, not how other people would vote.";
const ROW = 26, TOP = 8, AXIS = 34, LETTER = 7.2, GAP = 10; // px
const STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10];

export class Result {
  constructor(element, goes) {
    this.title = made("h2", { tabIndex: -1 });
    this.facts = made("p", { className: "soft" });
    this.words = made("p", { className: "words" });
    this.remarks = made("ul", { className: "remarks" });
    this.svg = drawn("svg", { role: "img" });
    this.rows = made("tbody");
    const box = made("div", { className: "table", tabIndex: 0, role: "region", ariaLabel: "Scale as a table" },
      made("table", {}, made("thead", {}, made("tr", {}, ...HEADS.map((textContent) => made("th", { scope: "col", textContent })))), this.rows));
    this.on = made("button", { type: "button", textContent: "Go on voting" });
    this.on.addEventListener("click", () => goes.voting(this.number));
    const back = made("button", { type: "button", textContent: "To all juries" });
    back.addEventListener("click", () => goes.setup());
    this.file = made("a", { textContent: "Scale as CSV" });
    this.named = made("p", { className: "soft", textContent: "You have seen the names: further votes are no longer blind." });
    this.figure = made("figure", {}, this.svg, made("figcaption", { textContent: MEANS }));
    element.append(this.title, this.words, this.facts, this.remarks, this.figure, box, made("div", { className: "line" }, this.on, back, this.file), this.named);
    new ResizeObserver(() => { if (this.found && this.figure.clientWidth !== this.width) this.#draw(); }).observe(this.figure);
  }

  async open(number) {
    this.number = number;
    const found = await api(`juries/${number}/result`);
    if (number !== this.number) return; // another was asked for before this came
    this.found = found;
    this.title.textContent = found.question;
    this.facts.textContent = [found.listener, `played at ${found.played}`, `${found.voted} of ${found.total} comparisons voted`].filter(Boolean).join(" · ");
    this.words.textContent = found.words;
    this.remarks.replaceChildren(...found.remarks.map((textContent) => made("li", { textContent })));
    this.remarks.hidden = !found.remarks.length;
    this.rows.replaceChildren(...found.sounds.map((one) => made("tr", {}, made("th", { scope: "row", textContent: one.sound }),
      ...[words(one.value), one.value === null ? "" : `${words(one.low_95)} to ${words(one.high_95)}`, one.chosen, one.not_chosen, one.no_difference].map((text) => made("td", { textContent: text })))));
    this.on.hidden = this.named.hidden = found.voted === found.total;
    this.file.href = `api/juries/${number}/result.csv`;
    this.file.download = `jury-${number}.csv`;
    this.#draw();
    this.title.focus();
  }

  clear() {
    this.number = this.found = null;
    for (const part of [this.svg, this.rows, this.remarks, this.words]) part.replaceChildren();
  }

  #draw() {
    this.width = this.figure.clientWidth;
    const { svg } = this, placed = this.found.sounds.filter(({ value }) => value !== null);
    svg.replaceChildren();
    svg.toggleAttribute("hidden", !placed.length);
    if (!placed.length) return;
    const width = Math.max(200, this.width), height = TOP + placed.length * ROW + AXIS, bottom = height - AXIS;
    for (const [name, value] of Object.entries({ width, height, viewBox: `0 0 ${width} ${height}` })) svg.setAttribute(name, value);
    const letters = Math.min(Math.max(...placed.map(({ sound }) => sound.length)), Math.floor((0.4 * width) / LETTER));
    const left = letters * LETTER + GAP, right = width - 12;
    const low = Math.min(...placed.map((one) => one.low_95)), high = Math.max(...placed.map((one) => one.high_95));
    const x = (value) => left + ((value - low) / (high - low)) * (right - left);
    const step = STEPS.find((one) => ((right - left) / (high - low)) * one >= 44) ?? 20;
    for (let at = Math.ceil(low / step); at * step <= high; at++) {
      svg.append(drawn("line", { x1: x(at * step), x2: x(at * step), y1: TOP, y2: bottom, class: at ? "grid" : "zero" }),
        drawn("text", { x: x(at * step), y: bottom + 14, "text-anchor": "middle" }, `${Number((at * step).toFixed(1))}`.replace("-", "−")));
    }
    svg.append(drawn("text", { x: (left + right) / 2, y: bottom + 30, "text-anchor": "middle" }, "scale value"));
    for (const [at, one] of placed.entries()) {
      const y = TOP + (at + 0.5) * ROW;
      const name = one.sound.length > letters ? `${one.sound.slice(0, letters - 1)}…` : one.sound;
      svg.append(drawn("text", { x: left - GAP, y: y + 4, "text-anchor": "end" }, name),
        drawn("line", { x1: x(one.low_95), x2: x(one.high_95), y1: y, y2: y, class: "interval" }),
        drawn("circle", { cx: x(one.value), cy: y, r: 5 }));
    }
    svg.setAttribute("aria-label", `${this.found.question} Scale of ${placed.length} sounds with 95 % intervals, the same as in the table below`);
  }
}

const words = (value) => (value === null ? "" : value.toFixed(2).replace("-", "−"));
