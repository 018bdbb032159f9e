// Page of one recording: lanes, segments, player, keys and corrections.
import { told } from "../api.js";
import { Corrections } from "./corrections.js";
import { relabelled, SHORTEST } from "./edits.js";
import { build, LABELS } from "./frame.js";
import { listen } from "./keys.js";
import { made, onceShown } from "../dom.js";
import { refresh } from "./list.js";
import { Outline } from "./outline.js";
import { RecordingPlayer } from "./player.js";
import { follow } from "./pointer.js";
import { Segments, showSegment } from "./segments.js";
import { about, levelsOf } from "./sounds.js";
import { Spectrogram } from "./spectrogram.js";
import { drawTimes, Timeline } from "./timeline.js";

const ZOOM = 1.6;
const POLL = 1500; // while waiting for labels [ms]

export class RecordingPage {
  constructor(element, onOpen) {
    this.element = element;
    this.onOpen = onOpen;
    const parts = (this.parts = build(element));
    const timeline = (this.timeline = new Timeline());
    this.player = new RecordingPlayer();
    this.corrections = new Corrections((text) => { parts.saved.textContent = text; });
    this.spectrogram = new Spectrogram(timeline, { plot: parts.plot, marks: parts.marks, axis: parts.frequencies, legend: parts.legend, readout: parts.readout });
    this.outline = new Outline(timeline, { plot: parts.wave, axis: parts.waveAxis });
    this.segments = new Segments(timeline, this.corrections, parts, () => this.#chosen());
    this.beside = new Set(); // names of additional visible channels
    this.stacked = [];
    timeline.addEventListener("view", () => this.#view());
    timeline.addEventListener("position", () => this.#position());
    timeline.addEventListener("selection", () => { this.#marks(); this.#stretch(); });
    this.corrections.addEventListener("change", () => this.#rows());
    this.corrections.addEventListener("saved", () => refresh());
    this.player.addEventListener("change", () => this.#playing());
    new ResizeObserver(() => this.#view()).observe(parts.area);
    follow(this);
    this.#actions();
  }

  // Open a recording; throws if it cannot be shown.
  async open(id) {
    const { parts } = this;
    this.id = id;
    this.sound = null; // of the previous recording
    this.corrections.leave(id);
    clearTimeout(this.timer);
    this.turn = null; // pending levels are outdated
    for (const said of [parts.saved, parts.readout, parts.levels]) said.textContent = "";
    clearTimeout(this.measuring);
    // Load all in parallel.
    const seen = this.spectrogram.load(id, null);
    seen.catch(() => {}); // the next request fails with the same error
    const sound = await about(id);
    if (id !== this.id) return;
    this.sound = sound;
    this.channel = sound.channel;
    parts.title.textContent = sound.name;
    parts.facts.textContent = [`${sound.duration_s.toFixed(2)} s`, `${sound.rate} Hz`, sound.calibrated ? "calibrated" : "not calibrated: levels in dBFS", ...sound.conditions].join(", ");
    parts.channel.box.replaceChildren(...sound.channels.map(({ name, unit }) => made("option", { value: name, textContent: `${name} [${unit}]` })));
    parts.channel.box.value = this.channel;
    this.timeline.reset(sound.duration_s);
    this.timeline.select(null);
    this.#play();
    this.timeline.go(0);
    this.player.position = 0;
    await Promise.all([seen, this.outline.load(id, this.channel), this.#labels(id), this.#stack()]);
    if (id === this.id) this.#chosen();
  }

  // Show additional channels on the same time axis.
  async #stack() {
    const { parts, sound: { channels }, id } = this, others = channels.filter(({ name }) => name !== this.channel);
    parts.others.hidden = !others.length;
    parts.others.replaceChildren("Also show ", ...others.map(({ name }) => {
      const onclick = () => { this.beside.delete(name) || this.beside.add(name); this.#stack(); };
      return made("button", { type: "button", textContent: name, ariaPressed: this.beside.has(name), onclick });
    }));
    const shown = others.filter(({ name }) => this.beside.has(name));
    this.stacked = shown.map(({ name }) => new Outline(this.timeline, { plot: made("canvas", { role: "img", ariaLabel: `${name} over time` }), axis: made("canvas", { ariaHidden: "true" }), name }));
    parts.stack.replaceChildren(...this.stacked.map(({ plot }) => plot));
    parts.stackAxes.replaceChildren(...this.stacked.map(({ axis }) => axis));
    await Promise.all(this.stacked.map((lane) => lane.load(id, lane.name)));
  }

  // Load labels, and poll while there are none.
  async #labels(id) {
    clearTimeout(this.timer);
    await this.corrections.open({ ...this.sound, id }).catch(() => null); // shown, and tried again
    if (id !== this.id || this.corrections.rows.length) return;
    this.timer = setTimeout(() => onceShown(this.element, () => { if (id === this.id && !this.corrections.rows.length) this.#labels(id); }), POLL);
  }

  // Put the channel into the player.
  #play() {
    const { channels, calibrated, duration_s: duration } = this.sound;
    const { kind } = channels.find((one) => one.name === this.channel);
    this.player.put({ id: this.id, channel: this.channel, kind, calibrated: calibrated && kind === "pressure", duration });
  }

  async hearChannel(name) {
    if (!this.sound) return;
    this.channel = name;
    const at = this.sound.channels.findIndex((one) => one.name === name);
    if (this.corrections.tracks.includes(`${at + 1}`)) this.corrections.show(`${at + 1}`);
    this.#play();
    await Promise.all([...[this.spectrogram, this.outline].map((lane) => lane.load(this.id, name)), this.#stack()]);
    this.#stretch();
  }

  // Interval of playback and levels: the selection, else the looped segment, else all.
  get stretch() {
    const { selection, duration } = this.timeline;
    if (selection) return selection;
    const { chosen } = this.segments;
    const one = this.player.looping && chosen ? { start: chosen.start_s, end: chosen.end_s } : { start: 0, end: duration };
    return one.end > one.start ? one : { start: 0, end: duration };
  }

  play(from = this.timeline.position) {
    const stretch = this.stretch;
    const inside = from >= stretch.start && from < stretch.end - 0.005;
    return this.player.play(inside ? from : stretch.start, stretch);
  }

  seek(time) {
    this.timeline.go(time);
    this.segments.chooseAt(time);
    this.player.position = this.timeline.position;
    if (this.player.playing) this.play();
  }

  #playing() {
    const { parts, player } = this;
    parts.play.textContent = player.playing ? "Pause" : "Play";
    parts.loop.setAttribute("aria-pressed", player.looping);
    parts.gains.textContent = player.words;
    cancelAnimationFrame(this.frame);
    const step = () => {
      if (!player.playing) return;
      this.timeline.go(player.now());
      this.frame = requestAnimationFrame(step);
    };
    step();
  }

  #view() {
    for (const lane of [this.spectrogram, this.outline, ...this.stacked]) { lane.draw(); lane.refine(); }
    drawTimes(this.parts.times, this.timeline);
    this.segments.draw();
    this.#marks();
  }

  #position() {
    this.parts.clock.textContent = `${this.timeline.position.toFixed(2)} s`;
    this.#marks();
  }

  #marks() {
    const { timeline, parts: { position, selection } } = this;
    const share = timeline.share(timeline.position);
    position.hidden = share < 0 || share > 1;
    position.style.left = `${100 * share}%`;
    selection.hidden = !timeline.selection;
    if (!timeline.selection) return;
    const [from, to] = [timeline.selection.start, timeline.selection.end].map((time) => Math.min(1, Math.max(0, timeline.share(time))));
    selection.style.left = `${100 * from}%`;
    selection.style.width = `${100 * (to - from)}%`;
  }

  #rows() {
    showSegment(this.parts, this.segments.chosen);
    const { rows, history, queue } = this.corrections, { parts } = this;
    parts.agree.disabled = rows.every((row) => row.label_source === "human");
    parts.undo.disabled = !history.undo && !queue.length;
    parts.redo.disabled = !history.redo;
  }

  #chosen() {
    showSegment(this.parts, this.segments.chosen);
    this.#stretch();
  }

  // Update playback and levels of the interval.
  #stretch() {
    clearTimeout(this.measuring);
    this.measuring = setTimeout(async () => {
      const { selection } = this.timeline, { chosen } = this.segments;
      const { start, end } = selection ?? (chosen ? { start: chosen.start_s, end: chosen.end_s } : this.stretch);
      if (this.player.playing) this.play();
      const turn = (this.turn = {});
      if (!this.sound || end - start <= 0.001) return;
      const words = await levelsOf(this.id, this.channel, start, end);
      if (turn === this.turn) this.parts.levels.textContent = words;
    }, 60);
  }

  #loop() {
    this.player.looping = !this.player.looping;
    this.#playing();
    if (this.player.playing) this.play();
  }

  // Actions of buttons, by name, and of keys.
  #actions() {
    const { parts, timeline, player, segments } = this;
    const buttons = {
      play: () => (player.playing ? player.stop() : this.play()), loop: () => this.#loop(),
      help: () => parts.dialog.showModal(),
      in: () => timeline.zoom(ZOOM), out: () => timeline.zoom(1 / ZOOM), whole: () => timeline.whole(),
      fit: () => {
        const { start, end } = timeline.selection ?? { start: segments.chosen?.start_s, end: segments.chosen?.end_s };
        if (start !== undefined) timeline.fit(start, end);
      },
      undo: () => undo(this), redo: () => undo(this, true), agree: () => agree(this),
    };
    const step = (sign) => ({ shiftKey }) => this.seek(timeline.position + sign * (shiftKey ? 1 : 0.1));
    const beside = (sign) => () => { segments.choose(segments.at + sign); if (segments.chosen) timeline.go(segments.chosen.start_s); };
    const named = {
      " ": "play", l: "loop", c: "agree", u: "undo", "Ctrl+z": "undo", "Ctrl+Shift+z": "redo", "Ctrl+y": "redo",
      "+": "in", "=": "in", "-": "out", 0: "whole", f: "fit", "?": "help",
    };
    const keys = {
      ...Object.fromEntries(Object.entries(named).map(([key, name]) => [key, buttons[name]])),
      ...Object.fromEntries(LABELS.map((name, at) => [at + 1, () => label(this, name)])),
      ArrowLeft: step(-1), ArrowRight: step(1), "[": beside(-1), "]": beside(1), Escape: () => timeline.select(null),
    };
    for (const [name, action] of Object.entries(buttons)) parts[name].addEventListener("click", () => { if (this.sound) action(); });
    for (const button of parts.labels.children) button.addEventListener("click", () => label(this, button.dataset.label));
    parts.channel.box.addEventListener("change", ({ target }) => this.hearChannel(target.value));
    // Ignore keys while a recording is loading.
    const act = (action) => (event) => {
      if (this.sound) action(event);
      else if (this.id !== undefined) parts.saved.textContent = "not done: the recording is still loading";
    };
    listen(this.element, Object.fromEntries(Object.entries(keys).map(([key, action]) => [key, act(action)])));
  }
}

// Label the selection on all tracks, else the segment at the cursor.
function label({ corrections, segments, timeline, player, sound }, said) {
  const { selection, position } = timeline;
  corrections.inTurn(() => {
    if (selection && selection.end - selection.start < SHORTEST) return told(`A segment is at least ${1000 * SHORTEST} ms long: select more.`);
    if (selection || !segments.chosen) {
      const { start, end } = selection ?? { start: 0, end: timeline.duration };
      corrections.paint(start, end, said, sound?.tracks ?? []);
      timeline.select(null);
      return segments.chooseAt(0.5 * (start + end));
    }
    if (player.playing && !player.looping) segments.chooseAt(position);
    corrections.write(relabelled(corrections.shown, segments.at, said));
  });
}

// Confirm all labels.
function agree({ corrections }) {
  corrections.inTurn(() => {
    if (!corrections.rows.length) return told("There are no labels to confirm yet.");
    corrections.writeAll(corrections.rows.map((row) => ({ ...row, label_source: "human" })));
  });
}

// Undo or redo, and open the recording of the change.
function undo(page, redo = false) {
  page.corrections.inTurn(async () => {
    const id = await page.corrections.undo(redo);
    if (id !== null && id !== page.id) page.onOpen(id);
  });
}
