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
    this.waiting = new Map(); // rows that are written next, of each recording
  }

  // Until rows have come there are none to correct: what is written then would replace what nobody has seen.
  async open(id, duration) {
    const none = id === this.id && this.known && !this.rows.length; // labels are awaited: any may be given meanwhile
    Object.assign(this, { id, duration, rows: [], before: null, known: none });
    this.#tell();
    await this.writing;
    const answer = await api(`recordings/${id}/segments`);
    if (id !== this.id || this.writing) return;
    this.known = true;
    this.#take(answer.rows);
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

  // Write rows of the track. Of several changes during one writing, the last one of each recording is written next.
  write(shown) {
    if (!this.known) return this.tell("not changed: its labels are still being read");
    this.before ??= this.rows;
    this.#put(shown);
    this.waiting.set(this.id, this.rows);
    this.writing ??= this.#send().finally(() => { this.writing = null; });
    return this.writing;
  }

  async #send() {
    while (this.waiting.size) {
      const [id, changed] = this.waiting.entries().next().value;
      this.waiting.delete(id);
      this.tell("saving ...");
      const rows = changed.map(({ start_s, end_s, label, channel, label_source }) => ({ start_s, end_s, label, channel, label_source }));
      let answer;
      try {
        answer = await api(`recordings/${id}/segments`, { rows });
      } catch (error) {
        this.waiting.delete(id);
        if (id === this.id && this.before) Object.assign(this, { rows: this.before, before: null });
        this.tell(`not saved: ${error.message}`);
        this.#tell();
        continue;
      }
      this.tell(`saved ${new Date().toTimeString().slice(0, 8)}`);
      if (id === this.id && !this.waiting.has(id)) {
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
