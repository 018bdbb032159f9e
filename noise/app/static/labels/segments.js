// Segments on the lanes: coloured regions, names, and borders moved by pointer or keys.
import { borders, limits, moved } from "./edits.js";
import { LABELS } from "./frame.js";
import { made } from "../dom.js";
import { drag } from "./pointer.js";
import { seconds } from "./timeline.js";

const STEP = 0.01; // of an arrow key on a border [s]

export class Segments {
  constructor(timeline, corrections, { strip, overlay }, chosen) {
    Object.assign(this, { timeline, corrections, strip, overlay, onChosen: chosen });
    this.at = 0; // index of the chosen segment
    this.known = { length: 0, middle: 0 }; // number of segments, and middle of the chosen one [s]
    this.regions = made("div", { className: "regions" });
    this.handles = made("div", { className: "handles" });
    overlay.append(this.regions, this.handles);
    corrections.addEventListener("change", () => this.draw());
  }

  get chosen() { return this.corrections.shown[this.at]; }

  choose(at) {
    const { length } = this.corrections.shown;
    this.at = Math.min(Math.max(0, at), Math.max(0, length - 1));
    this.known.length = length;
    this.draw();
    this.onChosen(this.chosen);
  }

  chooseAt(time) {
    const at = this.corrections.shown.findIndex((row) => row.start_s <= time && time < row.end_s);
    if (at >= 0) this.choose(at);
  }

  draw() {
    const { shown: rows, lanes } = this.corrections;
    this.at = this.#place(rows);
    this.strip.parentNode.parentNode.style.setProperty("--strips", Math.max(1, lanes.length));
    fill(this.strip, lanes.length, () => made("div", { className: "lane" }));
    for (const [at, { tracks, rows: ofLane }] of lanes.entries()) this.#lane(this.strip.children[at], tracks, ofLane, lanes.length > 1);
    fill(this.regions, rows.length, () => made("div"));
    for (const [at, row] of rows.entries()) {
      const region = this.regions.children[at];
      region.className = `segment ${row.label}`;
      region.classList.toggle("chosen", at === this.at);
      this.#put(region, row.start_s, row.end_s);
    }
    const found = borders(rows);
    fill(this.handles, found.length, () => this.#handle());
    for (const [at, border] of found.entries()) {
      const handle = this.handles.children[at];
      handle.border = border;
      const { low, high } = limits(rows, border);
      const names = [border.left, border.right].filter((index) => index !== null).map((index) => rows[index].label);
      handle.setAttribute("aria-label", border.right === null ? `End of ${names[0]}` : border.left === null ? `Start of ${names[0]}` : `Border of ${names.join(" and ")}`);
      for (const [name, value] of [["min", low], ["max", high], ["now", border.time]]) handle.setAttribute(`aria-value${name}`, value.toFixed(3));
      handle.setAttribute("aria-valuetext", `${border.time.toFixed(3)} s`);
      const share = this.timeline.share(border.time);
      handle.hidden = share < 0 || share > 1;
      handle.style.left = `${100 * share}%`;
    }
  }

  #lane(lane, tracks, rows, isOneOfSeveral) {
    const current = tracks.includes(this.corrections.track), name = isOneOfSeveral ? `, track ${tracks.join(" and ")}` : "";
    lane.track = tracks[0];
    fill(lane, rows.length, () => this.#button());
    for (const [at, row] of rows.entries()) {
      const button = lane.children[at];
      button.className = `segment ${row.label}`;
      button.firstChild.textContent = row.label + (isOneOfSeveral && !at ? ` (track ${tracks.join(", ")})` : "");
      button.setAttribute("aria-pressed", current && at === this.at);
      button.setAttribute("aria-label", `${row.label}, ${seconds(row.start_s, 0.01)} to ${seconds(row.end_s, 0.01)} s${name}${row.label_source === "human" ? ", by a person" : ""}`);
      this.#put(button, row.start_s, row.end_s);
    }
  }

  // Index of the chosen segment after a change: the one at the same time.
  #place(rows) {
    const { length, middle } = this.known;
    const found = length && rows.length !== length ? rows.findLastIndex((row) => row.start_s <= middle) : this.at;
    const at = Math.min(Math.max(0, found), Math.max(0, rows.length - 1));
    this.known = rows.length ? { length: rows.length, middle: 0.5 * (rows[at].start_s + rows[at].end_s) } : { length: 0, middle };
    return at;
  }

  #put(node, start, end) {
    const from = Math.max(0, this.timeline.share(start)), to = Math.min(1, this.timeline.share(end));
    node.hidden = to <= 0 || from >= 1;
    node.style.left = `${100 * from}%`;
    node.style.width = `${100 * Math.max(0, to - from)}%`;
  }

  #button() {
    const button = made("button", { type: "button" }, made("span"));
    button.addEventListener("click", () => {
      const lane = button.parentNode;
      this.corrections.show(lane.track);
      this.timeline.select(null);
      this.choose([...lane.children].indexOf(button));
      this.timeline.go(this.chosen.start_s);
    });
    button.addEventListener("dblclick", () => this.timeline.fit(this.chosen.start_s, this.chosen.end_s));
    return button;
  }

  #handle() {
    const handle = made("div", { className: "handle", tabIndex: 0 });
    handle.setAttribute("role", "slider");
    handle.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -STEP, ArrowRight: STEP }[event.key];
      if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      const { border } = handle;
      const { corrections } = this, by = step * (event.shiftKey ? 10 : 1);
      corrections.inTurn(() => corrections.write(moved(corrections.shown, border, border.time + by), `border ${border.left} ${border.right}`));
    });
    handle.addEventListener("pointerdown", (event) => {
      if (event.button) return;
      event.preventDefault();
      handle.focus();
      const { corrections } = this, { border } = handle, { id, track, shown: { length } } = corrections;
      const same = () => id === corrections.id && track === corrections.track && length === corrections.shown.length;
      let time = null;
      // Use the current rows, which a key may have changed.
      const move = ({ clientX }) => {
        const box = this.overlay.getBoundingClientRect();
        time = this.timeline.time((clientX - box.left) / box.width);
        if (same()) corrections.preview(moved(corrections.shown, border, time));
      };
      const end = (last) => {
        if (time === null) return;
        corrections.inTurn(() => {
          if (last.type === "pointerup" && same()) corrections.write(moved(corrections.shown, border, time));
          else corrections.restore();
        });
      };
      drag(handle, event, move, end);
    });
    return handle;
  }
}

function fill(parent, count, make) {
  while (parent.children.length > count) parent.lastChild.remove();
  while (parent.children.length < count) parent.append(make());
}

// Show the chosen segment: interval, level, frequency, probabilities and conditions.
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
  else if ((row[`p_${row.label}`] ?? 0) < 0.5) source.textContent = "By the classifier. Low confidence (below 50 %): please listen.";
  else source.textContent = "By the classifier.";
  conditions.textContent = [...(row.conditions ?? []), row.note].filter(Boolean).join("; ");
  shares.replaceChildren(...found.flatMap(([label, share]) => {
    const bar = made("span", { className: `bar ${label}` });
    bar.style.width = `${100 * share}%`;
    return [made("dt", { textContent: label }), made("dd", {}, made("span", { className: "number", textContent: share.toFixed(2) }), made("span", { className: "room" }, bar))];
  }));
}

const known = (value) => value !== null && value !== undefined;
