// Corrections by buttons and keys on the page of a recording.
import { told } from "../api.js";
import { joined, relabelled, SHORTEST, split } from "./edits.js";

// Label the selection on all tracks, else the segment at the cursor.
export function label({ corrections, segments, timeline, player, sound }, said) {
  const { selection, position } = timeline;
  corrections.inTurn(() => {
    if (selection && selection.end - selection.start < SHORTEST) return told(`A segment is at least ${1000 * SHORTEST} ms long: select more.`);
    if (selection || !segments.chosen) {
      const { start, end } = selection ?? { start: 0, end: timeline.duration };
      corrections.paint(start, end, said, sound?.tracks ?? []);
      timeline.select(null);
      return segments.chooseAt(0.5 * (start + end));
    }
    if (player.playing && !player.looping) segments.chooseAt(position);
    corrections.write(relabelled(corrections.shown, segments.at, said));
  });
}

// Confirm all labels.
export function agree({ corrections }) {
  corrections.inTurn(() => {
    if (!corrections.rows.length) return told("There are no labels to confirm yet.");
    corrections.writeAll(corrections.rows.map((row) => ({ ...row, label_source: "human" })));
  });
}

export function splitHere({ corrections, segments, timeline, pointed }) {
  const time = pointed ?? timeline.position;
  corrections.inTurn(() => {
    const rows = split(corrections.shown, time);
    if (!rows) return told("Nothing to split here: put the cursor inside a segment.");
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

// Undo or redo, and open the recording of the change.
export function undo(page, redo = false) {
  page.corrections.inTurn(async () => {
    const id = await page.corrections.undo(redo);
    if (id !== null && id !== page.id) page.onOpen(id);
  });
}
