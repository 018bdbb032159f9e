// Two sounds in step, A and B, each through a gain of its own: to change over is to cross the gains.
const CROSSING = 0.02, AHEAD = 0.03; // s

export class Voices {
  // Buffers by slot, of one length; `level` gives by what a slot is multiplied, `ended` is called at the end.
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

  // Where they are, of their length [s].
  get position() {
    const played = this.offset + Math.max(0, this.context.currentTime - this.began);
    return this.loop ? played % this.length : Math.min(played, this.length);
  }

  get gains() { return Object.fromEntries(Object.entries(this.voices).map(([slot, { gain }]) => [slot, gain.gain.value])); }

  cross() { for (const slot of Object.keys(this.voices)) this.#ramp(slot, this.level(slot), 0); }

  // They end as what is begun now comes in.
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
