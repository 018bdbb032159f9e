// Waveform over time: minimum and maximum per column.
import { numbers } from "./sounds.js";
import { caption, DEEP, drawAxis, LINE, sheet } from "./timeline.js";

const FINER = 60; // after the view has come to rest [ms]

export class Outline {
  constructor(timeline, { plot, axis, name = "" }) {
    Object.assign(this, { timeline, plot, axis, name }); // the name is drawn in stacked lanes
    this.parts = [];
    this.turn = 0;
  }

  async load(id, channel) {
    Object.assign(this, { id, channel, parts: [] });
    await this.#ask(0, null, 0);
  }

  async #ask(start, end, place) {
    const turn = ++this.turn;
    const width = Math.max(16, Math.round(this.plot.clientWidth * (window.devicePixelRatio || 1)));
    const found = await numbers(this.id, "outline", { channel: this.channel, start, end, width }, Float32Array);
    if (turn !== this.turn) return;
    this.parts[place] = found;
    if (!place) {
      this.high = found.values.reduce((most, one) => Math.max(most, one), -Infinity);
      this.low = found.values.reduce((least, one) => Math.min(least, one), Infinity);
    }
    this.draw();
  }

  refine() {
    clearTimeout(this.timer);
    if (!this.parts.length) return;
    this.timer = setTimeout(() => this.#ask(this.timeline.start, this.timeline.end, 1), FINER);
  }

  draw() {
    const { pen, width, height } = sheet(this.plot);
    const { start, end } = this.timeline;
    const fine = this.parts[1];
    const part = fine && fine.start <= start + 1e-3 && fine.end >= end - 1e-3 ? fine : this.parts[0];
    const written = (value) => `${Number(value.toPrecision(3))}`;
    drawAxis(this.axis, 4, part ? [[0.03, written(this.high)], [0.97, written(this.low)], [0.5, part.unit]] : []);
    if (!part) return;
    const y = (value) => (0.03 + (0.94 * (this.high - value)) / (this.high - this.low || 1)) * height;
    pen.fillStyle = LINE;
    pen.fillRect(0, y(0), width, 1);
    const columns = part.values.length / 2, step = (part.end - part.start) / columns;
    pen.fillStyle = DEEP;
    const from = Math.max(0, Math.floor((start - part.start) / step));
    const to = Math.min(columns, Math.ceil((end - part.start) / step));
    for (let column = from; column < to; column++) {
      const x = this.timeline.share(part.start + column * step) * width;
      const low = y(part.values[column]), high = y(part.values[columns + column]);
      pen.fillRect(x, high, Math.max(1, (step / this.timeline.span) * width), Math.max(1, low - high));
    }
    caption(pen, this.name, height);
  }
}
