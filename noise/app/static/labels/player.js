// Synchronous player of two recordings at one gain; long ones are read in parts.
import { Player } from "../shared/player.js";
import { samples } from "./sounds.js";

const { RATE } = Player;
const QUIETEST = 0.1; // smallest full scale [Pa]
const HEADROOM = 1.12; // peaks between two samples are higher
const KEPT = 4; // sounds in memory
const LONGEST = 600; // maximum duration of an answer [s]

export class RecordingPlayer extends Player {
  fullScale = null; // of calibrated sounds [Pa]
  kept = new Map();

  // `read` returns the samples of a sound from a time on.
  constructor(read = (sound, start) => samples(sound.id, { channel: sound.channel, start })) {
    super();
    this.read = read; // slots hold { id, name, channel, kind, calibrated, duration, anchor }
  }

  put(slot, sound) {
    const same = this.slots[slot]?.id === sound?.id && this.slots[slot]?.channel === sound?.channel;
    this.slots[slot] = sound;
    if (!sound && this.active === slot) this.active = "a";
    if (!same) this.stop();
    this.tell();
  }

  // Buffer of an interval of a sound, padded with silence to the length of A.
  async #cut(sound, start, length) {
    const from = sound.duration > LONGEST ? Math.max(0, Math.min(start, sound.duration - LONGEST)) : 0;
    const key = `${sound.id} ${sound.channel} ${from}`, whole = this.kept.get(key) ?? this.read(sound, from);
    this.kept.delete(key); // least recently used first
    this.kept.set(key, whole);
    for (const old of this.kept.keys()) if (this.kept.size > KEPT) this.kept.delete(old);
    whole.catch(() => this.kept.delete(key));
    const all = await whole, begin = Math.round((start - from) * RATE);
    sound.peak = all.reduce((most, one) => Math.max(most, Math.abs(one)), 0);
    const cut = new Float32Array(Math.max(1, Math.round(length * RATE)));
    if (begin < all.length && begin + cut.length > 0) cut.set(all.subarray(Math.max(0, begin), begin + cut.length), Math.max(0, -begin));
    const buffer = this.context.createBuffer(1, cut.length, RATE);
    buffer.copyToChannel(cut, 0);
    return buffer;
  }

  // Buffers of an interval of A and the synchronous interval of B.
  async load({ start, end }) {
    const length = Math.max(0.02, Math.min(end - start, LONGEST)), { a, b } = this.slots;
    const shift = (b?.anchor ?? start) - start;
    const [first, second] = await Promise.all([this.#cut(a, start, length), b && this.#cut(b, start + shift, length)]);
    this.#scale();
    return { start, a: first, b: second };
  }

  // Common full scale of calibrated sounds for the loudest so far, in steps of 1, 2, 5.
  #scale() {
    const calibrated = Object.values(this.slots).filter((sound) => sound?.calibrated);
    const needed = Math.max(QUIETEST, ...calibrated.map((sound) => HEADROOM * sound.peak));
    if (calibrated.length && !(this.fullScale >= needed)) this.fullScale = roundedUp(needed);
  }

  // Gain factor of a slot.
  factor(slot) {
    const sound = this.slots[slot];
    if (!sound) return 0;
    if (sound.calibrated) return 1 / (this.fullScale ?? 1);
    return sound.kind === "pressure" ? 1 : 0.5 / (sound.peak || 1);
  }

  hear(slot) { if (this.slots[slot]) super.hear(slot); }

  // Description of the gain for the listener.
  get words() {
    const { a, b } = this.slots, said = [], heard = [a, b].filter(Boolean);
    if (!heard.length) return "";
    if (heard.some((sound) => sound.calibrated) && this.fullScale !== null) said.push(`Calibrated sounds share one gain: full scale = ${this.fullScale} Pa (${(20 * Math.log10(this.fullScale / 2e-5)).toFixed(0)} dB peak re 20 µPa)`);
    if (heard.some((sound) => sound.kind === "pressure" && !sound.calibrated)) said.push("not calibrated: played as in the file");
    if (heard.some((sound) => sound.kind !== "pressure")) said.push("no sound pressure: scaled to be audible");
    return said.join("; ");
  }
}

// A number rounded up to 1, 2 or 5 times a power of ten.
export function roundedUp(value) {
  const ten = 10 ** Math.floor(Math.log10(value));
  return Number([1, 2, 5, 10].map((one) => one * ten).find((one) => one >= value * 0.9999).toPrecision(1));
}
