// Voting: two synchronous sounds without names; each vote is saved before the next comparison.
import { api, told } from "../api.js";
import { made } from "../dom.js";
import { listen } from "../labels/keys.js";
import { wav } from "../labels/sounds.js";
import { Player } from "../shared/player.js";

const { RATE } = Player;
const VOTES = { 1: "first", 2: "second", 0: "equal" };
const KEYS = "Keys: A, B to hear A, B; X the other one; Space to play and pause; L loop; 1, 2 to choose A, B; 0 no difference.";

// Slots hold samples at their gain; the shorter sound is silent at its end.
class PairPlayer extends Player {
  load() {
    const { a, b } = this.slots, length = Math.max(a.length, b.length);
    return Object.fromEntries(Object.entries({ a, b }).map(([slot, samples]) => {
      const buffer = this.context.createBuffer(1, length, RATE);
      buffer.copyToChannel(samples, 0);
      return [slot, buffer];
    }));
  }

  factor() { return 1; }
}

export class Voting {
  constructor(element, goes) {
    this.goes = goes;
    this.player = new PairPlayer();
    this.kept = new Map(); // sounds of this comparison and the next
    this.ready = false;
    this.shown = 0; // number of the newest comparison; earlier answers are outdated
    this.#build(element);
    this.#playing();
    this.player.addEventListener("change", () => this.#playing());
    listen(element, {
      a: () => this.hear("a"), b: () => this.hear("b"), x: () => this.hear(this.player.active === "a" ? "b" : "a"),
      " ": () => this.toggle(), l: () => this.loop(),
      ...Object.fromEntries(Object.entries(VOTES).map(([key, vote]) => [key, ({ repeat }) => repeat || this.vote(vote)])),
    });
  }

  #build(element) {
    const button = (textContent, action, className = "") => {
      const one = made("button", { type: "button", textContent, className });
      // Keep the keyboard focus after a mouse click.
      one.addEventListener("click", ({ detail }) => { if (detail) this.stage.focus(); action(); });
      return one;
    };
    this.stage = made("h2", { tabIndex: -1 });
    this.count = made("p", { className: "count" });
    this.progress = made("progress", { ariaLabel: "Comparisons voted" });
    this.a = button("A", () => this.hear("a"), "side");
    this.b = button("B", () => this.hear("b"), "side");
    this.play = button("Play", () => this.toggle(), "play");
    this.looped = button("Loop", () => this.loop());
    this.votes = [["A", 1], ["No difference", 0], ["B", 2]].map(([text, key]) => button(`${text} (${key})`, () => this.vote(VOTES[key])));
    this.saved = made("p", { className: "saved", role: "status" });
    this.gain = made("p", { className: "soft" });
    element.append(this.stage, made("div", { className: "line" }, this.count, this.progress),
      made("div", { className: "sides" }, this.a, this.b),
      made("div", { className: "line" }, this.play, this.looped),
      made("div", { className: "votes" }, ...this.votes), this.saved,
      made("div", { className: "line" }, button("Stop here", () => this.leave("setup")), button("Result, with names", () => this.leave("result"))),
      this.gain, made("p", { className: "soft", textContent: KEYS }));
  }

  get voted() { return this.state ? this.state.waiting ?? this.state.total : 0; }

  async open(number) {
    Object.assign(this, { number, ready: false, state: null });
    const shown = ++this.shown;
    this.kept.clear();
    this.#playing();
    this.saved.textContent = "";
    told(""); // an earlier error may contain a name
    const state = await api(`juries/${number}`);
    if (shown !== this.shown) return;
    this.gain.textContent = `Played at ${state.gain}.`;
    await this.#show(state);
    this.stage.focus();
  }

  async #show(state) {
    const shown = ++this.shown, place = state.waiting;
    this.player.stop();
    Object.assign(this, { state, heard: new Set(), ready: false });
    this.stage.textContent = state.question;
    this.progress.max = state.total;
    this.progress.value = this.voted;
    this.count.textContent = place === null ? `all ${state.total} voted` : `${place + 1} of ${state.total}`;
    this.player.active = "a";
    this.player.position = 0;
    this.#playing();
    if (place === null) return;
    const [a, b] = await this.#sounds(place);
    if (shown !== this.shown) return;
    Object.assign(this.player, { slots: { a, b }, position: 0 });
    this.ready = true;
    this.began = performance.now();
    this.#playing();
    if (place + 1 < state.total) this.#sounds(place + 1).catch(() => {});
  }

  #sounds(place) {
    if (!this.kept.has(place)) this.kept.set(place, Promise.all(["a", "b"].map((side) => wav(`juries/${this.number}/heard/${place}/${side}`))));
    for (const other of this.kept.keys()) if (Math.abs(other - place) > 1) this.kept.delete(other);
    const both = this.kept.get(place);
    both.catch(() => this.kept.delete(place));
    return both;
  }

  hear(side) {
    if (!this.ready) return;
    if (this.player.playing) this.player.hear(side);
    else {
      this.player.active = side;
      this.#start();
    }
  }

  toggle() {
    if (!this.ready) return;
    if (this.player.playing) this.player.stop();
    else this.#start();
  }

  loop() {
    this.player.looping = !this.player.looping;
    if (this.player.playing) this.#start();
    this.#playing();
  }

  #start() {
    const { player } = this;
    return player.play(player.playing ? undefined : player.position);
  }

  #playing() {
    const { player } = this;
    if (player.playing) this.heard?.add(player.active);
    this.play.textContent = player.playing ? "Pause" : "Play";
    this.looped.setAttribute("aria-pressed", player.looping);
    for (const side of ["a", "b"]) {
      this[side].setAttribute("aria-pressed", player.playing && player.active === side);
      this[side].classList.toggle("heard", this.heard?.has(side) ?? false);
      this[side].disabled = !this.ready;
    }
    const may = this.ready && this.heard.size === 2;
    for (const vote of this.votes) vote.disabled = !may;
  }

  async vote(vote) {
    if (!this.ready) return;
    if (this.heard.size < 2) {
      this.saved.textContent = "Listen to both first.";
      return;
    }
    if (this.busy) return;
    this.busy = true;
    const { number, shown } = this, seconds = (performance.now() - this.began) / 1000;
    let text = `saved ${new Date().toTimeString().slice(0, 8)}`;
    const state = await api(`juries/${number}/vote`, { place: this.state.waiting, vote, seconds }).catch(({ message }) => {
      text = `not saved: ${message}`;
      return api(`juries/${number}`).catch(() => null);
    });
    this.busy = false;
    if (shown !== this.shown) return;
    this.saved.textContent = text;
    if (state) await this.#show(state);
  }

  leave(where) {
    this.player.stop();
    return this.goes[where](this.number);
  }
}
