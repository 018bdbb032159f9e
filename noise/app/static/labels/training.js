// Learning from corrections: one button, how far it is, and the scores before and after.
import { api, told } from "../api.js";
import { made } from "./list.js";

const POLL = 1000; // while it learns [ms]

export function mountTraining(element, changed) {
  const summary = made("summary", { textContent: "Learn from corrections" });
  const what = made("p");
  const button = made("button", { type: "button", textContent: "Learn" });
  const progress = made("progress", { ariaLabel: "Learning", hidden: true });
  const line = made("p");
  const scores = made("div");
  element.replaceChildren(summary, what, made("div", { className: "line" }, button, progress), line, scores);
  let wasRunning = false;
  let shown = null;

  button.addEventListener("click", async () => { await api("train", {}); follow(); });
  element.addEventListener("toggle", () => { if (element.open) follow(); });

  async function follow() {
    const state = await api("train");
    button.disabled = state.running || !state.corrected;
    progress.hidden = !state.running;
    if (state.running && state.of) { progress.max = state.of; progress.value = state.done; } else progress.removeAttribute("value");
    line.textContent = state.message;
    if (JSON.stringify(state.scores) !== shown) {
      shown = JSON.stringify(state.scores);
      scores.replaceChildren(...(state.scores ? [table(state.scores)] : []));
    }
    if (wasRunning && !state.running) {
      told(state.message);
      changed();
    }
    wasRunning = state.running;
    if (state.running) setTimeout(follow, POLL);
  }

  return {
    tell(corrected) {
      what.textContent = corrected
        ? `${corrected.toLocaleString("en")} ${corrected === 1 ? "recording is" : "recordings are"} corrected. Learning takes minutes, the first time up to twenty; the others are then labelled anew, what you said stays.`
        : "Nothing is corrected yet.";
      if (!wasRunning) button.disabled = !corrected;
    },
  };
}

// Each file scored by trees that were grown without it, and by trees grown without any of these files.
function table({ files, labels }) {
  const head = made("tr", {}, ...["label", "pieces", "found before", "found now", "false before", "false now"].map((text) => Object.assign(made("th", { textContent: text }), { scope: "col" })));
  const rows = labels.map(({ label, windows, enough, recall_before: before, recall: now, false_names_before: wrong, false_names: stillWrong }) =>
    made("tr", {}, Object.assign(made("th", { textContent: label + (enough ? "" : " *") }), { scope: "row" }),
      ...[windows, share(before), share(now), wrong, stillWrong].map((value) => made("td", { textContent: value }))));
  const few = labels.some((one) => !one.enough) ? " * too few files to tell." : "";
  return made("figure", {},
    made("table", {}, made("thead", {}, head), made("tbody", {}, ...rows)),
    made("figcaption", { textContent: `Pieces of at most a second from ${files} corrected files, each scored by trees grown without its file; before: by trees grown without any of these files.${few}` }));
}

function share(value) {
  return value === null ? "–" : `${Math.round(100 * value)} %`;
}
