// Player of a recording: all calibrated ones at one gain; long ones are read in parts.
import { Player } from "../shared/player.js";
import { samples } from "./sounds.js";

const { RATE } = Player;
const QUIETEST = 0.1; // smallest full scale [Pa]
const HEADROOM = 1.12; // peaks between two samples are higher
const LONGEST = 600; // maximum duration of an answer [s]

export class RecordingPlayer extends Player {
  fullScale = null; // of calibrated sounds [Pa]
  sound = null; // { id, channel, kind, calibrated, duration }

  put(sound) {
    Object.assign(this, { sound, kept: null });
    this.stop();
  }

  // Buffer of an interval.
  async load({ start, end }) {
    const { sound } = this, length = Math.max(0.02, Math.min(end - start, LONGEST));
    const from = sound.duration > LONGEST ? Math.max(0, Math.min(start, sound.duration - LONGEST)) : 0;
    if (this.kept?.from !== from) this.kept = { from, read: samples(sound.id, { channel: sound.channel, start: from }) };
    const { kept } = this;
    kept.read.catch(() => { if (this.kept === kept) this.kept = null; });
    const all = await kept.read, begin = Math.round((start - from) * RATE);
    sound.peak = all.reduce((most, one) => Math.max(most, Math.abs(one)), 0);
    const needed = Math.max(QUIETEST, HEADROOM * sound.peak);
    if (sound.calibrated && !(this.fullScale >= needed)) this.fullScale = roundedUp(needed);
    const cut = new Float32Array(Math.max(1, Math.round(length * RATE)));
    cut.set(all.subarray(begin, begin + cut.length));
    const buffer = this.context.createBuffer(1, cut.length, RATE);
    buffer.copyToChannel(cut, 0);
    return { start, a: buffer };
  }

  factor() {
    const { calibrated, kind, peak } = this.sound;
    if (calibrated) return 1 / this.fullScale;
    return kind === "pressure" ? 1 : 0.5 / (peak || 1);
  }

  // Description of the gain for the listener.
  get words() {
    if (!this.sound) return "";
    if (this.sound.kind !== "pressure") return "No sound pressure: scaled to be audible.";
    if (!this.sound.calibrated) return "Not calibrated: played as in the file.";
    if (this.fullScale === null) return "";
    return `Calibrated recordings share one gain: full scale = ${this.fullScale} Pa (${(20 * Math.log10(this.fullScale / 2e-5)).toFixed(0)} dB peak re 20 µPa).`;
  }
}

// A number rounded up to 1, 2 or 5 times a power of ten.
function roundedUp(value) {
  const ten = 10 ** Math.floor(Math.log10(value));
  return Number([1, 2, 5, 10].map((one) => one * ten).find((one) => one >= value * 0.9999).toPrecision(1));
}
