// Design view: live sound of a design during changes.
import { api } from "../api.js";
import { made, stylesheet } from "../dom.js";
import { Chart } from "./chart.js";
import { Controls } from "./controls.js";
import { Drawings } from "./drawings.js";
import { listen } from "../labels/keys.js";
import { Sound } from "./sound.js";

const LEVELS_EVERY = 500, FACTS_AFTER = 200; // ms

export async function mount(panel) {
  for (const name of ["./design.css", "../shared/maps.css"]) stylesheet(new URL(name, import.meta.url));
  panel.replaceChildren(made("p", { className: "empty", textContent: "Loading the design view ..." }));
  const about = await api("design");
  const view = made("div", { className: "design-view" });
  const left = made("div", { className: "left" }), right = made("div", { className: "right" });
  const base = made("select", { id: "design-base", onchange: () => rebase() }, ...about.bases.map(({ id, name }) => made("option", { value: id, textContent: name })));
  const play = made("button", { type: "button", className: "play", textContent: "Play", disabled: true, onclick: () => toggle() }); // until a design is loaded
  const slots = ["A", "B"].map((name) => made("button", { type: "button", className: "slot", textContent: name, ariaPressed: String(name === "A"), onclick: () => choose(name) }));
  const copy = made("button", { type: "button", onclick: () => copied() });
  const reset = made("button", { type: "button", textContent: "Reset to base", onclick: () => toBase() });
  const tools = made("div", { className: "tools", role: "group", ariaLabel: "Play and compare" });
  tools.append(play, made("span", { className: "group" }, ...slots), copy, reset);
  const start = made("div", { className: "row choice" }, made("label", { htmlFor: "design-base", textContent: "Base" }), base);
  const rows = made("div", { className: "controls" });
  const name = made("p", { className: "name" }), level = made("p", { className: "level" }), gain = made("span", { className: "gain" });
  const scale = made("input", { id: "design-full-scale", type: "number", min: 0.1, max: 1000, step: "any", title: "Sound pressure of full scale. Set that of your loudspeaker to hear the true level." });
  const fit = made("button", { type: "button", textContent: "Reset playback level", onclick: () => sound.fit() });
  const torque = made("canvas", { className: "torque", role: "img", ariaLabel: "Torque of the last fifth of a second" });
  const spectrum = made("canvas", { className: "spectrum", role: "img", ariaLabel: "Spectrum of the sound pressure" });
  const remarks = made("ul", { className: "remarks", ariaLabel: "Remarks" });
  const notice = made("p", { role: "status" });
  const refusal = made("p", { className: "refusal", role: "status" });
  left.append(start, notice, rows);
  right.append(tools, refusal, made("section", { className: "shown heard", ariaLabel: "What is heard" }, name, level, remarks),
    made("section", { className: "shown" }, made("h2", { textContent: "Spectrum" }), spectrum));
  view.append(left, right);

  const controls = new Controls(rows), sound = new Sound(about), drawings = new Drawings(about, sound, torque, spectrum);
  const design = { sound, controls, drawings, about };
  panel.design = design;
  const states = {}; // by slot: { base, values }
  let slot = "A", asked = 0, shown = null; // the base whose controls are shown
  let heardAt = 0; // when the newest design was first heard [ms]

  design.stated = () => ({ base: shown, values: controls.changed });
  design.hidden = () => panel.hidden;
  const chart = new Chart(right, design);
  right.append(
    made("section", { className: "shown" }, made("h2", { textContent: "Torque" }), torque),
    made("section", {}, made("h2", { textContent: "Playback level" }), made("div", { className: "tools" }, made("label", { htmlFor: "design-full-scale", textContent: "Full scale, Pa" }), scale, gain, fit)));
  right.append(saving(design));

  // Show the controls of a base; false if another one was chosen meanwhile, or the request failed.
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

  function other() { return slot === "A" ? "B" : "A"; }

  function changed() {
    copy.textContent = `Copy ${slot} to ${other()}`;
    reset.disabled = !Object.keys(controls.changed).length;
    reset.title = reset.disabled ? "Nothing differs from the base" : "Drop all changes of this design";
    states[slot] = design.stated();
    sound.change(states[slot]);
    view.classList.toggle("updating", sound.playing);
    facts();
    chart.changed();
  }

  function facts() {
    clearTimeout(asked);
    asked = setTimeout(async () => {
      const { serial } = sound;
      let found = { facts: {}, remarks: [] }, why = "";
      try { found = await api("design/facts", states[slot], () => {}); } catch (error) { why = error.message; }
      if (serial !== sound.serial) return; // outdated
      judge(serial, why);
      controls.told(found.facts);
      remarks.replaceChildren(...found.remarks.map((textContent) => made("li", { textContent })));
    }, FACTS_AFTER);
  }

  // Mark the results as those of the previous design if the newest change is invalid.
  function judge(serial, why = "") {
    if (serial !== sound.serial || (!why && serial === sound.refusedSerial)) return;
    view.classList.toggle("refused", Boolean(why));
    const words = why && `These values are not possible; you still hear the previous design. ${why}`;
    if (refusal.textContent !== words) refusal.textContent = words;
  }

  async function choose(name) {
    if (name === slot && states[name]) return;
    states[name] ??= states[slot];
    slot = name;
    for (const one of slots) one.setAttribute("aria-pressed", one.textContent === slot);
    await put(states[slot]);
  }

  async function put({ base: id, values }) {
    if ((id !== shown || id !== base.value) && !await take(id)) return;
    controls.put(values);
    changed();
  }

  // Choose another base: condition and factors stay.
  async function rebase() {
    const values = Object.fromEntries(controls.values);
    if (!await take(base.value)) return;
    controls.put(values);
    changed();
  }
  design.put = put;
  design.choose = choose;

  controls.addEventListener("change", changed);
  function copied() {
    states[other()] = states[slot];
    notice.textContent = `${other()} is now a copy of ${slot}.`;
  }
  function toBase() {
    controls.put({});
    changed();
  }
  scale.addEventListener("change", () => {
    const asked = Number(scale.value);
    if (asked >= 0.1 && asked <= 1000) sound.fit(asked);
    else scale.value = sound.fullScale;
  });
  const toggle = () => {
    if (sound.playing) return sound.stop();
    sound.start();
    name.textContent = "Starting ...";
    level.textContent = "The first start takes some seconds.";
  };
  listen(view, { " ": () => { if (!play.disabled) toggle(); }, a: () => choose("A"), b: () => choose("B") });
  sound.addEventListener("change", () => {
    if (!sound.playing) {
      design.speed = undefined;
      silent();
    }
    play.textContent = sound.playing ? "Stop sound" : "Play";
    scale.value = sound.fullScale;
    gain.textContent = `Full scale = ${sound.fullScale} Pa (${(20 * Math.log10(sound.fullScale / 2e-5)).toFixed(0)} dB peak re 20 µPa)`;
  });
  sound.addEventListener("refused", ({ detail }) => judge(detail.serial, detail.reason));
  sound.addEventListener("heard", () => {
    heardAt = performance.now();
    judge(sound.heardSerial);
  });
  sound.addEventListener("block", ({ detail }) => {
    drawings.take(detail);
    design.speed = detail.speed;
  });
  sound.dispatchEvent(new Event("change"));

  drawings.addEventListener("drawn", () => chart.point());
  setInterval(async () => {
    if (!sound.playing || panel.hidden) return;
    const found = await api(`design/levels?run=${sound.run}`).catch(() => null);
    if (!found || !sound.playing) return;
    [name.textContent, level.textContent] = words(found, sound.fullScale);
    // Name and level are of a second of sound, which may have begun before the newest design.
    const ofIt = sound.heardSerial === sound.serial && found.name_age_s !== undefined && performance.now() - heardAt > 1000 * (1 + found.name_age_s);
    if (ofIt) view.classList.remove("updating");
  }, LEVELS_EVERY);
  document.addEventListener("view-shown", ({ detail }) => {
    if (detail === "design") chart.changed();
    else sound.stop();
  });

  function silent() {
    view.classList.remove("updating");
    name.textContent = "Not playing";
    level.textContent = "Press Play or Space to hear the design and to see its name and level. A and B switch between two designs.";
  }
  silent();
  new ResizeObserver(() => drawings.draw()).observe(right);
  await put({ base: about.bases[0].id, values: {} });
  panel.replaceChildren(view); // only when it is complete
  play.disabled = false;
  design.ready = true;
  return design;
}

// Name of the sound, "squawk, 255 Hz, 72 dB(A)", and its levels.
function words({ label, frequency_hz: frequency, level_dba: level, l_afmax_dba: most }, fullScale) {
  if (level === null) return ["Listening ...", "The name and the level are those of the last second."];
  const called = { none: "none: no creak, squawk or squeal", unknown: "unknown noise", undefined: "naming ..." }[label] ?? label;
  const tone = label === "none" || !frequency ? [] : [`${frequency.toFixed(0)} Hz`];
  const played = most - 20 * Math.log10(fullScale / 2e-5), quiet = played < -48;
  const inaudible = level < 0 ? "; inaudible, as it is below 0 dB(A)" : quiet ? "; nearly inaudible at this playback level" : "";
  return [[called, ...tone, `${level.toFixed(0)} dB(A)`].join(", "), `Last second: ${level.toFixed(1)} dB(A), Fast maximum ${most.toFixed(1)} dB(A), re 20 µPa${inaudible}`];
}

// Section that saves the design as a rig file; a second click replaces an existing file.
function saving(design) {
  let again = null;
  const field = made("input", { id: "design-name", type: "text", value: "design", spellcheck: false, autocomplete: "off", oninput: () => { again = null; } });
  const text = made("p", { className: "saved", role: "status" });
  const save = async () => {
    const name = field.value.trim();
    try {
      const { file, command } = await api("design/rig", { ...design.stated(), name, replace: again === name }, () => {});
      again = null;
      text.textContent = `Saved as ${file}. To simulate it: ${command}`;
    } catch ({ message }) {
      text.textContent = message;
      again = /is there already/.test(message) ? name : null;
    }
  };
  const button = made("button", { type: "button", textContent: "Save rig file", onclick: save });
  return made("section", { className: "saving" }, made("h2", { textContent: "Save" }),
    made("div", { className: "tools" }, made("label", { htmlFor: "design-name", textContent: "Name" }), field, button), text);
}
