// Torque over time and spectrum of the pressure, of what was heard last.
import { sheet } from "../labels/timeline.js";
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
    const { pen, width, height } = sheet(this.screens.torque), of = this.torque;
    let low = Infinity, high = -Infinity;
    for (const one of of) { low = Math.min(low, one); high = Math.max(high, one); }
    const centre = (low + high) / 2, half = Math.max((high - low) / 2, 0.05 * Math.abs(centre), 0.5) * 1.1;
    const y = (value) => height / 2 - (value - centre) / half * height / 2;
    grid(pen, width, height, ticks(centre - half, centre + half, 4).found.map((value) => [y(value), `${value} Nm`]), []);
    pen.beginPath();
    for (let i = 0; i < of.length; i++) pen.lineTo(i / (of.length - 1) * width, y(of[i]));
    pen.strokeStyle = "#0b57a4";
    pen.lineWidth = 1.5;
    pen.stroke();
  }

  #spectrum() {
    const { pen, width, height } = sheet(this.screens.spectrum);
    const power = powers(this.pressure);
    this.mean ??= power.slice();
    for (let i = 0; i < power.length; i++) this.mean[i] += 0.3 * (power[i] - this.mean[i]);
    const x = (f) => Math.log(f / LOWEST) / Math.log(HIGHEST / LOWEST) * width;
    const y = (level) => height * (1 - (level - FLOOR) / (TOP - FLOOR));
    const lines = [0, 20, 40, 60, 80].map((level) => [y(level), `${level} dB`]);
    const marks = [100, 1000, 10000].map((f) => [x(f), f < 1000 ? `${f} Hz` : `${f / 1000} kHz`]);
    grid(pen, width, height, lines, marks);
    pen.beginPath();
    for (let column = 0; column < width; column++) {
      const from = LOWEST * (HIGHEST / LOWEST) ** (column / width), to = LOWEST * (HIGHEST / LOWEST) ** ((column + 1) / width);
      const first = Math.max(1, Math.round(from * SIZE / this.rate)), last = Math.max(first, Math.round(to * SIZE / this.rate) - 1);
      let most = 0;
      for (let i = first; i <= last && i < this.mean.length; i++) most = Math.max(most, this.mean[i]);
      pen.lineTo(column, y(Math.max(FLOOR - 10, 10 * Math.log10(most / REFERENCE ** 2 + 1e-30))));
    }
    pen.strokeStyle = "#0b57a4";
    pen.lineWidth = 1.5;
    pen.stroke();
  }
}

function push(held, more) {
  if (more.length >= held.length) { held.set(more.subarray(more.length - held.length)); return; }
  held.copyWithin(0, more.length);
  held.set(more, held.length - more.length);
}

function grid(pen, width, height, across, along) {
  pen.strokeStyle = "#d9dee3";
  pen.fillStyle = "#55606b";
  pen.lineWidth = 1;
  pen.font = "11px system-ui, sans-serif";
  pen.beginPath();
  for (const [y] of across) { pen.moveTo(0, y); pen.lineTo(width, y); }
  for (const [x] of along) { pen.moveTo(x, 0); pen.lineTo(x, height); }
  pen.stroke();
  for (const [y, text] of across) if (y > 12) pen.fillText(text, 3, y - 3);
  for (const [x, text] of along) pen.fillText(text, x + 3, height - 4);
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
