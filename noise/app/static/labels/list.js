// The list of recordings: filter, order, rows as they scroll into view, labels as they arrive.
import { api } from "../api.js";
import { made, onceShown } from "../dom.js";
import { fillRow } from "./list_row.js";

const PAGE = 200; // rows of one request
const ROW = 46; // height of a row [px], as in list.css
const BEYOND = 8; // rows drawn above and below what is seen
const POLL = 1000; // while labels arrive [ms]
const KINDS = { "": "all", creak: "creak", squawk: "squawk", squeal: "squeal", none: "none", unknown: "unknown", unlabelled: "without a label", corrected: "corrected", refused: "refused" };
const ALWAYS = ["", "creak", "squawk", "squeal", "none", "unknown"];
const ORDERS = [["", "as found"], ["name asc", "name"], ["label asc", "label"], ["frequency asc", "frequency, lowest first"], ["frequency desc", "frequency, highest first"], ["level desc", "level, loudest first"], ["duration desc", "duration, longest first"], ["least_sure desc", "least sure first"]];

let list = null;

// `onOpen` opens a recording, `onSeen` is told which version of its labels the table has.
export function mountList(element, { onOpen, onSeen }) {
  list = new RecordingList(element, onOpen, onSeen);
  list.load();
  return list;
}

// Take the list again, such as after a correction.
export async function refresh() { await list.load(); }

export function openRecording(id) { list.open(id); }

class RecordingList {
  constructor(element, onOpen, onSeen) {
    Object.assign(this, { onOpen, onSeen });
    this.label = "";
    this.total = 0;
    this.pages = new Map();
    this.asked = 0;
    this.at = 0; // where the keyboard is
    this.on = this.next = null; // numbers of the recording there, and of the one after it
    this.gone = false; // whether the keyboard is before the one that took its recording's place
    this.marked = null; // the one that is open
    this.#build(element);
  }

  #build(element) {
    this.find = made("input", { type: "search", placeholder: "name holds ...", ariaLabel: "Find by name" });
    this.order = made("select", { ariaLabel: "Order" });
    for (const [value, text] of ORDERS) this.order.append(made("option", { value, textContent: text }));
    this.kinds = made("div", { className: "kinds" });
    this.kinds.setAttribute("role", "group");
    this.kinds.setAttribute("aria-label", "Show recordings with");
    for (const [kind, text] of Object.entries(KINDS)) {
      const button = made("button", { type: "button", className: `kind ${kind}`, data: { kind } }, made("i"), `${text} `, made("span"));
      button.addEventListener("click", () => this.#ask(() => { this.label = this.label === kind ? "" : kind; }));
      this.kinds.append(button);
    }
    this.progress = made("progress", { ariaLabel: "Labelled", hidden: true });
    this.stateLine = made("span");
    this.labelButton = made("button", { type: "button", hidden: true });
    this.labelButton.addEventListener("click", async () => { await api("label", {}); this.load(); });
    this.learnButton = made("button", { type: "button", hidden: true, title: "Grow the classifier anew, with what was corrected; then label all else anew by it. The first time takes some twenty minutes." });
    this.learnButton.addEventListener("click", async () => { await api("train", {}); this.load(); });
    this.box = made("div", { className: "rows", tabIndex: 0, id: "recordings" });
    this.box.setAttribute("role", "listbox");
    this.box.setAttribute("aria-label", "Recordings");
    this.space = made("div", { className: "space" });
    this.space.setAttribute("role", "presentation");
    this.box.append(this.space);
    this.pool = [];
    element.replaceChildren(made("div", { className: "recording-list" },
      made("div", { className: "line" }, this.find, this.order),
      this.kinds,
      made("div", { className: "line" }, this.labelButton, this.learnButton, this.stateLine, this.progress),
      this.box));
    let wait;
    this.find.addEventListener("input", () => { clearTimeout(wait); wait = setTimeout(() => this.#ask(() => {}), 120); });
    this.order.addEventListener("change", () => this.#ask(() => {}));
    let due = false;
    this.box.addEventListener("scroll", () => {
      if (due) return;
      due = true;
      requestAnimationFrame(() => { due = false; this.draw(); });
    }, { passive: true });
    new ResizeObserver(() => this.draw()).observe(this.box);
    addEventListener("focus", () => onceShown(this.box, () => this.load())); // somebody may come back from another page of the same table
    this.box.addEventListener("click", (event) => {
      const row = event.target.closest("[role=option]");
      if (row) this.#open(Number(row.dataset.at));
    });
    this.box.addEventListener("keydown", (event) => this.#key(event));
  }

  #ask(change) {
    change();
    this.box.scrollTop = 0;
    this.pages.clear();
    this.#put(0);
    return this.load();
  }

  #query(first) {
    const [sort, order] = this.order.value.split(" ");
    const said = { label: this.label, text: this.find.value, sort: sort ?? "", order: order ?? "asc", first, count: PAGE };
    return `recordings?${new URLSearchParams(said)}`;
  }

  async #placeOf(id) {
    const { place } = await api(`${this.#query(0)}&place=${id}`);
    return place;
  }

  open(id) {
    this.marked = id;
    this.onOpen(id);
    this.draw();
  }

  #goTo(at) {
    this.#put(at);
    const top = at * ROW;
    if (top < this.box.scrollTop) this.box.scrollTop = top;
    else if (top + ROW > this.box.scrollTop + this.box.clientHeight) this.box.scrollTop = top + ROW - this.box.clientHeight;
  }

  #inView() {
    const first = Math.max(0, Math.floor(this.box.scrollTop / ROW) - BEYOND);
    const height = Math.min(this.box.clientHeight, screen.height); // it has none of its own before its style is there
    const last = Math.min(this.total, Math.ceil((this.box.scrollTop + height) / ROW) + BEYOND);
    return [first, last];
  }

  // Ask for all that is in view again; what is out of view is asked for when it comes into it.
  async load() {
    clearTimeout(this.timer);
    const turn = ++this.asked;
    const [first, last] = this.#inView();
    const numbers = new Set([Math.floor(first / PAGE), Math.floor(Math.max(first, last - 1) / PAGE)]);
    const { on, marked } = this;
    const more = new URLSearchParams({ ...(on !== null && { place: on }), ...(marked !== null && { open: marked }) });
    const answers = await Promise.all([...numbers].map(async (number) => [number, await api(`${this.#query(number * PAGE)}&${more}`)])).catch(() => null); // it is told
    if (turn !== this.asked) return; // something else was asked for meanwhile
    // Somebody may label on the command line, too, or change the table, and it may be no table while that is written.
    this.timer = setTimeout(() => onceShown(this.box, () => this.load()), answers?.[0][1].state.running ? POLL : 5 * POLL);
    if (!answers) return;
    this.pages = new Map(answers.map(([number, answer]) => [number, answer.rows]));
    const { total, counts, state, place, open } = answers[0][1];
    this.total = total;
    await this.#stay(on, place);
    if (turn !== this.asked) return;
    if (open) this.onSeen(open);
    this.space.style.height = `${total * ROW}px`;
    this.#tell(counts, state);
    this.draw();
  }

  // The keyboard stays on its recording. Where a correction took that away or elsewhere, it is before the one after it.
  async #stay(on, place) {
    if (on !== this.on) return; // it has been moved meanwhile
    if (place === this.at) this.gone = false;
    else if (on !== null && !this.gone) {
      const { next } = this, after = next === null ? null : await this.#placeOf(next);
      if (on !== this.on) return;
      if (place !== null && (after === null || after === place + 1)) this.at = place;
      else [this.at, this.gone] = [after ?? this.at, true];
    }
    this.at = Math.min(this.at, Math.max(0, this.total - 1));
    if (!this.gone && this.row(this.at)) this.#put(this.at);
  }

  #put(at) {
    Object.assign(this, { at, on: this.row(at)?.id ?? null, next: this.row(at + 1)?.id ?? null, gone: false });
  }

  async #fetch(number) {
    this.pages.set(number, null); // is asked for
    const turn = this.asked;
    const answer = await api(this.#query(number * PAGE));
    if (turn !== this.asked) return;
    this.pages.set(number, answer.rows);
    this.draw();
  }

  #tell(counts, state) {
    for (const button of this.kinds.children) {
      const { kind } = button.dataset;
      const number = counts[kind] ?? 0;
      button.lastChild.textContent = number.toLocaleString("en");
      button.setAttribute("aria-pressed", this.label === kind);
      button.hidden = !number && !ALWAYS.includes(kind) && this.label !== kind;
    }
    const left = state.total - state.done;
    this.running = state.running;
    this.progress.hidden = !state.running;
    this.progress.max = Math.max(1, state.total);
    if (state.learning) this.progress.removeAttribute("value");
    else this.progress.value = state.done;
    this.labelButton.hidden = state.running || !left;
    this.labelButton.textContent = state.done ? `Label ${left.toLocaleString("en")} more` : `Label ${left.toLocaleString("en")}`;
    this.stateLine.textContent = state.learning ? state.message : state.running ? `${state.done.toLocaleString("en")} of ${state.total.toLocaleString("en")} labelled` : state.message || (state.classifier ? `by ${state.classifier}` : "");
    this.box.setAttribute("aria-label", `Recordings, ${this.total}`);
    this.learnButton.hidden = state.running || !counts.corrected;
    this.learnButton.textContent = `Learn from ${(counts.corrected ?? 0).toLocaleString("en")} corrected`;
  }

  row(at) {
    return this.pages.get(Math.floor(at / PAGE))?.[at % PAGE];
  }

  // Draw the rows in view; elements are used again, so that scrolling makes none.
  draw() {
    const [first, last] = this.#inView();
    while (this.pool.length < last - first) {
      const node = made("div", { className: "row" }, made("i"), made("b"), made("span"), made("small"));
      node.setAttribute("role", "option");
      this.space.append(node);
      this.pool.push(node);
    }
    for (const [place, node] of this.pool.entries()) {
      // The element of a row stays with it while it is in view, wherever that is.
      const turn = this.pool.length;
      const at = first + ((place - (first % turn) + turn) % turn);
      node.hidden = at >= last;
      if (node.hidden) node.removeAttribute("aria-selected");
      else this.#fill(node, at);
    }
    for (let number = Math.floor(first / PAGE); number * PAGE < last; number++) {
      if (!this.pages.has(number)) this.#fetch(number);
    }
    this.box.setAttribute("aria-activedescendant", this.total && !this.gone && this.at >= first && this.at < last ? `row-${this.at}` : "");
  }

  #fill(node, at) {
    const shown = this.row(at);
    if (node.at !== at) {
      node.at = at;
      node.id = `row-${at}`;
      node.dataset.at = at;
      node.style.transform = `translateY(${at * ROW}px)`;
      node.setAttribute("aria-posinset", at + 1);
      node.shown = undefined;
    }
    node.setAttribute("aria-setsize", this.total);
    node.setAttribute("aria-selected", shown !== undefined && shown !== null && shown.id === this.marked);
    node.classList.toggle("at", at === this.at && !this.gone);
    if (node.shown === shown && shown) return;
    node.shown = shown;
    fillRow(node, shown);
  }

  async #open(at) {
    this.#put(at);
    if (!this.row(at)) await this.#fetch(Math.floor(at / PAGE)); // it is in view sooner than it is here
    const shown = this.row(at);
    if (at === this.at) this.#put(at);
    if (shown && at === this.at) this.open(shown.id);
  }

  #key(event) {
    const page = Math.max(1, Math.floor(this.box.clientHeight / ROW) - 1);
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: page, PageUp: -page, Home: -this.total, End: this.total }[event.key];
    if (event.key === "Enter" && this.total) this.#open(this.at);
    else if (step && !event.ctrlKey && !event.metaKey && !event.altKey) {
      const from = this.gone && step > 0 ? this.at - 1 : this.at;
      this.#goTo(Math.min(Math.max(0, from + step), Math.max(0, this.total - 1)));
      this.draw();
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
