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
    out: button("−", "zoom out", { ariaLabel: "Zoom out" }), in: button("+", "zoom in", { ariaLabel: "Zoom in" }),
    whole: button("All", "0"), fit: button("Segment", "F", { ariaLabel: "Zoom to the segment" }),
    help: button("?", "keys", { ariaLabel: "Help: keys" }), channel: { box, label: made("label", {}, "Channel ", box) }, others: group("Channels"),
    gains: made("p", { className: "gains" }), readout: made("output", { className: "readout" }),
    strip: made("div", { className: "strip", role: "group", ariaLabel: "Segments" }), overlay: made("div", { className: "overlay" }), position: made("div", { className: "position" }), selection: made("div", { className: "selection" }),
    wave: canvas("wave", "Samples over time"), waveAxis: canvas("axis wave"),
    plot: canvas("plot"), marks: canvas("marks"), frequencies: canvas("axis frequencies"), legend: canvas("legend", "Colours of levels"),
    times: canvas("times"),
    chosen: made("div", { className: "chosen" }), labels: group("Label of the segment"), shares: made("dl", { className: "shares" }), source: made("p"), conditions: made("p", { className: "conditions" }),
    undo: button("Undo", "Ctrl+Z"), redo: button("Redo", "Ctrl+Shift+Z"), agree: button("Confirm all", "C: all labels of this recording are right"),
    stack: made("div", { className: "stack" }), stackAxes: made("div", { className: "stack" }),
    levels: made("p", { className: "facts levels" }), dialog: helpDialog(),
  };
  for (const [at, label] of LABELS.entries()) {
    const one = made("button", { type: "button", className: `label ${label}`, title: `Key ${at + 1}`, data: { label } }, made("i"), label);
    parts.labels.append(one);
  }
  parts.screen = made("div", { className: "screen", role: "img", ariaLabel: "Spectrogram" }, parts.plot, parts.marks);
  parts.overlay.append(parts.selection, parts.position);
  parts.area = made("div", { className: "area" }, parts.strip, parts.wave, parts.screen, parts.stack, parts.times, parts.overlay);
  const axes = made("div", { className: "axes" }, made("span", { className: "strip" }), parts.waveAxis, parts.frequencies, parts.stackAxes, made("span", { className: "times", textContent: "s" }));
  parts.lanes = made("div", { className: "lanes" }, axes, parts.area);
  element.replaceChildren(
    made("header", { className: "about" }, parts.title, parts.saved, parts.facts),
    made("div", { className: "tools" },
      group("Playing", parts.play, parts.loop, parts.clock),
      group("View", parts.out, parts.in, parts.whole, parts.fit),
      group("Correcting", parts.undo, parts.redo, parts.agree, parts.help)),
    parts.lanes,
    made("div", { className: "labelling" }, parts.labels, made("p", { className: "shortcuts", textContent: "none: no creak, squawk or squeal; unknown: a noise that may be none of the three" }), made("p", { className: "shortcuts", textContent: "Drag: select · 1–5: label · C: confirm all · Ctrl+Z: undo · Space: play · ?: keys" })),
    made("div", { className: "under" }, parts.readout, parts.legend),
    made("section", { className: "below", ariaLabel: "Segment" }, parts.chosen, parts.levels, parts.source, parts.conditions, parts.shares),
    parts.gains,
    made("div", { className: "tools" }, parts.channel.label, parts.others),
    parts.dialog);
  return parts;
}
