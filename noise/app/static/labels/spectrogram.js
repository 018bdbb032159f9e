// Spectrogram with axes and cursor readout.
import { numbers } from "./sounds.js";
import { DEEP, drawAxis, INK, SOFT, sheet } from "./timeline.js";

const FINER = 90; // after the view has come to rest [ms]
const RANGE = 70; // from the darkest colour to white [dB]
const FREQUENCIES = [20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000];

export class Spectrogram {
  constructor(timeline, { plot, marks, axis, legend, readout }) {
    Object.assign(this, { timeline, plot, marks, axis, legend, readout });
    this.cursor = null; // { time, frequency }
    this.whole = this.fine = null;
    this.turn = 0;
  }

  async load(id, channel) {
    Object.assign(this, { id, channel, whole: null, fine: null, top: null, cursor: null });
    const turn = ++this.turn;
    clearTimeout(this.timer);
    const found = await this.#part(0, null);
    if (turn !== this.turn) return;
    this.whole = this.#picture(found);
    this.top = found.top;
    this.draw();
    this.refine(); // the canvas may have had no size before
    this.plot.dataset.drawn = id;
  }

  async #part(start, end) {
    const fine = window.devicePixelRatio || 1;
    const width = Math.min(2400, Math.max(16, Math.round(this.plot.clientWidth * fine)));
    const height = Math.min(600, Math.max(16, Math.round(this.plot.clientHeight * fine)));
    const said = { channel: this.channel, start, end, width, height };
    const found = await numbers(this.id, "spectrogram", said, Uint8Array);
    let most = 0;
    for (const byte of found.values) if (byte > most) most = byte;
    return { ...found, top: 5 * Math.ceil((found.floor + most * found.step) / 5) };
  }

  #picture(found) {
    const canvas = Object.assign(document.createElement("canvas"), { width: found.width, height: found.height });
    const pen = canvas.getContext("2d"), image = pen.createImageData(found.width, found.height);
    const words = new Uint32Array(image.data.buffer);
    const of = palette(found.floor, found.step, this.top ?? found.top, RANGE);
    for (let i = 0; i < words.length; i++) words[i] = of[found.values[i]];
    pen.putImageData(image, 0, 0);
    return { ...found, canvas };
  }

  // Request the visible part, after the view has come to rest.
  refine() {
    clearTimeout(this.timer);
    if (!this.whole) return;
    this.timer = setTimeout(async () => {
      const { start, end } = this.timeline, turn = ++this.turn;
      if (this.#has(start, end)) {
        this.fine = null;
        this.draw();
        return;
      }
      const found = await this.#part(start, end);
      if (turn !== this.turn) return;
      this.fine = this.#picture(found);
      this.draw();
    }, FINER);
  }

  // Whether the picture of the whole shows the interval finely enough.
  #has(start, end) {
    const { whole } = this, fine = window.devicePixelRatio || 1;
    return start === whole.start && end === whole.end
      && whole.width >= Math.min(2400, Math.round(this.plot.clientWidth * fine));
  }

  draw() {
    const { pen, width, height } = sheet(this.plot);
    for (const picture of [this.whole, this.fine]) {
      if (!picture) continue;
      const from = this.timeline.share(picture.start) * width;
      const to = this.timeline.share(picture.end) * width;
      pen.imageSmoothingEnabled = false;
      pen.drawImage(picture.canvas, from, 0, to - from, height);
    }
    this.#drawAxis();
    this.#drawLegend();
    this.drawMarks();
  }

  share(frequency) { return Math.log(this.whole.high / frequency) / Math.log(this.whole.high / this.whole.low); }

  frequency(share) { return this.whole.high * (this.whole.low / this.whole.high) ** Math.min(1, Math.max(0, share)); }

  #drawAxis() {
    const shown = FREQUENCIES.filter((one) => this.whole && one >= this.whole.low && one <= this.whole.high);
    const rows = shown.map((one) => [this.share(one), one < 1000 ? `${one}` : `${one / 1000}k`]);
    if (rows.length) rows.at(-1)[1] += " Hz";
    const { pen, width, height } = drawAxis(this.axis, 9, rows);
    if (!this.whole) return;
    for (const [share] of rows) pen.fillRect(width - 6, share * height, 6, 1);
  }

  #drawLegend() {
    const { pen, width, height } = sheet(this.legend);
    if (!this.whole) return;
    const top = this.top, low = top - RANGE;
    const bar = { from: 2, to: Math.max(60, width - 110) };
    for (let x = bar.from; x < bar.to; x++) {
      pen.fillStyle = `rgb(${colour((x - bar.from) / (bar.to - bar.from)).join(" ")})`;
      pen.fillRect(x, 1, 1, 9);
    }
    pen.strokeStyle = SOFT;
    pen.strokeRect(bar.from - 0.5, 0.5, bar.to - bar.from + 1, 10);
    pen.fillStyle = INK;
    pen.textBaseline = "alphabetic";
    for (let level = low; level <= top; level += 10) {
      const share = (level - low) / RANGE;
      pen.textAlign = share === 0 ? "left" : "center";
      pen.fillText(`${level}`, bar.from + share * (bar.to - bar.from), height - 2);
    }
    pen.textAlign = "left";
    pen.fillText(this.whole.unit, bar.to + 14, 10);
    this.legend.setAttribute("aria-label", `Colours from ${low} (white) to ${top} (black) ${this.whole.unit}`);
  }

  // Level at a point of the finest picture [dB]; null outside.
  level(time, frequency) {
    for (const picture of [this.fine, this.whole]) {
      if (!picture || time < picture.start || time >= picture.end) continue;
      const column = Math.floor(((time - picture.start) / (picture.end - picture.start)) * picture.width);
      const row = Math.min(picture.height - 1, Math.floor(this.share(frequency) * picture.height));
      return picture.floor + picture.step * picture.values[row * picture.width + column];
    }
    return null;
  }

  // Move the cursor and read the level; null removes it.
  read(time, frequency) {
    this.cursor = time === null || !this.whole ? null : { time, frequency };
    this.drawMarks();
    if (!this.cursor) return;
    const level = this.level(time, frequency);
    const rough = frequency < 1000 ? frequency.toFixed(1) : frequency.toFixed(0);
    this.readout.textContent = `${time.toFixed(3)} s, ${rough} Hz: ${level === null ? "–" : level.toFixed(1)} ${this.whole.unit}`;
    Object.assign(this.readout.dataset, { time, frequency, level: level ?? "" });
  }

  drawMarks() {
    const { pen, width, height } = sheet(this.marks);
    if (!this.cursor || !this.whole) return;
    const x = Math.round(this.timeline.share(this.cursor.time) * width) + 0.5, y = Math.round(this.share(this.cursor.frequency) * height) + 0.5;
    for (const [strokeStyle, lineWidth] of [["#fff", 3], [DEEP, 1]]) {
      Object.assign(pen, { strokeStyle, lineWidth });
      stroke(pen, 0, y, width, y);
      stroke(pen, x, 0, x, height);
    }
  }
}

function stroke(pen, x1, y1, x2, y2) {
  pen.beginPath();
  pen.moveTo(x1, y1);
  pen.lineTo(x2, y2);
  pen.stroke();
}

// Colours of levels, the same on all spectrograms of the program.
const ANCHORS = "ffffff fde0a1 fec287 fea571 fb8761 f4695c e55064 cf4070 b5367a 9b2e7f 812581 681c81 4f127b 341069 1c1044 090720 000004".split(" ")
  .map((hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)));

// Colours of all byte levels as pixels.
function palette(floor, step, top, range) {
  const words = new Uint32Array(256);
  for (let byte = 0; byte < 256; byte++) {
    const [red, green, blue] = colour((floor + byte * step - top + range) / range);
    words[byte] = 0xff000000 | (blue << 16) | (green << 8) | red; // as little-endian machines have it
  }
  return words;
}

function colour(share) {
  const at = Math.min(1, Math.max(0, share)) * (ANCHORS.length - 1);
  const low = Math.min(ANCHORS.length - 2, Math.floor(at));
  return ANCHORS[low].map((from, part) => Math.round(from + (at - low) * (ANCHORS[low + 1][part] - from)));
}
