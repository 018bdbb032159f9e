// Begin a jury, or go on with one: which sounds, what is asked, how they are played.
import { api } from "../api.js";
import { made } from "../dom.js";

const KINDS = ["all", "creak", "squawk", "squeal", "none", "unknown", "unlabelled"];
const AT_FIRST = 12; // sounds that are chosen to begin with
const SECONDS = 10; // that a comparison takes, about

export class Setup {
  constructor(element, goes) {
    this.goes = goes;
    this.element = element;
    this.asked = 0; // counts lists: one that was asked for before comes too late
    this.chosen = null; // ids
    this.shown = [];
    this.#build(element);
  }

  #build(element) {
    const field = (label, box) => made("label", {}, `${label} `, box);
    this.going = made("ul", { className: "going" });
    this.goingOn = made("section", { hidden: true }, made("h2", { textContent: "Go on" }), this.going);
    this.question = made("input", { type: "text", value: "Which annoys more?", maxLength: 200, className: "wide" });
    this.listener = made("input", { type: "text", maxLength: 200, placeholder: "may stay empty" });
    this.played = made("select", {},
      made("option", { value: "one gain", textContent: "as recorded, all at one gain" }),
      made("option", { value: "equal loudness", textContent: "at equal loudness" }));
    this.kind = made("select", {}, ...KINDS.map((kind) => made("option", { value: kind === "all" ? "" : kind, textContent: kind })));
    this.find = made("input", { type: "search", placeholder: "name holds ..." });
    this.sounds = made("ul", { className: "sounds" });
    const all = made("button", { type: "button", textContent: "All shown" });
    const none = made("button", { type: "button", textContent: "None" });
    this.count = made("output", { className: "count" });
    this.begin = made("button", { type: "button", className: "begin", textContent: "Begin", disabled: true });
    this.plan = made("p", { className: "plan", role: "status" });
    element.append(this.goingOn, made("section", {},
      made("h2", { textContent: "New jury" }),
      made("p", { className: "soft", textContent: "You hear two sounds at a time, without names and in random order, and choose one. The votes give each sound a place on a scale." }),
      made("div", { className: "fields" }, field("Question", this.question), field("Listener", this.listener), field("Played", this.played)),
      made("fieldset", {}, made("legend", { textContent: "Sounds" }),
        made("div", { className: "line" }, field("With", this.kind), field("Find", this.find), all, none, this.count),
        this.sounds),
      made("div", { className: "line" }, this.begin, this.plan)));
    this.find.addEventListener("input", () => { clearTimeout(this.wait); this.wait = setTimeout(() => this.#list(), 150); });
    this.kind.addEventListener("change", () => this.#list());
    all.addEventListener("click", () => { for (const { id } of this.shown) this.chosen.add(id); this.#draw(); });
    none.addEventListener("click", () => { this.chosen.clear(); this.#draw(); });
    this.begin.addEventListener("click", () => this.#begin());
  }

  async open() {
    const { juries, most, longest_s: longest } = await api("juries");
    if (this.element.hidden) return; // somebody votes
    Object.assign(this, { most, longest });
    this.goingOn.hidden = !juries.length;
    this.going.replaceChildren(...juries.map((jury) => this.#jury(jury)).reverse());
    await this.#list();
  }

  // While somebody votes no name is in the page.
  clear() {
    clearTimeout(this.wait);
    this.sounds.replaceChildren();
  }

  #jury({ jury: number, question, listener, total, waiting, sounds, open }) {
    const facts = [`${number}. ${question}`, listener, `${sounds} sounds`, `${waiting ?? total} of ${total} voted`, open ? "" : "its sounds are not open"];
    const on = made("button", { type: "button", textContent: "Go on", ariaLabel: `Go on with jury ${number}`, disabled: !open, hidden: waiting === null });
    const result = made("button", { type: "button", textContent: "Result", ariaLabel: `Result of jury ${number}` });
    on.addEventListener("click", () => this.goes.voting(number));
    result.addEventListener("click", () => this.goes.result(number));
    return made("li", {}, made("span", { textContent: facts.filter(Boolean).join(" · ") }), on, result);
  }

  async #list() {
    const asked = ++this.asked;
    const query = new URLSearchParams({ label: this.kind.value, text: this.find.value, count: 1000 });
    const { rows, total } = await api(`recordings?${query}`);
    if (asked !== this.asked || this.element.hidden) return;
    this.shown = rows;
    this.more = total - rows.length; // are not shown
    this.chosen ??= new Set(rows.slice(0, AT_FIRST).map(({ id }) => id));
    this.#draw();
  }

  #draw() {
    this.sounds.replaceChildren(...this.shown.map(({ id, name, labels }) => {
      const box = made("input", { type: "checkbox", checked: this.chosen.has(id) });
      box.addEventListener("change", () => { this.chosen[box.checked ? "add" : "delete"](id); this.#tell(); });
      return made("li", {}, made("label", {}, box, made("span", { textContent: name }), made("small", { textContent: labels.join(" + ") })));
    }));
    this.#tell();
  }

  #tell() {
    const { size } = this.chosen, pairs = (size * (size - 1)) / 2;
    this.count.textContent = `${size} chosen${this.more ? `; ${this.more} recordings are not shown, find them by name` : ""}${size > this.most ? `: at most ${this.most} can be compared` : ""}`;
    this.begin.disabled = size < 2 || size > this.most;
    this.plan.textContent = size < 2 ? "Choose two sounds or more; they are the recordings that were opened."
      : `${pairs} comparisons, about ${Math.max(1, Math.round((pairs * SECONDS) / 60))} min; whoever stops goes on later. Of each sound at most ${this.longest} s are heard.`;
  }

  async #begin() {
    this.element.inert = true; // all sounds are measured first
    this.plan.textContent = "The sounds are being measured.";
    try {
      const { jury } = await api("juries", { sounds: [...this.chosen], question: this.question.value, listener: this.listener.value, played: this.played.value });
      await this.goes.voting(jury);
    } finally {
      this.element.inert = false;
      this.#tell();
    }
  }
}
