// The sound of the design: a worker reads its blocks, the audio thread plays them; what is missing and how late it is are counted.
const QUIETEST = 0.1; // nothing is amplified beyond this full scale [Pa]
const LATENCIES = 5000; // that are kept

export class Sound extends EventTarget {
  constructor({ rate, block, lookahead_s: lookahead }) {
    super();
    this.rate = rate;
    this.block = block;
    this.lookahead = 1000 * lookahead; // by which the sound of a block lags behind its motion [ms]
    this.fullScale = QUIETEST;
    this.missing = 0; // samples that were not there in time
    this.doubled = 0;
    this.latencies = []; // from a change to when it is heard [ms]
    this.costs = []; // of blocks, at the server [ms]
    this.waiting = []; // changes that are not heard yet
    this.serial = 0; // of the newest change
    this.refusedSerial = -1; // of the newest that could not be
    this.design = null;
  }

  get playing() { return Boolean(this.node); }

  // Let a design be heard, from now on or when it is played.
  change(design) {
    this.design = design;
    this.serial += 1;
    if (!this.node) return;
    this.waiting.push({ serial: this.serial, at: performance.now() });
    this.worker.postMessage({ design: { design, serial: this.serial } });
  }

  async start() {
    if (this.node || this.starting) return;
    this.starting = true;
    try {
      this.context ??= new AudioContext({ sampleRate: this.rate, latencyHint: 0.003 });
      if (this.context.state === "suspended") this.context.resume();
      this.added ??= this.context.audioWorklet.addModule(new URL("./ring.js", import.meta.url));
      await this.added;
    } finally { this.starting = false; }
    this.refusedSerial = -1;
    this.run = crypto.getRandomValues(new Uint32Array(1))[0];
    this.worker = new Worker(new URL("./feed.js", import.meta.url));
    this.worker.onmessage = ({ data }) => this.#fed(data);
    this.node = new AudioWorkletNode(this.context, "ring", {
      numberOfInputs: 0, outputChannelCount: [1], processorOptions: { block: this.block },
    });
    this.node.port.onmessage = ({ data }) => this.#played(data);
    const { port1, port2 } = new MessageChannel();
    this.waiting = [];
    const address = new URL("api/design/", document.baseURI).href;
    this.worker.postMessage({ start: { address, run: this.run, fullScale: this.fullScale }, design: { design: this.design, serial: this.serial }, port: port1 }, [port1]);
    this.node.port.postMessage({ feed: port2 }, [port2]);
    this.node.connect(this.context.destination);
    this.#tell("change");
  }

  stop() {
    if (!this.node) return;
    this.node.port.postMessage({ stop: true });
    this.node.disconnect();
    this.worker.terminate();
    this.node = this.worker = null;
    this.#tell("change");
  }

  // The gain follows the loudest so far; from now on it does anew, from a full scale [Pa] on.
  fit(fullScale = QUIETEST) {
    this.fullScale = fullScale;
    this.worker?.postMessage({ fullScale });
    this.#tell("change");
  }

  #fed(data) {
    if (data.refused !== undefined) {
      this.waiting = this.waiting.filter(({ serial }) => serial > data.serial);
      this.#refuse(data.serial, data.refused);
    }
    if (data.ended !== undefined) {
      if (data.ended) this.#refuse(this.serial, data.ended);
      this.stop();
    }
    if (data.block) {
      this.costs.push(data.block.took);
      if (this.costs.length > LATENCIES) this.costs.shift();
      if (data.block.fullScale !== this.fullScale) {
        this.fullScale = data.block.fullScale;
        this.#tell("change");
      }
      this.dispatchEvent(new CustomEvent("block", { detail: data.block }));
    }
  }

  #played({ serial, time, missing, doubled }) {
    this.missing = missing;
    this.doubled = doubled;
    if (serial === undefined) return;
    const { contextTime, performanceTime } = this.context.getOutputTimestamp();
    const heard = contextTime ? performanceTime + 1000 * (time - contextTime)
      : performance.now() + 1000 * (time - this.context.currentTime + (this.context.outputLatency || this.context.baseLatency));
    for (const one of this.waiting) if (one.serial <= serial) this.latencies.push(heard + this.lookahead - one.at);
    this.waiting = this.waiting.filter((one) => one.serial > serial);
    if (this.latencies.length > LATENCIES) this.latencies.splice(0, this.latencies.length - LATENCIES);
    this.heardSerial = serial;
    this.#tell("heard");
  }

  #refuse(serial, reason) {
    this.refusedSerial = serial;
    this.dispatchEvent(new CustomEvent("refused", { detail: { serial, reason } }));
  }

  #tell(what) { this.dispatchEvent(new Event(what)); }
}
