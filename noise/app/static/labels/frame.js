// Elements of the page of a recording.
import { helpDialog } from "./keys.js";
import { made } from "../dom.js";

export const LABELS = ["creak", "squawk", "squeal", "none", "unknown"];

const button = (textContent, title, more = {}) => made("button", { type: "button", textContent, title, ...more });

const toggle = (textContent, title, pressed = false) => button(textContent, title, { ariaPressed: String(pressed) });

const canvas = (className, ariaLabel) => made("canvas", { className, ...(ariaLabel ? { role: "img", ariaLabel } : { ariaHidden: "true" }) });

const group = (ariaLabel, ...children) => made("div", { className: "group", role: "group", ariaLabel }, ...children);

export function build(element) {
  const box = made("select");
  const parts = {
    title: made("h2"), facts: made("p", { className: "facts" }), saved: made("p", { className: "saved", role: "status" }),
    play: button("Play", "Space", { className: "play" }), loop: toggle("Loop", "L", true), clock: made("output", { className: "clock" }),
    a: toggle("A", "X changes over", true), b: toggle("B", "X changes over"), keep: button("Keep as B", "B"),
    out: button("−", "zoom out", { ariaLabel: "Zoom out" }), in: button("+", "zoom in", { ariaLabel: "Zoom in" }),
    left: button("‹", "earlier", { ariaLabel: "Earlier" }), right: button("›", "later", { ariaLabel: "Later" }),
    whole: button("All", "0"), fit: button("Segment", "F", { ariaLabel: "Zoom to the segment" }), harmonic: toggle("Harmonics", "H"),
    help: button("?", "keys", { ariaLabel: "Help: keys" }), channel: { box, label: made("label", {}, "Channel ", box) }, others: group("Channels"),
    gains: made("p", { className: "gains" }), readout: made("output", { className: "readout" }), levelRead: made("output", { className: "readout level" }),
    strip: made("div", { className: "strip", role: "group", ariaLabel: "Segments" }), overlay: made("div", { className: "overlay" }), position: made("div", { className: "position" }), selection: made("div", { className: "selection" }),
    wave: canvas("wave", "Samples over time"), waveAxis: canvas("axis wave"),
    plot: canvas("plot"), marks: canvas("marks"), frequencies: canvas("axis frequencies"), legend: canvas("legend", "Colours of levels"),
    course: canvas("course", "A-weighted level over time, Fast"), courseAxis: canvas("axis course"), times: canvas("times"),
    chosen: made("div", { className: "chosen" }), labels: group("Label of the segment"), shares: made("dl", { className: "shares" }), source: made("p"), conditions: made("p", { className: "conditions" }),
    split: button("Split", "S: at the cursor, or where it is played"), join: button("Join", "Delete: to the segment before it"), undo: button("Undo", "Ctrl+Z"), redo: button("Redo", "Ctrl+Shift+Z"), agree: button("Confirm all", "C: all labels of this recording are right"),
    stack: made("div", { className: "stack" }), stackAxes: made("div", { className: "stack" }),
    levels: made("p", { className: "facts levels" }), dialog: helpDialog(),
  };
  for (const [at, label] of LABELS.entries()) {
    const one = made("button", { type: "button", className: `label ${label}`, title: `Key ${at + 1}`, data: { label } }, made("i"), label);
    parts.labels.append(one);
  }
  parts.screen = made("div", { className: "screen", tabIndex: 0, role: "application", ariaRoleDescription: "spectrogram", ariaLabel: "Spectrogram: arrow keys move the cursor" }, parts.plot, parts.marks);
  parts.overlay.append(parts.selection, parts.position);
  parts.area = made("div", { className: "area" }, parts.strip, parts.wave, parts.screen, parts.course, parts.stack, parts.times, parts.overlay);
  const axes = made("div", { className: "axes" }, made("span", { className: "strip" }), parts.waveAxis, parts.frequencies, parts.courseAxis, parts.stackAxes, made("span", { className: "times", textContent: "s" }));
  parts.lanes = made("div", { className: "lanes" }, axes, parts.area);
  element.replaceChildren(
    made("header", { className: "about" }, parts.title, parts.saved, parts.facts),
    made("div", { className: "tools" },
      group("Playing", parts.play, parts.loop, parts.clock),
      group("Comparing", parts.a, parts.b, parts.keep),
      group("View", parts.out, parts.in, parts.left, parts.right, parts.whole, parts.fit, parts.harmonic),
      group("Correcting", parts.split, parts.join, parts.undo, parts.redo, parts.agree, parts.help)),
    parts.lanes,
    made("div", { className: "labelling" }, parts.labels, made("p", { className: "shortcuts", textContent: "Drag: select · 1–5: label · C: confirm all · Ctrl+Z: undo · Space: play · ?: keys" })),
    made("div", { className: "under" }, parts.readout, parts.levelRead, parts.legend),
    made("section", { className: "below", ariaLabel: "Segment" }, parts.chosen, parts.levels, parts.source, parts.conditions, parts.shares),
    parts.gains,
    made("div", { className: "tools" }, parts.channel.label, parts.others),
    parts.dialog);
  return parts;
}
