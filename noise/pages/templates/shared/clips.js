// Player of the sounds of a page.
const about = JSON.parse(document.getElementById("about").textContent);

class ClipPlayer extends Player {
  failure = "";
  #decoded = new Map();

  static KEPT = 40; // decoded sounds

  get key() { return this.slots[this.active]; }

  decode(key) {
    const found = this.#decoded.get(key) ?? this.open().decodeAudioData(
      Uint8Array.from(atob(document.getElementById("sound-" + key).textContent), (one) => one.charCodeAt(0)).buffer);
    this.#decoded.delete(key); // least recently used first
    this.#decoded.set(key, found);
    for (const old of this.#decoded.keys()) {
      if (this.#decoded.size <= ClipPlayer.KEPT) break;
      if (!Object.values(this.slots).includes(old)) this.#decoded.delete(old);
    }
    return found;
  }

  // Pad both to the same length, so that loops stay in step.
  async load() {
    try {
      const found = await Promise.all(Object.entries(this.slots).filter(([, key]) => key !== null).map(async ([slot, key]) => [slot, await this.decode(key)]));
      const frames = Math.max(0, ...found.map(([, buffer]) => buffer.length));
      return frames ? Object.fromEntries(found.map(([slot, buffer]) => [slot, this.#padded(buffer, frames)])) : null;
    } catch {
      this.failure = "This browser cannot decode the sound (FLAC).";
      this.tell();
      return null;
    }
  }

  #padded(buffer, frames) {
    if (buffer.length === frames) return buffer;
    const longer = this.context.createBuffer(buffer.numberOfChannels, frames, buffer.sampleRate);
    for (let i = 0; i < buffer.numberOfChannels; i++) longer.copyToChannel(buffer.getChannelData(i), i);
    return longer;
  }

  get length() { return Math.max(0, ...Object.values(this.slots).filter((key) => key !== null).map((key) => about[key].duration)); }

  factor() { return 1; } // the gain is in the samples

  put(slot, key) {
    this.slots[slot] = key;
    if (this.playing) this.play();
    else { this.decode(key).catch(() => {}); this.position = Math.min(this.position, this.length); }
    this.tell();
  }

  seek(seconds) {
    this.position = Math.min(Math.max(0, seconds), Math.max(0, this.length - 0.01));
    if (this.playing) this.play(this.position);
    this.tell();
  }

  begin(key, from = 0) {
    this.slots[this.active] = key;
    this.position = from;
    this.tell();
    return this.play(from);
  }

  toggle() { if (this.playing) this.stop(); else this.play(this.position); }

  loop() {
    this.position = this.now();
    this.looping = !this.looping;
    if (this.playing) this.play(this.position);
    this.tell();
  }
}

const engine = new ClipPlayer();
