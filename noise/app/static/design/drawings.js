// Torque over time and spectrum of the pressure, of what was heard last.
import { DEEP, LINE, sheet, SOFT } from "../labels/timeline.js";
import { ticks } from "../shared/player.js";

const REFERENCE = 2e-5, SIZE = 8192, FLOOR = 0, TOP = 100; // Pa, samples, dB
const LOWEST = 50, HIGHEST = 20000; // Hz
const SHOWN = 0.2; // of the torque [s]
const EVERY = 120; // drawn anew [ms]

export class Drawings extends EventTarget {
  constructor({ rate, torque_step: step }, torque, spectrum) {
    super();
    this.rate = rate;
    this.torqueRate = rate / step;
    this.pressure = new Float32Array(SIZE);
    this.torque = new Float32Array(Math.round(SHOWN * this.torqueRate));
    this.screens = { torque, spectrum };
    this.mean = null;
    this.dirty = false;
  }

  take({ pressure, torque }) {
    push(this.pressure, pressure);
    push(this.torque, torque);
    if (this.dirty) return;
    this.dirty = true;
    setTimeout(() => requestAnimationFrame(() => { this.dirty = false; this.draw(); this.dispatchEvent(new Event("drawn")); }), EVERY);
  }

  draw() {
    this.#torque();
    this.#spectrum();
  }

  #torque() {
    const of = this.torque;
    let low = Infinity, high = -Infinity;
    for (const one of of) { low = Math.min(low, one); high = Math.max(high, one); }
    const centre = (low + high) / 2, half = Math.max((high - low) / 2, 0.05 * Math.abs(centre), 0.5) * 1.1;
    const rows = ticks(centre - half, centre + half, 3).found.map((value) => [(value - centre + half) / (2 * half), `${value}`]);
    const columns = [0, 50, 100, 150, 200].map((time) => [time / 1000 / SHOWN, `${time}`]);
    const { x, y, pen } = axes(this.screens.torque, rows, columns, "N m", "ms");
    curve(pen, Array.from(of, (value, i) => [x(i / (of.length - 1)), y((value - centre + half) / (2 * half))]));
  }

  #spectrum() {
    const power = powers(this.pressure);
    this.mean ??= power.slice();
    for (let i = 0; i < power.length; i++) this.mean[i] += 0.3 * (power[i] - this.mean[i]);
    const rows = [0, 20, 40, 60, 80, 100].map((level) => [(level - FLOOR) / (TOP - FLOOR), `${level}`]);
    const columns = [50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000].map((f) => [Math.log(f / LOWEST) / Math.log(HIGHEST / LOWEST), f < 1000 ? `${f}` : `${f / 1000}k`]);
    const { x, y, pen, width } = axes(this.screens.spectrum, rows, columns, "dB re 20 µPa", "Hz");
    const points = [];
    for (let column = 0; column < width; column++) {
      const from = LOWEST * (HIGHEST / LOWEST) ** (column / width), to = LOWEST * (HIGHEST / LOWEST) ** ((column + 1) / width);
      const first = Math.max(1, Math.round(from * SIZE / this.rate)), last = Math.max(first, Math.round(to * SIZE / this.rate) - 1);
      let most = 0;
      for (let i = first; i <= last && i < this.mean.length; i++) most = Math.max(most, this.mean[i]);
      points.push([x(column / width), y(Math.max(0, (10 * Math.log10(most / REFERENCE ** 2 + 1e-30) - FLOOR) / (TOP - FLOOR)))]);
    }
    curve(pen, points);
  }
}

function push(held, more) {
  if (more.length >= held.length) { held.set(more.subarray(more.length - held.length)); return; }
  held.copyWithin(0, more.length);
  held.set(more, held.length - more.length);
}

const LEFT = 34, BELOW = 16, ABOVE = 14; // room for numbers and units [px]

// An empty diagram, its numbers outside of it; [share of the axis, text] of each row and column.
function axes(canvas, rows, columns, up, along) {
  const { pen, width: whole, height: full } = sheet(canvas), width = whole - LEFT - 8, height = full - BELOW - ABOVE;
  const x = (share) => LEFT + share * width, y = (share) => ABOVE + (1 - share) * height;
  Object.assign(pen, { strokeStyle: LINE, fillStyle: SOFT, lineWidth: 1, textBaseline: "middle", textAlign: "right" });
  pen.strokeRect(LEFT, ABOVE, width, height);
  pen.beginPath();
  for (const [share, text] of rows) { pen.moveTo(LEFT, y(share)); pen.lineTo(LEFT + width, y(share)); pen.fillText(text.replace("-", "−"), LEFT - 4, y(share)); }
  pen.textAlign = "center";
  for (const [share, text] of columns) { pen.moveTo(x(share), ABOVE); pen.lineTo(x(share), ABOVE + height); pen.fillText(text, Math.min(x(share), whole - 10), full - BELOW / 2); }
  pen.stroke();
  pen.textAlign = "left";
  pen.fillText(up, LEFT, 6);
  pen.fillText(along, 2, full - BELOW / 2);
  pen.beginPath();
  pen.rect(LEFT, ABOVE, width, height);
  pen.clip();
  return { x, y, pen, width };
}

function curve(pen, points) {
  pen.beginPath();
  for (const point of points) pen.lineTo(...point);
  Object.assign(pen, { strokeStyle: DEEP, lineWidth: 1.5 });
  pen.stroke();
}

const window_ = Float64Array.from({ length: SIZE }, (_, i) => 0.5 - 0.5 * Math.cos(2 * Math.PI * i / SIZE));

// Mean square of each line under a Hann window [Pa^2].
function powers(signal) {
  const real = new Float64Array(SIZE), imaginary = new Float64Array(SIZE);
  let bits = Math.log2(SIZE), mean = 0;
  for (const one of signal) mean += one / SIZE;
  for (let i = 0; i < SIZE; i++) {
    let j = 0;
    for (let bit = 0; bit < bits; bit++) j |= ((i >> bit) & 1) << (bits - 1 - bit);
    real[j] = (signal[i] - mean) * window_[i];
  }
  for (let size = 2; size <= SIZE; size *= 2) {
    const half = size / 2, turn = -2 * Math.PI / size;
    for (let k = 0; k < half; k++) {
      const c = Math.cos(turn * k), s = Math.sin(turn * k);
      for (let i = k; i < SIZE; i += size) {
        const j = i + half, re = real[j] * c - imaginary[j] * s, im = real[j] * s + imaginary[j] * c;
        real[j] = real[i] - re; imaginary[j] = imaginary[i] - im;
        real[i] += re; imaginary[i] += im;
      }
    }
  }
  const power = new Float64Array(SIZE / 2);
  for (let i = 0; i < power.length; i++) power[i] = 8 * (real[i] ** 2 + imaginary[i] ** 2) / SIZE ** 2;
  return power;
}
