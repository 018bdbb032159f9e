// Keyboard handling, and the help dialog on keys.
import { made } from "../dom.js";

const TOLD = [
  ["Drag", "select a stretch; Esc ends the selection"],
  ["1 2 3 4 5", "label creak, squawk, squeal, none, unknown: the selection becomes a segment; without one, the segment at the cursor"],
  ["C", "confirm all labels of this recording"],
  ["Ctrl+Z Ctrl+Shift+Z", "undo, redo a correction; also U"],
  ["Space", "play, pause"],
  ["L", "loop on, off: the selection, else the chosen segment, else all"],
  ["← →", "0.1 s back, forward; with Shift 1 s; on a border, move it by 10 ms, with Shift by 100 ms"],
  ["[ ]", "previous, next segment"],
  ["+ −", "zoom in, out; also by the wheel, which with Shift moves along"],
  ["0 F", "zoom to all, to the selection or segment"],
  ["?", "this list"],
];

export function helpDialog() {
  const close = made("button", { textContent: "Close" });
  const form = made("form", { method: "dialog" }, made("h2", { id: "keys-title", textContent: "Keys" }), close);
  const list = made("dl", {}, ...TOLD.flatMap(([keys, what]) => [
    made("dt", {}, ...keys.split(" ").flatMap((key) => [made("kbd", { textContent: key }), " "])),
    made("dd", { textContent: what }),
  ]));
  const dialog = made("dialog", { className: "keys" }, form, list);
  dialog.setAttribute("aria-labelledby", "keys-title");
  return dialog;
}

// Call the action of a key, except while typing or in a dialog.
export function listen(element, actions) {
  document.addEventListener("keydown", (event) => {
    if (event.altKey || event.defaultPrevented) return;
    if (!element.isConnected || element.closest("[hidden]") || document.querySelector("dialog[open]")) return;
    const { target } = event;
    if (target.matches("input:not([type=range]), select, textarea, [contenteditable]")) return;
    const at = target.closest("button, summary, [role=tab], [role=listbox]");
    if (at && (event.key === " " || event.key === "Enter") && !element.querySelector(".lanes")?.contains(at)) return;
    if (at?.matches("[role=tab]") && event.key.startsWith("Arrow")) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const action = actions[event.ctrlKey || event.metaKey ? `Ctrl+${event.shiftKey ? "Shift+" : ""}${key}` : key];
    if (!action) return;
    event.preventDefault();
    action(event);
  });
}
