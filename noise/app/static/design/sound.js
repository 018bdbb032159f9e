// Sound of the design: a worker reads blocks, an audio worklet plays them, an analyser computes the spectrum.
const QUIETEST = 0.1; // smallest full scale [Pa]
const BLACKMAN = 0.42; // mean of the analyser window
const LINES = 4096; // lines of the spectrum

export class Sound extends EventTarget {
  constructor({ rate, block }) {
    super();
    this.rate = rate;
    this.block = block;
    this.fullScale = QUIETEST;
    this.blocks = 0; // received blocks
    this.levels = new Float32Array(LINES); // levels of the spectrum [dB]
    this.serial = 0; // serial of the newest change
    this.refusedSerial = -1; // serial of the newest refused change
    this.design = null;
  }

  get playing() { return Boolean(this.node); }

  // Set the design, now or for the next start.
  change(design) {
    this.design = design;
    this.serial += 1;
    this.worker?.postMessage({ design: { design, serial: this.serial } });
  }

  // Tone levels of the spectrum lines [dB re 20 uPa]; empty before the first start.
  spectrum() {
    if (!this.analyser) return [];
    this.analyser.getFloatFrequencyData(this.levels);
    const full = 20 * Math.log10((this.fullScale * Math.SQRT2) / (BLACKMAN * 2e-5));
    return this.levels.map((level) => level + full);
  }

  async start() {
    if (this.node || this.starting) return;
    this.starting = true;
    try {
      this.context ??= new AudioContext({ sampleRate: this.rate, latencyHint: 0.003 });
      if (this.context.state === "suspended") this.context.resume();
      this.added ??= this.context.audioWorklet.addModule(new URL("./ring.js", import.meta.url));
      await this.added;
      this.analyser ??= new AnalyserNode(this.context, { fftSize: 2 * LINES, smoothingTimeConstant: 0.7 });
    } finally { this.starting = false; }
    this.refusedSerial = -1;
    this.run = crypto.getRandomValues(new Uint32Array(1))[0];
    this.worker = new Worker(new URL("./feed.js", import.meta.url));
    this.worker.onmessage = ({ data }) => this.#fed(data);
    this.node = new AudioWorkletNode(this.context, "ring", {
      numberOfInputs: 0, outputChannelCount: [1], processorOptions: { block: this.block },
    });
    this.node.port.onmessage = ({ data: serial }) => {
      this.heardSerial = serial;
      this.#tell("heard");
    };
    const { port1, port2 } = new MessageChannel();
    const address = new URL("api/design/", document.baseURI).href;
    this.worker.postMessage({ start: { address, run: this.run, fullScale: this.fullScale }, design: { design: this.design, serial: this.serial }, port: port1 }, [port1]);
    this.node.port.postMessage({ feed: port2 }, [port2]);
    this.node.connect(this.context.destination);
    this.node.connect(this.analyser);
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

  // Reset the full scale [Pa], which follows the loudest sound from then on.
  fit(fullScale = QUIETEST) {
    this.fullScale = fullScale;
    this.worker?.postMessage({ fullScale });
    this.#tell("change");
  }

  #fed(data) {
    if (data.refused !== undefined) this.#refuse(data.serial, data.refused);
    if (data.ended !== undefined) {
      if (data.ended) this.#refuse(this.serial, data.ended);
      this.stop();
    }
    if (data.block) {
      this.blocks += 1;
      if (data.block.fullScale !== this.fullScale) {
        this.fullScale = data.block.fullScale;
        this.#tell("change");
      }
      this.dispatchEvent(new CustomEvent("block", { detail: data.block }));
    }
  }

  #refuse(serial, reason) {
    this.refusedSerial = serial;
    this.dispatchEvent(new CustomEvent("refused", { detail: { serial, reason } }));
  }

  #tell(what) { this.dispatchEvent(new Event(what)); }
}
