// In the audio thread: plays blocks of pressure one after the other at one gain, and keeps a small reserve.
const FIRST = 0.12; // to be in reserve before it begins, when there is most to do besides [s]
const LOW = 0.006, AIM = 0.014, HIGH = 0.02; // reserve as a block comes, below and above which blocks are to come sooner and later [s]
const CALM = 2; // without less in reserve, before blocks are to come later [s]
const PATIENCE = 0.25; // until what was asked for shows [s]
const FULL = 0.5; // in reserve, where nobody listens [s]
const RAMP = 240; // samples in which a gain is another

class Ring extends AudioWorkletProcessor {
  constructor({ processorOptions: { block } }) {
    super();
    this.block = block;
    this.blocks = [];
    this.at = 0; // sample of the first block
    this.gain = 0;
    this.aim = 0;
    this.begins = Infinity; // time at which it plays
    this.playing = false;
    this.stopped = false;
    this.serial = -1;
    this.least = Infinity; // in reserve, since the pace was looked at
    this.calm = 0; // times at which the pace is looked at anew
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

  // Ask for another pace where there is too little in reserve, or for long too much.
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
      if (!block) break; // it has not come in time
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
