// Audio worklet that plays blocks of pressure at one gain from a small buffer.
const FIRST = 0.08; // buffer when playback begins [s]; after a block that was late it is twice as long
const FULL = 0.5; // buffer of a suspended page, of which only the newest blocks are played [s]
const RAMP = 240; // samples of a gain change

class Ring extends AudioWorkletProcessor {
  constructor({ processorOptions: { block } }) {
    super();
    this.block = block;
    this.blocks = [];
    this.at = 0; // position in the first block
    this.gain = 0;
    this.aim = 0;
    this.first = FIRST;
    this.begins = Infinity; // start of playback
    this.playing = false;
    this.stopped = false;
    this.serial = -1;
    this.port.onmessage = ({ data }) => this.told(data);
  }

  told(data) {
    if (data.feed) {
      this.feed = data.feed;
      this.feed.onmessage = ({ data: block }) => this.take(block);
    }
    if (data.stop) this.stopped = true;
  }

  take(block) {
    this.blocks.push(block);
    this.aim = block.gain;
    if (this.begins === Infinity) this.begins = currentTime + this.first;
    if (this.blocks.length * this.block <= FULL * sampleRate) return;
    this.blocks.splice(0, this.blocks.length - Math.ceil((this.first * sampleRate) / this.block));
    this.at = 0;
  }

  process(_, [[output]]) {
    let first = 0;
    if (!this.playing && currentTime >= this.begins) {
      this.playing = true;
      this.gain = this.aim;
    }
    while (this.playing && first < output.length) {
      const block = this.blocks[0];
      if (!block) { // it is late
        this.playing = false;
        this.begins = Infinity;
        this.first = Math.min(2 * this.first, FULL / 2);
        break;
      }
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
