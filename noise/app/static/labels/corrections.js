// Segments of the recording that is open: each change is written at once, in the order of the keys, and goes back where it cannot be.
import { api } from "../api.js";
import { painted } from "./edits.js";

// Undo takes back what was said on this page, and on the same before it was loaded again.
const PAGE = (sessionStorage.page ??= crypto.randomUUID());

export class Corrections extends EventTarget {
  // `tell` says what has become of the last change.
  constructor(tell) {
    super();
    this.tell = tell;
    this.rows = [];
    this.track = "all";
    this.saved = null; // rows as the table has them; none is known before they have come
    this.history = { undo: false, redo: false }; // what there is to undo and redo
    this.versions = new Map(); // of the rows of each recording, which a change of them is based on
    this.taken = 0; // how often rows of the table came
    this.queue = []; // what is still to be done: { id, name, rows, kind } is written, { undone } undoes
    this.sending = null; // of the queue
    this.working = null;
    this.undoing = null;
  }

  // Until rows have come there are none to correct: what is written then would replace what nobody has seen.
  leave(id) {
    Object.assign(this, { id, name: "", duration: null, rows: [], saved: null });
    this.#tell();
  }

  async open({ id, name, duration_s: duration }) {
    const awaited = id === this.id && this.saved && !this.rows.length; // labels are: any may be given meanwhile
    if (!awaited) this.leave(id);
    Object.assign(this, { name, duration });
    await this.#read();
  }

  // What was asked for before something was written may be older than that. Whether it is another than was known comes of it.
  async #read() {
    const { id } = this;
    let answer, taken;
    do {
      await this.working;
      ({ taken } = this);
      answer = await api(`recordings/${id}/segments?page=${PAGE}`);
    } while (id === this.id && (this.working || taken !== this.taken));
    const isOther = id === this.id && answer.version !== this.versions.get(id);
    this.#take(answer);
    return isOther;
  }

  // Somebody else may have changed the table: then its rows are shown anew.
  async seen({ id, version }) {
    if (id !== this.id || !this.saved || this.working || version === this.versions.get(id)) return;
    const wereNone = !this.rows.length;
    if (await this.#read() && !wereNone) this.tell("labels were changed elsewhere; the current ones are shown");
  }

  get tracks() { return [...new Set(this.rows.map((row) => row.channel))]; }

  // Rows of a track in order of time.
  of(track) { return this.rows.filter((row) => row.channel === track).sort((one, two) => one.start_s - two.start_s); }

  get shown() { return this.of(this.track); }

  // Tracks with the same labels are one lane, corrected together: [{ tracks, rows }].
  get lanes() {
    const lanes = new Map();
    for (const track of this.tracks) {
      const rows = this.of(track), key = JSON.stringify(rows.map((row) => [row.start_s, row.end_s, row.label, row.label_source]));
      if (lanes.has(key)) lanes.get(key).tracks.push(track);
      else lanes.set(key, { tracks: [track], rows });
    }
    return [...lanes.values()];
  }

  // What is still to be written of it stays shown.
  #take({ id, rows, version, history }) {
    this.versions.set(id, version);
    this.history = history;
    if (id !== this.id) return;
    this.taken += 1;
    const known = rows.filter((row) => row.label);
    this.saved = known.map((row) => ({ ...row, channel: row.channel || "all", start_s: row.start_s ?? 0, end_s: row.end_s ?? this.duration }));
    if (!this.queue.some((one) => one.rows && one.id === id)) this.#show(this.saved);
  }

  #show(rows) {
    this.rows = rows;
    if (!this.tracks.includes(this.track)) this.track = this.tracks[0] ?? "all";
    this.#tell();
  }

  show(track) {
    this.track = track;
    this.#tell();
  }

  #tell() { this.dispatchEvent(new Event("change")); }

  // All rows, where those of the lane are these.
  #withLane(shown) {
    const { tracks } = this.lanes.find((lane) => lane.tracks.includes(this.track)) ?? { tracks: [this.track] };
    return [...this.rows.filter((row) => !tracks.includes(row.channel)), ...tracks.flatMap((channel) => shown.map((row) => ({ ...row, channel })))];
  }

  // Show rows of the lane without writing them, such as while a border is dragged.
  preview(shown) { this.#show(this.#withLane(shown)); }

  // No longer show what was only looked at.
  restore() { if (this.saved) this.#show([this.sending, ...this.queue].findLast((one) => one?.rows && one.id === this.id)?.rows ?? this.saved); }

  // Write rows of the lane. One of the same kind that waits to be written is replaced, such as a border's step.
  write(shown, kind = null) { this.writeAll(this.#withLane(shown), kind); }

  // Make a stretch of every track a segment; `tracks` are those of a recording that has no labels yet.
  paint(start, end, label, tracks) {
    const channels = this.tracks.length ? this.tracks : tracks;
    this.writeAll(channels.flatMap((channel) => painted(this.of(channel), start, end, label).map((row) => ({ ...row, channel }))));
  }

  writeAll(all, kind = null) {
    if (!this.saved) return this.tell("not changed: the labels are still loading");
    this.#show(all);
    const { id, name, rows } = this, last = this.queue.at(-1);
    if (kind !== null && last?.kind === kind && last.id === id) last.rows = rows;
    else this.queue.push({ id, name, rows, kind });
    this.working ??= this.#work();
  }

  // Act now, or once what is being undone is there: who goes on after that means what it was before.
  inTurn(act) {
    const { id, undoing } = this;
    if (!undoing) return act();
    return undoing.then(() => (id === this.id ? this.inTurn(act) : this.tell("not changed: another recording is open now")));
  }

  // Undo the last change, or redo what was undone last; the number of its recording comes of it, null where there is none.
  undo(redo = false) {
    const { id, name } = this, undoing = new Promise((undone) => this.queue.push({ id, name, undone, redo }));
    this.undoing = undoing;
    this.working ??= this.#work();
    return undoing.finally(() => { if (this.undoing === undoing) this.undoing = null; });
  }

  async #work() {
    while (this.queue.length) {
      this.sending = this.queue.shift();
      await this.#send(this.sending);
      this.sending = null;
    }
    this.working = null;
  }

  // Write rows, or undo: there are none to be written then.
  async #send({ id, name, rows, undone, redo }) {
    const did = rows ? "saved" : redo ? "redone" : "undone";
    const said = rows?.map(({ start_s, end_s, label, channel, label_source }) => ({ start_s, end_s, label, channel, label_source }));
    if (rows) this.#say(id, name, "saving ...");
    try {
      const answer = await (rows ? api(`recordings/${id}/segments`, { rows: said, version: this.versions.get(id), page: PAGE }) : api("undo", { page: PAGE, redo }));
      this.#say(answer.id, answer.name, rows ? `saved ${clock()}` : `${did}, saved ${clock()}`);
      this.#take(answer);
      undone?.(answer.id);
    } catch (error) {
      this.#say(id, name, `not ${did}: ${error.message}`);
      const now = await api(`recordings/${id}/segments?page=${PAGE}`).catch(() => null);
      // What was changed until now was made of what could not be written, and what undoes means it.
      const dropped = rows ? this.queue.filter((one) => one.undone || one.id === id) : [];
      this.queue = this.queue.filter((one) => !dropped.includes(one));
      if (now) this.#take(now);
      else if (id === this.id && this.saved) this.#show(this.saved);
      for (const one of [{ undone }, ...dropped]) one.undone?.(null);
    }
    this.dispatchEvent(new CustomEvent("saved", { detail: id }));
  }

  #say(id, name, text) { this.tell(id === this.id ? text : `${name}: ${text}`); }
}

function clock() { return new Date().toTimeString().slice(0, 8); }
