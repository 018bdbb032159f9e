// A design that is heard while it is changed.
import { api } from "../api.js";
import { made, stylesheet } from "../dom.js";
import { Chart } from "./chart.js";
import { Controls } from "./controls.js";
import { Drawings } from "./drawings.js";
import { Saving } from "./saving.js";
import { keep, kept } from "./session.js";
import { Sound } from "./sound.js";
import { Undo } from "./undo.js";

const LEVELS_EVERY = 500, FACTS_AFTER = 200; // ms

export async function mount(panel) {
  for (const name of ["./design.css", "../shared/maps.css"]) stylesheet(new URL(name, import.meta.url));
  const about = await api("design");
  const view = made("div", { className: "design-view" });
  const left = made("div", { className: "left" }), right = made("div", { className: "right" });
  const base = made("select", { id: "design-base" });
  base.append(...about.bases.map(({ id, name }) => made("option", { value: id, textContent: name })));
  const play = made("button", { type: "button", className: "play", textContent: "Play", disabled: true }); // until there is a design
  const slots = ["A", "B"].map((name) => made("button", { type: "button", className: "slot", textContent: name, ariaPressed: String(name === "A") }));
  const copy = made("button", { type: "button", textContent: "Copy to the other", title: "Let the other design be as this one is" });
  const reset = made("button", { type: "button", textContent: "As the base" });
  const tools = made("div", { className: "tools", role: "group", ariaLabel: "Design" });
  tools.append(play, made("span", { className: "group" }, ...slots), copy, reset);
  const start = made("div", { className: "row choice" }, made("label", { htmlFor: "design-base", textContent: "Base" }), base);
  const rows = made("div", { className: "controls" });
  const level = made("p", { className: "level" }), gain = made("p", { className: "gain" });
  const scale = made("input", { id: "design-full-scale", type: "number", min: 0.1, max: 1000, step: "any", title: "of your loudspeaker, where that is known: then it is as loud as it would be" });
  const fit = made("button", { type: "button", textContent: "Fit the gain anew" });
  const torque = made("canvas", { className: "torque", role: "img", ariaLabel: "Torque of the last fifth of a second" });
  const spectrum = made("canvas", { className: "spectrum", role: "img", ariaLabel: "Spectrum of the sound pressure" });
  const remarks = made("ul", { className: "remarks", ariaLabel: "To be known" });
  const notice = made("div");
  left.append(tools, start, notice, rows);
  right.append(
    made("section", { className: "shown heard" }, made("h2", { textContent: "What is heard" }), level, made("div", { className: "tools" }, made("label", { htmlFor: "design-full-scale", textContent: "Full scale, Pa" }), scale, gain, fit), remarks),
    made("section", { className: "shown" }, made("h2", { textContent: "Torque" }), torque),
    made("section", { className: "shown" }, made("h2", { textContent: "Spectrum" }), spectrum),
  );
  const refusal = made("p", { className: "refusal", role: "status" });
  view.append(left, right);
  panel.replaceChildren(view, refusal);

  const controls = new Controls(rows), sound = new Sound(about), drawings = new Drawings(about, torque, spectrum);
  const design = { sound, controls, drawings, about };
  panel.design = design;
  const baseOf = (id) => about.bases.find((one) => one.id === id);
  let states = {}; // by slot: { base, values }
  let slot = "A", asked = 0, shown = null; // the base whose controls are shown

  design.stated = () => ({ base: shown, values: controls.changed });
  design.both = () => ({ ...states, [slot]: design.stated() });
  design.hidden = () => panel.hidden;
  const chart = new Chart(right, design);
  new Saving(right, design);

  const state = () => ({ slot, states: { ...states } });
  const undo = new Undo(notice, state, restore);

  // Show the controls of a base; false where another one was chosen meanwhile, or there is no answer.
  async function take(id) {
    base.value = id;
    let found;
    try { found = await api(`design/controls?base=${encodeURIComponent(id)}`); } catch {
      base.value = shown;
      return false;
    }
    if (base.value !== id) return false;
    shown = id;
    controls.show(found.controls);
    return true;
  }

  function changed() {
    states[slot] = design.stated();
    keep(about.session, state());
    sound.change(states[slot]);
    facts();
    chart.changed();
  }

  function facts() {
    clearTimeout(asked);
    asked = setTimeout(async () => {
      const { serial } = sound;
      let found = { facts: {}, remarks: [] }, why = "";
      try { found = await api("design/facts", states[slot], () => {}); } catch (error) { why = error.message; }
      if (serial !== sound.serial) return; // of numbers that are no longer shown
      judge(serial, why);
      controls.told(found.facts);
      remarks.replaceChildren(...found.remarks.map((textContent) => made("li", { textContent })));
    }, FACTS_AFTER);
  }

  // Whether the newest change can be. Where it cannot, all that is heard and shown is marked.
  function judge(serial, why = "") {
    if (serial !== sound.serial || (!why && serial === sound.refusedSerial)) return;
    view.classList.toggle("refused", Boolean(why));
    const words = why && `What is heard and shown is not of these numbers: ${why}`;
    if (refusal.textContent !== words) refusal.textContent = words;
  }

  async function choose(name) {
    if (name !== slot) await restore({ slot: name, states: { ...states, [name]: states[name] ?? states[slot] } });
  }

  async function restore(before) {
    ({ slot, states } = before);
    for (const one of slots) one.setAttribute("aria-pressed", one.textContent === slot);
    await put(states[slot]);
  }

  async function put({ base: id, values }) {
    if ((id !== shown || id !== base.value) && !await take(id)) return;
    controls.put(values);
    changed();
  }

  // Another base keeps the condition, and drops what was changed of the one before.
  async function rebase() {
    const before = state(), { condition } = controls, left = baseOf(shown), dropped = controls.words(({ condition: stays }) => !stays);
    if (!await take(base.value)) return;
    controls.put(condition);
    changed();
    const { name, heard } = baseOf(shown), texts = [];
    if (dropped) texts.push(`Dropped with ${left.name}: ${dropped}.`);
    if (heard && controls.words((one) => one.condition)) texts.push(`Motion and condition stay; ${name} was saved at others, which “As the base” takes.`);
    if (texts.length) undo.offer(texts.join(" "), before);
  }
  design.put = put;
  design.choose = choose;

  controls.addEventListener("change", changed);
  base.addEventListener("change", rebase);
  for (const one of slots) one.addEventListener("click", () => choose(one.textContent));
  copy.addEventListener("click", () => {
    const before = state(), other = slot === "A" ? "B" : "A";
    states[other] = states[slot];
    keep(about.session, state());
    undo.offer(`${other} is as ${slot} is.`, before);
  });
  reset.addEventListener("click", () => {
    const before = state(), dropped = controls.words();
    controls.put({});
    changed();
    if (dropped) undo.offer(`Dropped: ${dropped}.`, before);
  });
  fit.addEventListener("click", () => sound.fit());
  scale.addEventListener("change", () => {
    const asked = Number(scale.value);
    if (asked >= 0.1 && asked <= 1000) sound.fit(asked);
    else scale.value = sound.fullScale;
  });
  play.addEventListener("click", () => {
    if (sound.playing) {
      sound.stop();
    } else {
      sound.start();
      level.textContent = "Begins; the very first time that takes a while.";
    }
  });
  sound.addEventListener("change", () => {
    if (!sound.playing) {
      design.speed = undefined;
      level.textContent = "Not playing.";
    }
    play.textContent = sound.playing ? "Stop sound" : "Play";
    scale.value = sound.fullScale;
    gain.textContent = `Full scale = ${sound.fullScale} Pa (${(20 * Math.log10(sound.fullScale / 2e-5)).toFixed(0)} dB peak re 20 µPa)`;
  });
  sound.addEventListener("refused", ({ detail }) => judge(detail.serial, detail.reason));
  sound.addEventListener("heard", () => judge(sound.heardSerial));
  sound.addEventListener("block", ({ detail }) => {
    drawings.take(detail);
    design.speed = detail.speed;
  });
  sound.dispatchEvent(new Event("change"));

  drawings.addEventListener("drawn", () => chart.point());
  setInterval(async () => {
    if (!sound.playing || panel.hidden) return;
    const found = await api(`design/levels?run=${sound.run}`).catch(() => null);
    if (found && sound.playing) level.textContent = words(found, sound.fullScale);
  }, LEVELS_EVERY);
  document.addEventListener("view-shown", ({ detail }) => {
    if (detail === "design") chart.changed();
    else sound.stop();
  });

  level.textContent = "Not playing.";
  await restore(kept(about.session) ?? { slot, states: { [slot]: { base: about.bases[0].id, values: {} } } });
  play.disabled = false;
  design.ready = true;
  return design;
}

// Level in the air, and whether it is heard at the gain it is played at.
function words({ level_dba: level, l_afmax_dba: most }, fullScale) {
  if (level === null) return "Level: of the first second, soon.";
  const played = most - 20 * Math.log10(fullScale / 2e-5), quiet = played < -48;
  const inaudible = level < 0 ? "; below 0 dB(A), which nobody hears" : quiet ? "; nearly inaudible at this gain" : "";
  return `${level.toFixed(1)} dB(A), L_AFmax ${most.toFixed(1)} dB(A) re 20 µPa in the last second${inaudible}`;
}
