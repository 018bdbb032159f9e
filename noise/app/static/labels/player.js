// Two recordings run in step, A and B, at one gain or at equal loudness; to change over is to cross their gains.
import { Voices } from "../shared/voices.js";
import { facts, samples } from "./sounds.js";

const RATE = 48000; // Hz
const QUIETEST = 0.1; // nothing is amplified beyond this full scale [Pa]
const HEADROOM = 1.12; // peaks between two samples are higher
const KEPT = 4; // sounds in memory
const LONGEST = 600; // of one answer of the server [s]
const TARGET = -23, CEILING = -3, MOST_RAISED = 36; // LUFS, dB re full scale, dB
const SLOPES = [0.541, 1.307]; // quality of two second-order filters: Butterworth, 24 dB an octave

export class Player extends EventTarget {
  // `read` gives the samples of a sound from a moment on, as many as there are in one answer.
  constructor(tell, read = (sound, start) => samples(sound.id, { channel: sound.channel, start })) {
    super();
    this.tell = tell;
    this.read = read;
    this.slots = { a: null, b: null }; // { id, name, channel, kind, calibrated, duration, anchor }
    this.active = "a";
    this.looping = true;
    this.equal = false;
    this.fullScale = null; // of calibrated sounds [Pa]
    this.band = null; // { low, high } [Hz]
    this.position = 0;
    this.running = null;
    this.kept = new Map();
    this.request = 0;
  }

  get playing() { return this.running !== null; }

  #open() {
    this.context ??= new AudioContext({ sampleRate: RATE });
    if (this.context.state === "suspended") this.context.resume();
    return this.context;
  }

  put(slot, sound) {
    const same = this.slots[slot]?.id === sound?.id && this.slots[slot]?.channel === sound?.channel;
    this.slots[slot] = sound;
    if (!sound && this.active === slot) this.active = "a";
    if (!same) this.stop();
    this.#tell();
  }

  #tell() { this.dispatchEvent(new Event("change")); }

  // Where A is [s].
  now() {
    return this.running ? this.start + this.running.position : this.position;
  }

  // A stretch of a sound, silent where there is nothing: all that is played is as long as A's.
  async #cut(sound, start, length) {
    const from = Math.max(0, Math.min(start, Math.max(0, sound.duration - LONGEST)));
    const key = `${sound.id} ${sound.channel} ${sound.duration > LONGEST ? from : 0}`;
    const whole = this.kept.get(key) ?? this.read(sound, sound.duration > LONGEST ? from : 0);
    this.kept.delete(key); // the one used last is kept longest
    this.kept.set(key, whole);
    for (const old of this.kept.keys()) if (this.kept.size > KEPT) this.kept.delete(old);
    whole.catch(() => this.kept.delete(key));
    const all = await whole;
    sound.peak = all.reduce((most, one) => Math.max(most, Math.abs(one)), 0);
    const begin = Math.round((start - (sound.duration > LONGEST ? from : 0)) * RATE);
    const cut = new Float32Array(Math.max(1, Math.round(length * RATE)));
    if (begin < all.length && begin + cut.length > 0) cut.set(all.subarray(Math.max(0, begin), begin + cut.length), Math.max(0, -begin));
    const buffer = this.context.createBuffer(1, cut.length, RATE);
    buffer.copyToChannel(cut, 0);
    return buffer;
  }

  // Play a stretch of A from a moment on, and of B what is in step with it.
  async play({ start, end }, from) {
    const context = this.#open(), mine = ++this.request;
    const length = Math.max(0.02, Math.min(end - start, LONGEST));
    const { a, b } = this.slots;
    const shift = b?.anchor !== null && b?.anchor !== undefined ? b.anchor - start : 0;
    const [first, second] = await Promise.all([this.#cut(a, start, length), b && this.#cut(b, start + shift, length)]);
    if (mine !== this.request) return;
    this.#scale();
    if (this.equal) await this.#measure({ start, end: start + length }, shift);
    if (mine !== this.request) return;
    this.#silence();
    this.bus = context.createGain();
    this.#filter();
    this.start = start;
    this.running = new Voices(context, { a: first, b: second }, {
      offset: Math.min(Math.max(0, from - start), length) % length, loop: this.looping, level: (slot) => this.gain(slot), target: this.bus, ended: () => this.stop(),
    });
    this.#tell();
  }

  stop() {
    this.request++;
    this.position = this.now();
    this.#silence();
    this.#tell();
  }

  #silence() {
    this.running?.silence();
    this.running = null;
  }

  // One full scale for all calibrated sounds: what the loudest so far needs, in steps of 1, 2, 5.
  #scale() {
    const calibrated = Object.values(this.slots).filter((sound) => sound?.calibrated);
    const needed = Math.max(QUIETEST, ...calibrated.map((sound) => HEADROOM * sound.peak));
    if (!calibrated.length || (this.fullScale !== null && this.fullScale >= needed)) return;
    const ten = 10 ** Math.floor(Math.log10(needed));
    this.fullScale = Number([1, 2, 5, 10].map((one) => one * ten).find((one) => one >= needed * 0.9999).toPrecision(1));
  }

  // By which the samples of a slot are multiplied before it is heard or not.
  factor(slot) {
    const sound = this.slots[slot];
    if (!sound) return 0;
    if (this.equal && sound.equal) return sound.equal;
    if (sound.calibrated) return 1 / (this.fullScale ?? 1);
    return sound.kind === "pressure" ? 1 : 0.5 / (sound.peak || 1);
  }

  gain(slot) { return slot === this.active ? this.factor(slot) : 0; }

  async #measure(stretch, shift) {
    const known = [];
    for (const [slot, sound] of Object.entries(this.slots)) {
      if (!sound) continue;
      const by = slot === "b" ? shift : 0;
      const found = await facts(sound.id, "loudness", { channel: sound.channel, start: Math.max(0, stretch.start + by), end: stretch.end + by });
      sound.equal = null;
      if (found.loudness !== null) known.push({ sound, ...found });
    }
    const target = Math.min(TARGET, ...known.map(({ loudness, peak }) => loudness - 20 * Math.log10(peak) + CEILING));
    for (const { sound, loudness } of known) {
      const raised = target - loudness - 20 * Math.log10(1 / (this.fullScale ?? 1));
      sound.equal = raised > MOST_RAISED ? null : 10 ** ((target - loudness) / 20);
    }
    this.target = target;
  }

  hear(slot) {
    if (!this.slots[slot]) return;
    this.active = slot;
    this.running?.cross();
    this.#tell();
  }

  setBand(band) {
    this.band = band;
    if (this.running) this.#filter();
    this.#tell();
  }

  #filter() {
    this.bus.disconnect();
    let last = this.bus;
    if (this.band) {
      for (const [type, frequency] of [["highpass", this.band.low], ["lowpass", this.band.high]]) {
        for (const quality of SLOPES) {
          const filter = Object.assign(this.context.createBiquadFilter(), { type });
          filter.frequency.value = Math.min(frequency, 0.499 * RATE);
          filter.Q.value = 20 * Math.log10(quality); // of these types in dB
          last = last.connect(filter);
        }
      }
    }
    last.connect(this.context.destination);
  }

  // What a listener has to know before comparing.
  get words() {
    const { a, b } = this.slots, said = [];
    const heard = [a, b].filter(Boolean);
    if (!heard.length) return "";
    const equal = (sound) => this.equal && sound.equal;
    if (heard.every(equal)) {
      const decibel = (slot) => `${(20 * Math.log10(this.factor(slot) * (this.slots[slot].calibrated ? this.fullScale : 1))).toFixed(1)} dB`;
      said.push(`Equal loudness, ${this.target.toFixed(0)} LUFS: A ${decibel("a")}${b ? `, B ${decibel("b")}` : ""} beside ${heard.every((sound) => sound.calibrated) ? "the one gain" : "what the files hold"}`);
    } else if (heard.some((sound) => sound.calibrated) && this.fullScale !== null) {
      said.push(`Calibrated sounds share one gain: full scale = ${this.fullScale} Pa (${(20 * Math.log10(this.fullScale / 2e-5)).toFixed(0)} dB peak re 20 µPa)`);
    }
    if (heard.some((sound) => sound.kind === "pressure" && !sound.calibrated && !equal(sound))) said.push("not calibrated: played as it is in the file");
    if (heard.some((sound) => sound.kind !== "pressure" && !equal(sound))) said.push("no sound pressure: played at a gain of its own");
    if (this.band) said.push(`heard from ${this.band.low.toFixed(0)} to ${this.band.high.toFixed(0)} Hz`);
    return said.join("; ");
  }
}
