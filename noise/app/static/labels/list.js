// List of recordings: filters, order, and labels as they arrive.
import { api } from "../api.js";
import { made, onceShown } from "../dom.js";

const POLL = 1000; // while labels arrive [ms]
const KINDS = { "": "all", creak: "creak", squawk: "squawk", squeal: "squeal", none: "none", unknown: "unknown", unlabelled: "without a label", partly: "partly corrected", corrected: "corrected", refused: "refused" };
const ALWAYS = ["", "creak", "squawk", "squeal", "none", "unknown"];
const MEANING = { none: "no creak, squawk or squeal", unknown: "a noise that may be none of the three" };
const ORDERS = { "": "as found", "name asc": "name", "label asc": "label", "frequency asc": "lowest frequency first", "frequency desc": "highest frequency first", "level desc": "loudest first", "duration desc": "longest first", "least_sure desc": "least certain first" };
const PLACES = { "": "recorded: see sidecar", rig: "recorded at a rig", car: "recorded in a car", any: "recorded anywhere" };

const choices = (texts) => Object.entries(texts).map(([value, textContent]) => made("option", { value, textContent }));

let list = null;

// `onOpen` opens a recording; `onSeen` gets the version of the labels of the open one.
export async function mountList(element, { onOpen, onSeen }) {
  list = new RecordingList(element, onOpen, onSeen);
  await list.load();
  return list;
}

// Reload the list, such as after a correction.
export async function refresh() { await list.load(); }

export function openRecording(id) { list.open(id); }

export class RecordingList {
  label = "";
  rows = []; // rows of the server
  nodes = new Map(); // by number of the recording
  known = ""; // digest of the rows
  asked = 0;
  at = 0; // row of the keyboard cursor
  on = null; // recording of the keyboard cursor
  marked = null; // open recording

  constructor(element, onOpen, onSeen) {
    Object.assign(this, { onOpen, onSeen });
    let wait;
    this.find = made("input", { type: "search", placeholder: "find by name", ariaLabel: "Find by name", oninput: () => { clearTimeout(wait); wait = setTimeout(() => this.#ask(this.label), 120); } });
    this.order = made("select", { ariaLabel: "Order", onchange: () => this.#ask(this.label) }, ...choices(ORDERS));
    this.kinds = made("div", { className: "kinds", role: "group", ariaLabel: "Show recordings with" });
    for (const [kind, text] of Object.entries(KINDS)) {
      const onclick = () => this.#ask(this.label === kind ? "" : kind);
      this.kinds.append(made("button", { type: "button", className: `kind ${kind}`, title: MEANING[kind] ?? "", data: { kind }, onclick }, made("i"), `${text} `, made("span")));
    }
    this.stateLine = made("span");
    this.labelButton = made("button", { type: "button", hidden: true });
    this.place = made("select", { ariaLabel: "Where the sounds were recorded", title: "What else may be heard there decides how sure a name has to be.", hidden: true }, ...choices(PLACES));
    this.labelButton.addEventListener("click", async () => {
      this.labelButton.disabled = true;
      await api("label", { surroundings: this.place.value }).finally(() => { this.labelButton.disabled = false; });
      this.load();
    });
    this.box = made("div", { className: "rows", tabIndex: 0, id: "recordings", role: "listbox", ariaLabel: "Recordings" });
    this.empty = made("p", { className: "empty", hidden: true });
    element.replaceChildren(made("div", { className: "recording-list" },
      made("div", { className: "line" }, this.find, this.order), this.kinds,
      made("div", { className: "line" }, this.labelButton, this.place, this.stateLine),
      this.empty, this.box));
    addEventListener("focus", () => onceShown(this.box, () => this.load())); // another page may have changed the table
    this.box.addEventListener("click", ({ target }) => { const row = target.closest("[role=option]"); if (row) this.#open(this.rows.findIndex((one) => one.id === row.shown.id)); });
    this.box.addEventListener("keydown", (event) => this.#key(event));
  }

  #ask(label) {
    this.label = label;
    this.box.scrollTop = 0;
    this.#put(0);
    return this.load();
  }

  async load() {
    clearTimeout(this.timer);
    const turn = ++this.asked, [sort, order] = this.order.value.split(" ");
    const said = { label: this.label, text: this.find.value, sort: sort ?? "", order: order ?? "asc", known: this.known, ...(this.marked !== null && { open: this.marked }) };
    const answer = await api(`recordings?${new URLSearchParams(said)}`).catch(() => null); // the error is shown
    if (turn !== this.asked) return; // outdated
    // Poll, because other programs may label or change the table.
    this.timer = setTimeout(() => onceShown(this.box, () => this.load()), answer?.state.running ? POLL : 5 * POLL);
    if (!answer) return;
    if (answer.open) this.onSeen(answer.open);
    if (answer.rows) {
      Object.assign(this, { rows: answer.rows, known: answer.known });
      this.#stay();
    }
    this.#tell(answer);
    this.draw();
  }

  // Keep the keyboard cursor on its recording, or near its place if a correction has removed it.
  #stay() {
    const at = this.rows.findIndex((row) => row.id === this.on);
    if (at >= 0) this.#put(at);
    else if (this.on !== null) this.#put(this.at - 1);
    else if (this.at >= 0) this.#put(this.at);
  }

  #put(at) { Object.assign(this, { at, on: this.rows[at]?.id ?? null }); }

  #tell({ counts, state }) {
    for (const button of this.kinds.children) {
      const { kind } = button.dataset, number = counts[kind] ?? 0;
      button.lastChild.textContent = number.toLocaleString("en");
      button.setAttribute("aria-pressed", this.label === kind);
      button.hidden = !number && !ALWAYS.includes(kind) && this.label !== kind;
    }
    const left = state.total - state.done, count = (number) => number.toLocaleString("en");
    this.running = state.running;
    this.labelButton.hidden = this.place.hidden = state.running || !left;
    this.labelButton.textContent = state.done ? `Label ${count(left)} more` : `Label ${count(left)}`;
    this.stateLine.textContent = state.message;
    this.empty.hidden = this.rows.length > 0;
    this.empty.textContent = state.total ? "No recording matches. Choose “all” and clear the search." : "No recordings are open. Start the program with a folder of recordings: bushing-noise open FOLDER";
    this.box.hidden = !this.rows.length;
    this.box.setAttribute("aria-label", `Recordings, ${this.rows.length}`);
  }

  draw() {
    const before = this.nodes;
    this.nodes = new Map(this.rows.map((shown, at) => [shown.id, filled(before.get(shown.id), shown, at, this.rows.length)]));
    const nodes = [...this.nodes.values()];
    if (nodes.length !== this.box.children.length || nodes.some((node, at) => node !== this.box.children[at])) this.box.replaceChildren(...nodes);
    for (const [id, node] of this.nodes) {
      node.setAttribute("aria-selected", id === this.marked);
      node.classList.toggle("at", id === this.on);
    }
    this.box.setAttribute("aria-activedescendant", this.nodes.has(this.on) ? `row-${this.on}` : "");
  }

  open(id) {
    this.marked = id;
    this.onOpen(id);
    this.draw();
  }

  #open(at) {
    this.#put(at);
    if (this.on !== null) this.open(this.on);
  }

  #key(event) {
    const last = this.rows.length - 1, page = Math.max(1, Math.floor(this.box.clientHeight / (this.box.firstChild?.offsetHeight || 1)) - 1);
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: page, PageUp: -page, Home: -last, End: last }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey || last < 0) return;
    if (event.key === "Enter") this.#open(this.at);
    else if (step !== undefined) {
      this.#put(Math.min(Math.max(0, this.at + step), last));
      this.nodes.get(this.on).scrollIntoView({ block: "nearest" });
      this.draw();
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

// Fill a row: name, labels and figures of a recording.
function filled(node, shown, at, length) {
  node ??= made("div", { className: "row", id: `row-${shown.id}`, role: "option", data: { at: shown.id } }, made("i"), made("b"), made("span"), made("small"));
  node.setAttribute("aria-posinset", at + 1);
  node.setAttribute("aria-setsize", length);
  const known = JSON.stringify(node.shown ?? null) === JSON.stringify(shown);
  node.shown = shown;
  if (known) return node;
  const [mark, name, labels, numbers] = node.children, { label, error, frequency_hz: frequency, level_dba: level, duration_s: duration } = shown;
  mark.className = label ?? "";
  // Long paths lose their folders first.
  const file = shown.name.lastIndexOf("/") + 1;
  name.replaceChildren(...[shown.name.slice(0, file), shown.name.slice(file)].filter(Boolean).map((textContent) => made("bdi", { textContent })));
  name.title = shown.name;
  const seen = shown.corrected ? ", corrected" : shown.partly ? ", partly corrected" : "";
  labels.title = labels.textContent = error ? `refused: ${error}` : (label ? shown.labels.join(" + ") : "no label yet") + seen;
  const figures = [[frequency, 0, "Hz"], [level, 1, "dB(A)"], [duration, 1, "s"]];
  numbers.textContent = figures.filter(([value]) => value !== null).map(([value, digits, unit]) => `${value.toFixed(digits)} ${unit}`).join(" · ");
  return node;
}
