// In the audio thread: plays blocks of pressure one after the other at one gain, asks for more in time, counts what is missing.
const MOST = 10; // blocks that are asked for at most, where the machine is busy
const CALM = 5; // without a gap, after which one block less will do [s]
const RAMP = 240; // samples in which a gain is another

class Ring extends AudioWorkletProcessor {
  constructor({ processorOptions: { block, ahead } }) {
    super();
    this.block = block;
    this.ahead = ahead; // blocks that are to be there, or on their way
    this.blocks = [];
    this.at = 0; // sample of the first block
    this.next = 0; // sequence that comes next
    this.asked = 0;
    this.gain = 0;
    this.aim = 0;
    this.playing = false;
    this.stopped = false;
    this.missing = 0;
    this.doubled = 0;
    this.serial = -1;
    this.least = ahead;
    this.calm = 0; // samples since the last gap
    this.port.onmessage = ({ data }) => this.told(data);
  }

  told(data) {
    if (data.feed) {
      this.feed = data.feed;
      this.feed.onmessage = ({ data: block }) => this.take(block);
      this.ask();
    }
    if (data.aim !== undefined) this.aim = data.aim;
    if (data.stop) this.stopped = true;
  }

  ask() {
    while (this.feed && !this.stopped && this.asked - this.next + this.blocks.length < this.ahead) this.feed.postMessage(this.asked++);
  }

  take(block) {
    if (block.sequence < this.next) this.doubled += block.pressure.length;
    else {
      this.missing += (block.sequence - this.next) * this.block;
      this.next = block.sequence + 1;
      this.blocks.push(block);
      this.aim = block.gain;
    }
    if (!this.playing && this.blocks.length >= this.ahead) {
      this.playing = true;
      this.gain = this.aim;
    }
    this.ask();
  }

  process(_, [[output]]) {
    let first = 0;
    while (this.playing && first < output.length) {
      const block = this.blocks[0];
      if (!block) {
        this.missing += output.length - first;
        if (this.calm > 0) this.ahead = Math.min(MOST, this.ahead + 1);
        this.calm = 0;
        this.ask();
        this.port.postMessage({ missing: this.missing, doubled: this.doubled, frame: currentFrame + first });
        break;
      }
      if (this.at === 0 && block.serial !== this.serial) {
        this.serial = block.serial;
        this.port.postMessage({ serial: block.serial, time: (currentFrame + first) / sampleRate, missing: this.missing, doubled: this.doubled });
      }
      const n = Math.min(output.length - first, block.pressure.length - this.at);
      for (let i = 0; i < n; i++) {
        this.gain += Math.max(-block.gain / RAMP, Math.min(block.gain / RAMP, this.aim - this.gain));
        output[first + i] = this.gain * block.pressure[this.at + i];
      }
      first += n;
      this.at += n;
      this.calm += n;
      if (this.calm > CALM * sampleRate) {
        this.ahead = Math.max(this.least, this.ahead - 1);
        this.calm = 1;
      }
      if (this.at === block.pressure.length) {
        this.at = 0;
        this.blocks.shift();
        this.ask();
      }
    }
    return !this.stopped;
  }
}

registerProcessor("ring", Ring);
