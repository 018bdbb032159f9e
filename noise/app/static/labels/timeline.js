// Time axis of all lanes: visible interval, position and selection.

import { ticks } from "../shared/player.js";

const SHORTEST = 0.005; // minimum visible interval [s]

export class Timeline extends EventTarget {
  constructor() {
    super();
    this.reset(1);
  }

  reset(duration) {
    this.duration = duration;
    this.start = 0;
    this.end = duration;
    this.position = 0;
    this.selection = null; // { start, end }
    this.#tell("view");
  }

  get span() { return this.end - this.start; }

  share(time) { return (time - this.start) / this.span; }

  time(share) { return Math.min(this.duration, Math.max(0, this.start + share * this.span)); }

  look(start, end) {
    const span = Math.min(this.duration, Math.max(end - start, Math.min(SHORTEST, this.duration)));
    const first = Math.min(Math.max(0, start), this.duration - span);
    if (first === this.start && first + span === this.end) return;
    this.start = first;
    this.end = first + span;
    this.#tell("view");
  }

  zoom(factor, about = this.position) {
    const middle = about >= this.start && about <= this.end ? about : (this.start + this.end) / 2;
    this.look(middle - (middle - this.start) / factor, middle + (this.end - middle) / factor);
  }

  pan(share) { this.look(this.start + share * this.span, this.end + share * this.span); }

  whole() { this.look(0, this.duration); }

  // Show an interval with margins of a tenth.
  fit(start, end) { this.look(start - 0.1 * (end - start), end + 0.1 * (end - start)); }

  go(time) {
    this.position = Math.min(this.duration, Math.max(0, time));
    this.#tell("position");
  }

  select(start, end) {
    this.selection = start === null ? null : { start: Math.max(0, Math.min(start, end)), end: Math.min(this.duration, Math.max(start, end)) };
    this.#tell("selection");
  }

  #tell(what) { this.dispatchEvent(new Event(what)); }
}

// Cleared canvas at screen resolution with CSS pixels as unit.
export function sheet(canvas) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const fine = window.devicePixelRatio || 1;
  const [w, h] = [Math.round(width * fine), Math.round(height * fine)];
  Object.assign(canvas, { width: w, height: h }); // clears it
  const pen = canvas.getContext("2d");
  pen.setTransform(fine, 0, 0, fine, 0, 0);
  pen.font = "11px system-ui, sans-serif";
  return { pen, width, height };
}

export function seconds(time, step = 0.001) {
  return time.toFixed(Math.max(0, Math.min(4, Math.ceil(-Math.log10(step) - 1e-9))));
}

export const INK = "#1d2329", SOFT = "#55606b", LINE = "#d9dee3", DEEP = "#0b57a4";

// Caption in the corner of a lane.
export function caption(pen, text, height) {
  if (!text) return;
  Object.assign(pen, { fillStyle: "#ffffffe0", textAlign: "left", textBaseline: "middle" });
  pen.fillRect(4, height - 15, pen.measureText(text).width + 4, 13);
  pen.fillStyle = SOFT;
  pen.fillText(text, 6, height - 8);
}

// Axis labels [share from the top, text] beside a lane.
export function drawAxis(canvas, room, rows, height = canvas.clientHeight) {
  const { pen, width } = sheet(canvas);
  Object.assign(pen, { fillStyle: SOFT, textAlign: "right", textBaseline: "middle" });
  for (const [share, text] of rows) pen.fillText(text.replace("-", "−"), width - room, Math.min(height - 6, Math.max(6, share * height)));
  return { pen, width, height };
}

export function drawTimes(canvas, timeline) {
  const { pen, width } = sheet(canvas);
  pen.fillStyle = SOFT;
  pen.textBaseline = "middle";
  const { step, found } = ticks(timeline.start, timeline.end, width / 80);
  for (const time of found) {
    const x = timeline.share(time) * width;
    pen.fillRect(Math.min(width - 1, Math.round(x)), 0, 1, 4);
    pen.textAlign = x < 16 ? "left" : x > width - 16 ? "right" : "center";
    pen.fillText(seconds(time, step), x, 12);
  }
}
