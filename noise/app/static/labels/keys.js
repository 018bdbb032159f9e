// Keys of the view, and the dialog that tells them.
import { made } from "../dom.js";

const TOLD = [
  ["Space", "play, pause"],
  ["L", "loop on, off: the selection, else the chosen segment, else all"],
  ["← →", "0.1 s back, on; with Shift 1 s; on a border it moves by 10 ms, with Shift by 100 ms; on the spectrogram the cursor moves"],
  ["[ ]", "segment before, after"],
  ["1 2 3 4 5", "the segment is creak, squawk, squeal, none, unknown; its own label: agreed"],
  ["S", "split at the cursor, or where it is played"],
  ["Delete", "join to the segment before it"],
  ["U", "undo the last correction"],
  ["+ −", "zoom in, out; also by the wheel"],
  ["0 F", "all; the chosen segment"],
  ["H", "multiples of the frequency under the cursor"],
  ["B", "keep this sound as B, from where the loop begins"],
  ["X", "listen to the other of A and B, at the same moment"],
  ["E", "equal loudness on, off"],
  ["Esc", "no selection"],
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

// Call what a key stands for, unless somebody is typing or a dialog is open.
export function listen(element, actions) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (!element.isConnected || element.closest("[hidden]") || document.querySelector("dialog[open]")) return;
    const { target } = event;
    if (target.matches("input, select, textarea, [contenteditable]")) return;
    const at = target.closest("button, summary, [role=tab], [role=listbox]");
    if (at && (event.key === " " || event.key === "Enter") && !element.querySelector(".lanes")?.contains(at)) return;
    if (at?.matches("[role=tab]") && event.key.startsWith("Arrow")) return;
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action(event);
  });
}
