// Setup of a jury: sounds, question, playback; or continuation of an earlier one.
import { api } from "../api.js";
import { made } from "../dom.js";

const KINDS = ["all", "creak", "squawk", "squeal", "none", "unknown", "unlabelled"];
const AT_FIRST = 8; // maximum number of sounds chosen at first
const SECONDS = 10; // typical duration of a comparison

export class Setup {
  constructor(element, goes) {
    this.goes = goes;
    this.element = element;
    this.asked = 0; // number of the newest list request
    this.chosen = null; // ids
    this.shown = [];
    this.#build(element);
  }

  #build(element) {
    const field = (label, box) => made("label", {}, `${label} `, box);
    this.going = made("ul", { className: "going" });
    this.goingOn = made("section", { hidden: true }, made("h2", { textContent: "Go on" }), this.going);
    this.question = made("input", { type: "text", value: "Which annoys more?", maxLength: 200, className: "wide" });
    this.listener = made("input", { type: "text", maxLength: 200, placeholder: "optional" });
    this.kind = made("select", { onchange: () => this.#list() }, ...KINDS.map((kind) => made("option", { value: kind === "all" ? "" : kind, textContent: kind })));
    this.find = made("input", { type: "search", placeholder: "by name", oninput: () => { clearTimeout(this.wait); this.wait = setTimeout(() => this.#list(), 150); } });
    this.sounds = made("ul", { className: "sounds" });
    const all = made("button", { type: "button", textContent: "All shown", onclick: () => { for (const { id } of this.shown) this.chosen.add(id); this.#draw(); } });
    const none = made("button", { type: "button", textContent: "None", onclick: () => { this.chosen.clear(); this.#draw(); } });
    this.count = made("output", { className: "count" });
    this.number = made("input", { type: "number", step: 1, oninput: () => { this.wanted = Number(this.number.value); this.#tell(); } });
    this.begin = made("button", { type: "button", className: "begin", textContent: "Begin", disabled: true, onclick: () => this.#begin() });
    this.plan = made("p", { className: "plan", role: "status" });
    element.append(this.goingOn, made("section", {},
      made("h2", { textContent: "New jury" }),
      made("p", { className: "soft", textContent: "You hear two sounds at a time, without names and in random order, and choose one. Your votes place all sounds on a scale." }),
      made("div", { className: "fields" }, field("Question", this.question), field("Listener", this.listener)),
      made("fieldset", {}, made("legend", { textContent: "Sounds" }),
        made("div", { className: "line" }, field("With", this.kind), field("Find", this.find), all, none, this.count),
        this.sounds),
      made("div", { className: "line" }, field("Comparisons", this.number), this.begin, this.plan)));
  }

  async open() {
    const { juries, most, longest_s: longest } = await api("juries");
    if (this.element.hidden) return; // voting has started
    Object.assign(this, { most, longest });
    this.goingOn.hidden = !juries.length;
    this.going.replaceChildren(...juries.map((jury) => this.#jury(jury)).reverse());
    await this.#list();
  }

  // Remove all names during voting.
  clear() {
    clearTimeout(this.wait);
    this.sounds.replaceChildren();
  }

  #jury({ jury: number, question, listener, total, waiting, sounds, open }) {
    const facts = [`${number}. ${question}`, listener, `${sounds} sounds`, `${waiting ?? total} of ${total} voted`, open ? "" : "its sounds are not open"];
    const on = made("button", { type: "button", textContent: "Go on", ariaLabel: `Go on with jury ${number}`, disabled: !open, hidden: waiting === null, onclick: () => this.goes.voting(number) });
    const result = made("button", { type: "button", textContent: "Result", ariaLabel: `Result of jury ${number}`, onclick: () => this.goes.result(number) });
    return made("li", {}, made("span", { textContent: facts.filter(Boolean).join(" · ") }), on, result);
  }

  async #list() {
    const asked = ++this.asked;
    const query = new URLSearchParams({ label: this.kind.value, text: this.find.value });
    const { rows } = await api(`recordings?${query}`);
    if (asked !== this.asked || this.element.hidden) return;
    this.shown = rows;
    this.chosen ??= new Set(rows.slice(0, AT_FIRST).map(({ id }) => id));
    this.#draw();
  }

  #draw() {
    this.sounds.replaceChildren(...this.shown.map(({ id, name, labels }) => {
      const box = made("input", { type: "checkbox", checked: this.chosen.has(id), onchange: () => { this.chosen[box.checked ? "add" : "delete"](id); this.#tell(); } });
      return made("li", {}, made("label", {}, box, made("span", { textContent: name }), made("small", { textContent: labels.join(" + ") })));
    }));
    this.#tell();
  }

  #tell() {
    const { size } = this.chosen, pairs = (size * (size - 1)) / 2, least = Math.max(1, size - 1);
    this.count.textContent = `${size} chosen`;
    Object.assign(this.number, { min: least, max: pairs, disabled: size < 2 });
    const wanted = this.wanted ?? pairs, isPossible = wanted >= least && wanted <= pairs;
    if (document.activeElement !== this.number) this.number.value = isPossible ? wanted : pairs;
    if (!isPossible && document.activeElement !== this.number) this.wanted = undefined;
    this.begin.disabled = size < 2 || size > this.most || !this.number.validity.valid || this.number.value === "";
    const number = Number(this.number.value), minutes = Math.max(1, Math.round((number * SECONDS) / 60));
    if (!this.shown.length && !size) this.plan.textContent = "No recordings are open. Start the program with a folder of recordings: bushing-noise open FOLDER";
    else if (size < 2) this.plan.textContent = "Choose at least two sounds.";
    else if (size > this.most) this.plan.textContent = `Choose at most ${this.most} sounds.`;
    else if (this.begin.disabled) this.plan.textContent = `${size} sounds need ${least} to ${pairs} comparisons.`;
    else this.plan.textContent = `About ${minutes} min${number < pairs ? `; ${pairs} would compare all pairs` : ", every pair once"}. You can stop and go on later. Sounds are cut to ${this.longest} s.`;
  }

  async #begin() {
    this.element.inert = true; // while all sounds are measured
    this.plan.textContent = "Measuring the sounds ...";
    try {
      const { jury } = await api("juries", { sounds: [...this.chosen], comparisons: Number(this.number.value), question: this.question.value, listener: this.listener.value });
      await this.goes.voting(jury);
    } finally {
      this.element.inert = false;
      this.#tell();
    }
  }
}
