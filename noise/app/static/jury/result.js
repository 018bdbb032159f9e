// What a jury has said: scale, table, and when to distrust them.
import { api } from "../api.js";
import { made } from "../labels/list.js";
import { drawScale } from "./chart.js";

const HEADS = ["Sound", "Value", "95 % interval", "Chosen", "Not chosen", "No difference"];
const MEANS = "Mean 0. Of two sounds whose values differ by 1.1 the higher is chosen three times in four, by 2.2 nine in ten. Intervals say how surely these votes place a sound, not how others would vote.";

export class Result {
  constructor(element, goes) {
    this.goes = goes;
    this.title = made("h2", { tabIndex: -1 });
    this.facts = made("p", { className: "soft" });
    this.remarks = made("ul", { className: "remarks" });
    this.svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    this.svg.setAttribute("role", "img");
    const figure = made("figure", {}, this.svg, made("figcaption", { textContent: MEANS }));
    this.rows = made("tbody");
    this.box = made("div", { className: "table", tabIndex: 0 },
      made("table", {}, made("thead", {}, made("tr", {}, ...HEADS.map((textContent) => made("th", { scope: "col", textContent })))), this.rows));
    this.box.setAttribute("role", "region");
    this.box.setAttribute("aria-label", "Scale as a table");
    this.on = made("button", { type: "button", textContent: "Go on voting" });
    this.on.addEventListener("click", () => goes.voting(this.number));
    const back = made("button", { type: "button", textContent: "To all juries" });
    back.addEventListener("click", () => goes.setup());
    this.file = made("a", { textContent: "Scale as CSV" });
    this.named = made("p", { className: "soft", textContent: "You have seen the names: what you vote from now on is no longer blind." });
    element.append(this.title, this.facts, this.remarks, figure, this.box, made("div", { className: "line" }, this.on, back, this.file), this.named);
    new ResizeObserver(() => { if (this.found && figure.clientWidth !== this.width) this.#draw(); }).observe(figure);
    this.figure = figure;
  }

  async open(number) {
    this.number = number;
    const found = await api(`juries/${number}/result`);
    if (number !== this.number) return; // another was asked for, or a vote, before this came
    this.found = found;
    this.title.textContent = found.question;
    this.facts.textContent = [found.listener, `played at ${found.played}`, ...found.facts].filter(Boolean).join(" · ");
    this.remarks.replaceChildren(...found.remarks.map((textContent) => made("li", { textContent })));
    this.remarks.hidden = !found.remarks.length;
    this.rows.replaceChildren(...found.sounds.map((one) => made("tr", {}, made("th", { scope: "row", textContent: one.sound }),
      ...[shown(one.value), one.value === null ? "" : `${shown(one.low_95)} to ${shown(one.high_95)}`, one.chosen, one.not_chosen, one.no_difference].map((text) => made("td", { textContent: text })))));
    this.on.hidden = this.named.hidden = found.voted === found.total;
    this.file.href = `api/juries/${number}/result.csv`;
    this.file.download = `jury-${number}.csv`;
    this.#draw();
    this.title.focus();
  }

  clear() {
    this.number = this.found = null;
    for (const part of [this.svg, this.rows, this.remarks]) part.replaceChildren();
  }

  #draw() {
    this.width = this.figure.clientWidth;
    drawScale(this.svg, this.found);
  }
}

const shown = (value) => (value === null ? "" : value.toFixed(2).replace("-", "−"));
