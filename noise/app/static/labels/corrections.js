// Segments of the open recording: changes are shown at once, saved in order, and reverted on failure.
import { api } from "../api.js";
import { painted } from "./edits.js";

export class Corrections extends EventTarget {
  // `tell` shows the result of the last change.
  constructor(tell) {
    super();
    this.tell = tell;
    this.rows = [];
    this.track = "all";
    this.saved = null; // saved rows; null while they are loading
    this.history = { undo: false, redo: false }; // whether undo and redo are possible
    this.versions = new Map(); // version of the rows of each recording
    this.taken = 0; // number of row updates
    this.queue = []; // pending work: { id, name, rows, kind } to save, { undone } to undo
    this.sending = null; // current work
    this.working = null;
    this.undoing = null;
  }

  // Close the rows; corrections are impossible until new rows have loaded.
  leave(id) {
    Object.assign(this, { id, name: "", duration: null, rows: [], saved: null });
    this.#tell();
  }

  async open({ id, name, duration_s: duration }) {
    const awaited = id === this.id && this.saved && !this.rows.length; // unlabelled so far, and labels may have arrived
    if (!awaited) this.leave(id);
    Object.assign(this, { name, duration });
    await this.#read();
  }

  // Read rows, again if something was saved meanwhile; return whether the version is new.
  async #read() {
    const { id } = this;
    let answer, taken;
    do {
      await this.working;
      ({ taken } = this);
      answer = await api(`recordings/${id}/segments`);
    } while (id === this.id && (this.working || taken !== this.taken));
    const isOther = id === this.id && answer.version !== this.versions.get(id);
    this.#take(answer);
    return isOther;
  }

  // Reload the rows if another page or program has changed them.
  async seen({ id, version }) {
    if (id !== this.id || !this.saved || this.working || version === this.versions.get(id)) return;
    const wereNone = !this.rows.length;
    if (await this.#read() && !wereNone) this.tell("labels were changed elsewhere; the current ones are shown");
  }

  get tracks() { return [...new Set(this.rows.map((row) => row.channel))]; }

  // Rows of a track, sorted by time.
  of(track) { return this.rows.filter((row) => row.channel === track).sort((one, two) => one.start_s - two.start_s); }

  get shown() { return this.of(this.track); }

  // Lanes [{ tracks, rows }]: tracks with equal labels share one.
  get lanes() {
    const lanes = new Map();
    for (const track of this.tracks) {
      const rows = this.of(track), key = JSON.stringify(rows.map((row) => [row.start_s, row.end_s, row.label, row.label_source]));
      if (lanes.has(key)) lanes.get(key).tracks.push(track);
      else lanes.set(key, { tracks: [track], rows });
    }
    return [...lanes.values()];
  }

  // Take rows of the table; unsaved changes stay visible.
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

  // All rows with new rows of the current lane.
  #withLane(shown) {
    const { tracks } = this.lanes.find((lane) => lane.tracks.includes(this.track)) ?? { tracks: [this.track] };
    return [...this.rows.filter((row) => !tracks.includes(row.channel)), ...tracks.flatMap((channel) => shown.map((row) => ({ ...row, channel })))];
  }

  // Show rows of the lane without saving, such as during a drag.
  preview(shown) { this.#show(this.#withLane(shown)); }

  // Revert a preview.
  restore() { if (this.saved) this.#show([this.sending, ...this.queue].findLast((one) => one?.rows && one.id === this.id)?.rows ?? this.saved); }

  // Save rows of the lane, in place of pending rows of the same kind, such as steps of a border.
  write(shown, kind = null) { this.writeAll(this.#withLane(shown), kind); }

  // Label an interval on all tracks; `tracks` are those of an unlabelled recording.
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

  // Act now, or after a pending undo.
  inTurn(act) {
    const { id, undoing } = this;
    if (!undoing) return act();
    return undoing.then(() => (id === this.id ? this.inTurn(act) : this.tell("not changed: another recording is open now")));
  }

  // Undo or redo the last change; resolves to the number of its recording, or null.
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

  // Save rows, or undo if there are none.
  async #send({ id, name, rows, undone, redo }) {
    const did = rows ? "saved" : redo ? "redone" : "undone";
    const said = rows?.map(({ start_s, end_s, label, channel, label_source }) => ({ start_s, end_s, label, channel, label_source }));
    if (rows) this.#say(id, name, "saving ...");
    try {
      const answer = await (rows ? api(`recordings/${id}/segments`, { rows: said, version: this.versions.get(id) }) : api("undo", { redo }));
      this.#say(answer.id, answer.name, rows ? `saved ${clock()}` : `${did}, saved ${clock()}`);
      this.#take(answer);
      undone?.(answer.id);
    } catch (error) {
      this.#say(id, name, `not ${did}: ${error.message}`);
      const now = await api(`recordings/${id}/segments`).catch(() => null);
      // Drop later changes, which were based on rows that could not be saved.
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
