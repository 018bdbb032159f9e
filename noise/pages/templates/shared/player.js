// Player of two synchronous sounds A and B; switching crossfades their gains.
const CROSSING = 0.02, AHEAD = 0.03; // s

class Voices {
  // Buffers of equal length by slot; `level` returns the gain of a slot, `ended` is called at the end.
  constructor(context, buffers, { offset, loop, level, target, ended }) {
    Object.assign(this, { context, offset, loop, level, voices: {}, began: context.currentTime + AHEAD });
    for (const [slot, buffer] of Object.entries(buffers)) {
      if (!buffer) continue;
      const source = Object.assign(context.createBufferSource(), { buffer, loop }), gain = context.createGain();
      gain.gain.setValueAtTime(0, this.began);
      gain.gain.linearRampToValueAtTime(level(slot), this.began + CROSSING);
      source.connect(gain).connect(target);
      source.start(this.began, offset);
      this.voices[slot] = { source, gain };
      this.length = buffer.duration;
    }
    Object.values(this.voices)[0].source.onended = ended;
  }

  // Position within the buffers [s].
  get position() {
    const played = this.offset + Math.max(0, this.context.currentTime - this.began);
    return this.loop ? played % this.length : Math.min(played, this.length);
  }

  get gains() { return Object.fromEntries(Object.entries(this.voices).map(([slot, { gain }]) => [slot, gain.gain.value])); }

  cross() { for (const slot of Object.keys(this.voices)) this.#ramp(slot, this.level(slot), 0); }

  // Fade out while a new sound fades in.
  silence() {
    for (const [slot, { source }] of Object.entries(this.voices)) {
      source.onended = null;
      this.#ramp(slot, 0, AHEAD);
      source.stop(this.context.currentTime + AHEAD + CROSSING);
    }
  }

  #ramp(slot, level, after) {
    const { gain } = this.voices[slot].gain, at = this.context.currentTime + after;
    gain.cancelScheduledValues(0);
    gain.setValueAtTime(gain.value, at);
    gain.linearRampToValueAtTime(level, at + CROSSING);
  }
}

// Subclasses define `load`, which returns buffers and their start, and `factor`, the gain of a slot.
export class Player extends EventTarget {
  slots = { a: null, b: null };
  active = "a";
  looping = true;
  start = 0; // start of the interval [s]
  position = 0; // position while paused [s]
  running = null;
  context = null;
  request = 0;

  static RATE = 48000; // Hz

  get playing() { return this.running !== null; }

  get gains() { return this.running ? this.running.gains : {}; }

  now() { return this.running ? this.start + this.running.position : this.position; }

  open() {
    this.context ??= new AudioContext({ sampleRate: Player.RATE });
    if (this.context.state === "suspended") this.context.resume();
    return this.context;
  }

  // Play from a time on; a running sound crossfades to the new one.
  async play(from, ...what) {
    this.open();
    const mine = ++this.request, found = await this.load(...what);
    if (mine !== this.request || !found) return;
    const { start = 0, ...buffers } = found, { duration } = buffers.a ?? buffers.b;
    let offset = (from ?? this.now() + (this.running ? AHEAD : 0)) - start;
    if (offset < 0 || offset >= duration) offset = this.looping && offset > 0 ? offset % duration : 0;
    this.silence();
    this.start = start;
    this.running = new Voices(this.context, buffers, {
      offset, loop: this.looping, level: (slot) => this.level(slot), target: this.context.destination,
      ended: () => { this.stop(); this.position = this.start; },
    });
    this.tell();
  }

  stop() {
    this.request++;
    this.position = this.now();
    this.silence();
    this.tell();
  }

  silence() {
    this.running?.silence();
    this.running = null;
  }

  level(slot) { return slot === this.active ? this.factor(slot) : 0; }

  hear(slot) {
    this.active = slot;
    this.running?.cross();
    this.tell();
  }

  tell() { this.dispatchEvent(new Event("change")); }
}

// Round numbers in an interval, at most `most`.
export function ticks(low, high, most) {
  const rough = (high - low) / Math.max(1, most), ten = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((one) => one * ten).find((one) => one >= rough * 0.999), found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(Number((k * step).toPrecision(9)));
  return { step, found };
}
