// A row of the list: the recording's name, every label in it, its figures.
import { made } from "../dom.js";

// Nothing is known of a recording that is on its way.
export function fillRow(node, shown) {
  const [mark, name, labels, numbers] = node.children;
  mark.className = shown?.label ?? "";
  // What tells files apart is at the end of a path: its folders are cut first.
  const file = shown ? shown.name.lastIndexOf("/") + 1 : 0;
  name.replaceChildren(...(shown ? [shown.name.slice(0, file), shown.name.slice(file)] : ["..."]).filter(Boolean).map((textContent) => made("bdi", { textContent })));
  name.title = shown ? shown.name : "";
  labels.textContent = shown ? title(shown) : "";
  numbers.textContent = shown ? figures(shown) : "";
}

// Every label in a recording, the longest first.
function title({ label, labels, error, corrected }) {
  if (error) return `refused: ${error}`;
  return (label ? labels.join(" + ") : "no label yet") + (corrected ? ", corrected" : "");
}

function figures({ frequency_hz: frequency, level_dba: level, duration_s: duration }) {
  const parts = [];
  if (frequency !== null) parts.push(`${Math.round(frequency)} Hz`);
  if (level !== null) parts.push(`${level.toFixed(1)} dB(A)`);
  if (duration !== null) parts.push(`${duration.toFixed(1)} s`);
  return parts.join(" · ");
}
