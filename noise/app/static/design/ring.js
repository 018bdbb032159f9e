// Audio worklet that plays blocks of pressure at one gain from a small buffer.
const FIRST = 0.12; // delay before playing, when the load is highest [s]
const LOW = 0.006, AIM = 0.014, HIGH = 0.02; // buffer on arrival of a block: bounds and target of the schedule [s]
const CALM = 2; // time above the bound before the schedule is delayed [s]
const PATIENCE = 0.25; // minimum time between requests [s]
const FULL = 0.5; // buffer of a suspended page [s]
const RAMP = 240; // samples of a gain change

class Ring extends AudioWorkletProcessor {
  constructor({ processorOptions: { block } }) {
    super();
    this.block = block;
    this.blocks = [];
    this.at = 0; // position in the first block
    this.gain = 0;
    this.aim = 0;
    this.begins = Infinity; // start of playback
    this.playing = false;
    this.stopped = false;
    this.serial = -1;
    this.least = Infinity; // smallest buffer since the last check
    this.calm = 0; // time of the next check
    this.asked = 0;
    this.port.onmessage = ({ data }) => this.told(data);
  }

  told(data) {
    if (data.feed) {
      this.feed = data.feed;
      this.feed.onmessage = ({ data: block }) => this.take(block);
    }
    if (data.aim !== undefined) this.aim = data.aim;
    if (data.stop) this.stopped = true;
  }

  get reserve() { return (this.blocks.length * this.block - this.at) / sampleRate; }

  take(block) {
    const reserve = this.reserve;
    this.blocks.push(block);
    this.aim = block.gain;
    if (this.playing) this.look(reserve);
    else if (this.begins === Infinity) this.begins = currentTime + FIRST;
  }

  // Request a shift of the schedule if the buffer is too small, or too large for long.
  look(reserve) {
    this.least = Math.min(this.least, reserve);
    if (currentTime < this.asked + PATIENCE && reserve < FULL) return;
    if (reserve < LOW || reserve > FULL) this.ask(AIM - reserve);
    else if (currentTime > this.calm) {
      if (this.least > HIGH) this.ask(AIM - this.least);
      this.afresh();
    }
  }

  ask(sooner) {
    this.asked = currentTime;
    this.feed.postMessage(sooner);
    this.afresh();
  }

  afresh() {
    this.least = Infinity;
    this.calm = currentTime + CALM;
  }

  process(_, [[output]]) {
    let first = 0;
    if (!this.playing && currentTime >= this.begins) {
      this.playing = true;
      this.gain = this.aim;
      this.afresh();
    }
    while (this.playing && first < output.length) {
      const block = this.blocks[0];
      if (!block) break; // the block is late
      if (this.at === 0 && block.serial !== this.serial) {
        this.serial = block.serial;
        this.port.postMessage(block.serial);
      }
      const n = Math.min(output.length - first, block.pressure.length - this.at);
      for (let i = 0; i < n; i++) {
        this.gain += Math.max(-block.gain / RAMP, Math.min(block.gain / RAMP, this.aim - this.gain));
        output[first + i] = this.gain * block.pressure[this.at + i];
      }
      first += n;
      this.at += n;
      if (this.at === block.pressure.length) {
        this.at = 0;
        this.blocks.shift();
      }
    }
    return !this.stopped;
  }
}

registerProcessor("ring", Ring);
