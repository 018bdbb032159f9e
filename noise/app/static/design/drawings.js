// Torque over time and pressure spectrum of the latest sound.
import { DEEP, LINE, sheet, SOFT } from "../labels/timeline.js";
import { ticks } from "../shared/player.js";

const TOP = 100; // top of the spectrum [dB]
const LOWEST = 50, HIGHEST = 20000; // Hz
const SHOWN = 0.2; // duration of the torque [s]
const EVERY = 120; // redraw interval [ms]

export class Drawings extends EventTarget {
  constructor({ rate, torque_step: step }, sound, torque, spectrum) {
    super();
    Object.assign(this, { rate, sound, screens: { torque, spectrum } });
    this.torque = new Float32Array(Math.round((SHOWN * rate) / step));
    this.dirty = false;
  }

  take({ torque }) {
    this.torque.copyWithin(0, torque.length);
    this.torque.set(torque, this.torque.length - torque.length);
    if (this.dirty) return;
    this.dirty = true;
    setTimeout(() => requestAnimationFrame(() => { this.dirty = false; this.draw(); this.dispatchEvent(new Event("drawn")); }), EVERY);
  }

  // Diagrams are empty before the first sound.
  draw() {
    this.#torque(this.sound.blocks ? this.torque : []);
    this.#spectrum(this.sound.spectrum());
  }

  #torque(of) {
    let low = Infinity, high = -Infinity;
    for (const one of of) { low = Math.min(low, one); high = Math.max(high, one); }
    if (!of.length) [low, high] = [-10, 10];
    const centre = (low + high) / 2, half = Math.max((high - low) / 2, 0.05 * Math.abs(centre), 0.5) * 1.1;
    const rows = ticks(centre - half, centre + half, 3).found.map((value) => [(value - centre + half) / (2 * half), `${value}`]);
    const columns = [0, 50, 100, 150, 200].map((time) => [time / 1000 / SHOWN, `${time}`]);
    const { x, y, pen } = axes(this.screens.torque, rows, columns, "N m", "ms");
    curve(pen, Array.from(of, (value, i) => [x(i / (of.length - 1)), y((value - centre + half) / (2 * half))]));
  }

  // Draw the maximum line in each column of the screen.
  #spectrum(levels) {
    const rows = [0, 20, 40, 60, 80, 100].map((level) => [level / TOP, `${level}`]);
    const columns = [50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000].map((f) => [Math.log(f / LOWEST) / Math.log(HIGHEST / LOWEST), f < 1000 ? `${f}` : `${f / 1000}k`]);
    const { x, y, pen, width } = axes(this.screens.spectrum, rows, columns, "dB re 20 µPa", "Hz");
    const line = (share) => Math.round((LOWEST * (HIGHEST / LOWEST) ** share * 2 * levels.length) / this.rate);
    curve(pen, Array.from({ length: levels.length ? Math.ceil(width) : 0 }, (_, column) => {
      const first = line(column / width), last = Math.max(first + 1, line((column + 1) / width));
      return [x(column / width), y(Math.max(0, ...levels.slice(first, last)) / TOP)];
    }));
  }
}

const LEFT = 34, BELOW = 16, ABOVE = 14; // room for numbers and units [px]

// Draw empty axes; rows and columns are [share of the axis, text].
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
