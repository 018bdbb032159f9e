// Sliders, fields and switches declared by the server.
import { made } from "../dom.js";

const TICKS = 1000;

export class Controls extends EventTarget {
  constructor(panel) {
    super();
    this.panel = panel;
    this.declared = new Map();
    this.values = new Map();
    this.shown = new Map(); // key -> { row, put }
  }

  // Show the controls of a base, with its values.
  show(declared) {
    this.declared = new Map(declared.map((one) => [one.key, one]));
    this.values = new Map(declared.map((one) => [one.key, one.value]));
    this.shown.clear();
    const groups = new Map();
    for (const one of declared) {
      if (!groups.has(one.group)) groups.set(one.group, this.#group(one.group));
      groups.get(one.group).append(this.#row(one));
    }
    this.panel.replaceChildren(...[...groups.values()].map((body) => body.parentElement));
    this.#reveal();
  }

  // Set values; all others become those of the base.
  put(values) {
    for (const one of this.declared.values()) this.#set(one.key, values[one.key] ?? one.value);
    this.#reveal();
  }

  // Values that differ from the base.
  get changed() {
    return Object.fromEntries([...this.values].filter(([key, value]) => value !== this.declared.get(key).value));
  }

  // Show resulting quantities of the bushing beside their factors.
  told(facts) {
    for (const [key, { fact }] of this.shown) if (fact) fact.textContent = facts[key.slice("change.".length)] ?? "";
  }

  #group(title) {
    const box = made("details", { open: true }), body = made("div", { className: "rows" });
    box.append(made("summary", { textContent: title }), body);
    return body;
  }

  #row(one) {
    const row = made("div", { className: `row ${one.kind}` });
    const id = `design-${one.key.replaceAll(".", "-")}`;
    const entry = { row, put: () => {} };
    if (one.kind === "number") {
      const label = made("label", { htmlFor: `${id}-slider`, textContent: one.label, title: one.meaning });
      const slider = made("input", { id: `${id}-slider`, type: "range", min: 0, max: TICKS, step: 1, oninput: () => this.#input(one, rounded(valueAt(one, slider.value / TICKS), one)) });
      const field = made("input", { id, type: "number", min: one.least, max: one.most, step: "any", ariaLabel: [one.label, one.unit].filter(Boolean).join(", ") });
      const unit = made("span", { className: "unit", textContent: one.unit });
      field.addEventListener("change", () => {
        const value = Number(field.value);
        if (field.value.trim() !== "" && value >= one.least && value <= one.most) this.#input(one, value);
        else this.#set(one.key, this.values.get(one.key));
      });
      entry.put = (value) => {
        slider.value = Math.round(TICKS * shareOf(one, value));
        slider.setAttribute("aria-valuetext", `${written(value)} ${one.unit}`);
        field.value = written(value);
      };
      row.append(label, slider, field, unit);
      if (one.key.startsWith("change.")) row.append(entry.fact = made("span", { className: "fact" }));
    } else {
      const box = made("input", { id, type: "checkbox", onchange: () => this.#input(one, box.checked) });
      entry.put = (value) => { box.checked = value; };
      row.append(made("label", { htmlFor: id, textContent: one.label, title: one.meaning }), box);
    }
    this.shown.set(one.key, entry);
    entry.put(one.value);
    return row;
  }

  #set(key, value) {
    this.values.set(key, value);
    this.shown.get(key).put(value);
  }

  #input(one, value) {
    if (value === this.values.get(one.key)) return;
    this.#set(one.key, value);
    if (one.kind !== "number") this.#reveal();
    this.dispatchEvent(new CustomEvent("change", { detail: one.key }));
  }

  // Hide controls that have no effect.
  #reveal() {
    for (const [key, { row }] of this.shown) {
      row.hidden = Boolean(this.values.get(this.declared.get(key).unless));
    }
  }
}

const valueAt = ({ low, high, log }, share) => (log ? low * (high / low) ** share : low + (high - low) * share);

const shareOf = ({ low, high, log }, value) => {
  const share = log ? Math.log(Math.max(value, low) / low) / Math.log(high / low) : (value - low) / (high - low);
  return Math.min(1, Math.max(0, share || 0));
};

// Number with all digits of a rig file, with an exponent if it is very small or large.
const written = (value) => (value && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e7) ? Number(value.toPrecision(6)).toExponential() : String(value));

// Round to the digits of a slider step.
function rounded(value, { low, high, log }) {
  const step = log ? value * Math.log(high / low) / TICKS : (high - low) / TICKS;
  const digits = Math.ceil(-Math.log10(step));
  return Number(value.toFixed(Math.min(12, Math.max(0, digits))));
}
