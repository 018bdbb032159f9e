// Level over time, and levels of an interval.
import { facts } from "./sounds.js";
import { ticks } from "../shared/player.js";
import { caption, DEEP, drawAxis, LINE, sheet } from "./timeline.js";

const LEAST_RANGE = 30; // minimum range of the level axis [dB]
const CAPTION = { width: 90, height: 17 }; // px

export class LevelCourse {
  constructor(timeline, { plot, axis, readout }) {
    Object.assign(this, { timeline, plot, axis, readout });
    this.turn = 0;
  }

  async load(id, channel) {
    this.found = null;
    this.draw();
    const turn = ++this.turn;
    const found = await facts(id, "levels", { channel });
    if (turn !== this.turn) return;
    const known = found.levels.filter((level) => level !== null);
    const most = known.length ? Math.max(...known.slice(0, 1e5)) : 0;
    // Skip the rise of the meter.
    const settled = found.levels.slice(Math.ceil(0.25 / found.cell_s)).filter((level) => level !== null);
    const least = settled.length ? Math.min(...settled) : most - LEAST_RANGE;
    this.found = found;
    this.high = 5 * Math.ceil((most + 1) / 5);
    this.low = Math.max(this.high - 90, Math.min(this.high - LEAST_RANGE, 5 * Math.floor(least / 5)));
    this.draw();
    this.plot.dataset.drawn = id;
  }

  level(time) {
    return this.found?.levels[Math.min(this.found.levels.length - 1, Math.floor(time / this.found.cell_s))] ?? null;
  }

  read(time) {
    const level = time === null ? null : this.level(time);
    this.readout.textContent = level === null ? "" : `${level.toFixed(1)} ${this.found.unit}, Fast`;
  }

  draw() {
    const { pen, width, height } = sheet(this.plot);
    const marked = this.found ? ticks(this.low, this.high, 4).found : [];
    const share = (level) => (this.high - level) / (this.high - this.low), y = (level) => share(level) * height;
    drawAxis(this.axis, 6, marked.map((level) => [share(level), `${level}`]), height);
    if (!this.found) return;
    pen.fillStyle = LINE;
    for (const level of marked) pen.fillRect(0, Math.round(y(level)), width, 1);
    const { cell_s: cell, levels } = this.found;
    pen.strokeStyle = DEEP;
    pen.lineWidth = 1.5;
    pen.beginPath();
    let below = false; // whether the curve passes where the caption would be
    const first = Math.max(0, Math.floor(this.timeline.start / cell) - 1);
    const last = Math.min(levels.length, Math.ceil(this.timeline.end / cell) + 1);
    const each = Math.max(1, Math.floor((last - first) / (2 * width)));
    for (let at = first; at < last; at += each) {
      let most = this.low;
      for (let one = at; one < Math.min(last, at + each); one++) most = Math.max(most, levels[one] ?? this.low);
      const x = this.timeline.share((at + each / 2) * cell) * width;
      below ||= x < CAPTION.width && y(most) > height - CAPTION.height;
      pen.lineTo(x, y(most));
    }
    pen.stroke();
    caption(pen, `${this.found.unit}, Fast`, below ? CAPTION.height : height);
  }
}

export async function levelsOf(id, channel, from, to) {
  const { start, end, unit, level, level_a: weighted, level_af_max: most, third_octaves: octaves } = await facts(id, "bands", { channel, start: from, end: to });
  const said = (value, what) => (value === null ? [] : [`${value.toFixed(1)} ${what}`]);
  const strongest = Object.entries(octaves).filter(([, value]) => value !== null).sort(([, one], [, two]) => two - one)[0];
  const words = [...said(level, unit), ...said(weighted, unit === "dBFS" ? "dBFS(A)" : "dB(A)"), ...said(most, "Fast at most")].join(", ");
  return `${start.toFixed(2)}–${end.toFixed(2)} s: ${words}${strongest ? `; strongest third octave ${strongest[0]} Hz, ${strongest[1].toFixed(1)}` : ""}`;
}
