// Result of a jury: table of values and 95 % intervals, with bars on a common axis.
import { api } from "../api.js";
import { made } from "../dom.js";

const HEADS = ["Sound", "Value", "95 % interval", "On the scale", "Chosen", "Not chosen", "No difference"];
const MEANS = "The mean is 0. If two values differ by 1.1, the higher sound is chosen three times in four; by 2.2, nine times in ten. The intervals describe these votes, not how other people would vote.";

export class Result {
  constructor(element, goes) {
    this.title = made("h2", { tabIndex: -1 });
    this.facts = made("p", { className: "soft" });
    this.words = made("p", { className: "words" });
    this.means = made("p", { className: "soft", textContent: MEANS });
    this.rows = made("tbody");
    this.table = made("div", { className: "table", tabIndex: 0, role: "region", ariaLabel: "Scale as a table" },
      made("table", {}, made("thead", {}, made("tr", {}, ...HEADS.map((textContent) => made("th", { scope: "col", textContent })))), this.rows));
    this.on = made("button", { type: "button", textContent: "Go on voting", onclick: () => goes.voting(this.number) });
    const back = made("button", { type: "button", textContent: "To all juries", onclick: () => goes.setup() });
    this.named = made("p", { className: "soft", textContent: "You have seen the names: further votes are no longer blind." });
    element.append(this.title, this.words, this.facts, this.table, this.means, made("div", { className: "line" }, this.on, back), this.named);
  }

  async open(number) {
    this.number = number;
    const found = await api(`juries/${number}/result`);
    if (number !== this.number) return; // outdated
    this.title.textContent = found.question;
    this.facts.textContent = [found.listener, `played at ${found.played}`, `${found.voted} of ${found.total} comparisons voted`].filter(Boolean).join(" · ");
    this.words.textContent = found.words;
    this.table.hidden = this.means.hidden = !found.voted;
    const placed = found.sounds.filter(({ value }) => value !== null);
    const low = Math.min(...placed.map((one) => one.low_95)), high = Math.max(...placed.map((one) => one.high_95));
    const share = (value) => (100 * (value - low)) / (high - low || 1);
    this.rows.replaceChildren(...found.sounds.map((one) => {
      const isPlaced = one.value !== null, bar = made("span", { className: "scale", ariaHidden: "true" });
      if (isPlaced) {
        const [interval, value] = [made("i"), made("b")];
        Object.assign(interval.style, { left: `${share(one.low_95)}%`, width: `${share(one.high_95) - share(one.low_95)}%` });
        value.style.left = `${share(one.value)}%`;
        bar.append(interval, value);
      }
      const numbers = [words(one.value), isPlaced ? `${words(one.low_95)} to ${words(one.high_95)}` : "", bar, one.chosen, one.not_chosen, one.no_difference];
      return made("tr", {}, made("th", { scope: "row", textContent: one.sound }), ...numbers.map((text) => made("td", {}, text)));
    }));
    this.on.hidden = this.named.hidden = found.voted === found.total;
    this.title.focus();
  }

  clear() {
    this.number = null;
    for (const part of [this.rows, this.words]) part.replaceChildren();
  }
}

const words = (value) => (value === null ? "not compared" : value.toFixed(2).replace("-", "−"));
