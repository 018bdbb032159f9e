// Segments of the recording that is open: each change is written at once, and goes back where it cannot be.
import { api } from "../api.js";

export class Corrections extends EventTarget {
  // `tell` says what has become of the last change, `others` takes the number of what has changed.
  constructor(tell) {
    super();
    this.tell = tell;
    this.rows = [];
    this.track = "all";
    this.writing = null;
    this.next = null;
  }

  async open(id, duration) {
    Object.assign(this, { id, duration, rows: [], next: null });
    const answer = await api(`recordings/${id}/segments`);
    if (id === this.id) this.#take(answer.rows);
  }

  get tracks() { return [...new Set(this.rows.map((row) => row.channel))]; }

  // Rows of the track that is shown, in order of time.
  get shown() {
    return this.rows.filter((row) => row.channel === this.track).sort((one, two) => one.start_s - two.start_s);
  }

  #take(rows) {
    const known = rows.filter((row) => row.label);
    this.rows = known.map((row) => ({ ...row, channel: row.channel || "all", start_s: row.start_s ?? 0, end_s: row.end_s ?? this.duration }));
    if (!this.tracks.includes(this.track)) this.track = this.tracks[0] ?? "all";
    this.#tell();
  }

  show(track) {
    this.track = track;
    this.#tell();
  }

  #tell() { this.dispatchEvent(new Event("change")); }

  // Show rows of the track without writing them, such as while a border is dragged.
  preview(shown) {
    this.before ??= this.rows;
    this.#put(shown);
  }

  #put(shown) {
    this.rows = [...this.rows.filter((row) => row.channel !== this.track), ...shown];
    this.#tell();
  }

  // Write rows of the track. Of several changes during one writing, the last one is written next.
  write(shown) {
    this.before ??= this.rows;
    this.#put(shown);
    this.next = this.rows;
    this.writing ??= this.#send().finally(() => { this.writing = null; });
    return this.writing;
  }

  async #send() {
    while (this.next) {
      const { id, next } = this;
      this.next = null;
      this.tell("saving ...");
      const rows = next.map(({ start_s, end_s, label, channel, label_source }) => ({ start_s, end_s, label, channel, label_source }));
      let answer;
      try {
        answer = await api(`recordings/${id}/segments`, { rows });
      } catch (error) {
        if (id === this.id && this.before) this.rows = this.before;
        this.before = this.next = null;
        this.tell(`not saved: ${error.message}`);
        this.#tell();
        return;
      }
      this.tell(`saved ${new Date().toTimeString().slice(0, 8)}`);
      if (id === this.id && !this.next) {
        this.before = null;
        this.#take(answer.rows);
      }
      this.dispatchEvent(new CustomEvent("saved", { detail: id }));
    }
  }

  async undo() {
    await this.writing;
    const { id, rows } = await api("undo", {});
    this.tell(`undone, saved ${new Date().toTimeString().slice(0, 8)}`);
    if (id === this.id) this.#take(rows);
    this.dispatchEvent(new CustomEvent("saved", { detail: id }));
    return id;
  }
}
