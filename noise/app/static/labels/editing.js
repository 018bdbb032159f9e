// What a person says of the segments of a recording's page, in the order in which it is said.
import { told } from "../api.js";
import { joined, relabelled, split } from "./edits.js";

export function label({ corrections, segments, timeline, sound }, said) {
  const whole = (sound?.tracks ?? []).map((channel) => ({ start_s: 0, end_s: timeline.duration, label: said, channel, label_source: "human" }));
  corrections.inTurn(() => corrections.write(segments.chosen ? relabelled(corrections.shown, segments.at, said) : whole));
}

export function splitHere({ corrections, segments, timeline, pointed }) {
  const time = pointed ?? timeline.position;
  corrections.inTurn(() => {
    const rows = split(corrections.shown, time);
    if (!rows) return told("A segment is split inside it: put the cursor there.");
    const at = rows.findIndex((row) => Math.abs(row.start_s - time) < 0.002);
    corrections.write(rows);
    if (at > 0) segments.choose(at);
  });
}

export function joinHere({ corrections, segments }) {
  corrections.inTurn(() => {
    const rows = joined(corrections.shown, segments.at);
    if (!rows) return told("There is no other segment to join it to.");
    const at = Math.max(0, segments.at - 1);
    corrections.write(rows);
    segments.choose(at);
  });
}

// The last change may be of another recording, which is then opened.
export function undo(page) {
  page.corrections.inTurn(async () => {
    const id = await page.corrections.undo();
    if (id !== null && id !== page.id) page.onOpen(id);
  });
}
