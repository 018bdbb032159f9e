// What is known of the chosen segment: its place, level, frequency, how sure its label is, and its conditions.
import { LABELS } from "./frame.js";
import { made } from "../dom.js";

const HALF = 0.5;

export function showSegment({ chosen, labels, shares, source, conditions }, row) {
  for (const button of labels.children) button.setAttribute("aria-pressed", button.dataset.label === row?.label);
  if (!row) {
    chosen.textContent = "No label yet. Select a stretch and press 1 to 5, or press 1 to 5 to label the whole recording.";
    source.textContent = conditions.textContent = "";
    shares.replaceChildren();
    return;
  }
  const facts = [`${row.start_s.toFixed(2)}–${row.end_s.toFixed(2)} s`];
  if (known(row.frequency_hz)) facts.push(`${row.frequency_hz.toFixed(0)} Hz`);
  if (known(row.level_dba)) facts.push(`${row.level_dba.toFixed(1)} dB(A)`);
  else if (known(row.level_dbfs)) facts.push(`${row.level_dbfs.toFixed(1)} dBFS`);
  chosen.replaceChildren(made("b", { textContent: row.label }), ` ${facts.join(", ")}`);
  const found = LABELS.map((label) => [label, row[`p_${label}`]]).filter(([, share]) => known(share));
  if (row.label_source === "human") source.textContent = "By a person.";
  else if (!found.length) source.textContent = "The table gives no probability.";
  else if ((row[`p_${row.label}`] ?? 0) < HALF) source.textContent = "By the classifier. Low confidence (below 50 %): please listen.";
  else source.textContent = "By the classifier.";
  conditions.textContent = [...(row.conditions ?? []), row.note].filter(Boolean).join("; ");
  shares.replaceChildren(...found.flatMap(([label, share]) => {
    const bar = made("span", { className: `bar ${label}` });
    bar.style.width = `${100 * share}%`;
    return [made("dt", { textContent: label }), made("dd", {}, made("span", { className: "number", textContent: share.toFixed(2) }), made("span", { className: "room" }, bar))];
  }));
}

function known(value) { return value !== null && value !== undefined; }
