// Edits of the sorted segments of one track as pure functions.

export const SHORTEST = 0.01; // of a segment [s]
const SAME = 1e-6; // s

const HUMAN = "human";

// Borders { left, right, time } of segments; null beside a gap.
export function borders(rows) {
  const found = [];
  for (let at = 0; at + 1 < rows.length; at++) {
    const end = rows[at].end_s, start = rows[at + 1].start_s;
    if (Math.abs(end - start) < SAME) found.push({ left: at, right: at + 1, time: end });
    else found.push({ left: at, right: null, time: end }, { left: null, right: at + 1, time: start });
  }
  return found;
}

export function limits(rows, { left, right }) {
  const low = left !== null ? rows[left].start_s + SHORTEST : rows[right - 1].end_s;
  const high = right !== null ? rows[right].end_s - SHORTEST : rows[left + 1].start_s;
  return { low, high };
}

export function moved(rows, border, time) {
  const { low, high } = limits(rows, border);
  const at = Math.min(high, Math.max(low, Math.round(time * 1000) / 1000));
  return rows.map((row, index) => {
    if (index === border.left) return said(row, { end_s: at });
    return index === border.right ? said(row, { start_s: at }) : row;
  });
}

export function relabelled(rows, index, label) {
  return rows.map((row, at) => (at === index ? said(row, { label }) : row));
}

// Make an interval a segment; remainders that are too short join it.
export function painted(rows, start, end, label) {
  let from = Math.round(start * 1000) / 1000, to = Math.round(end * 1000) / 1000;
  for (const { start_s: first, end_s: last } of rows) {
    if (first < from && last > from && from - first < SHORTEST) from = first;
    if (last > to && first < to && last - to < SHORTEST) to = last;
  }
  const rest = rows.flatMap((row) => [
    ...(row.start_s < from ? [{ ...row, end_s: Math.min(row.end_s, from) }] : []),
    ...(row.end_s > to ? [{ ...row, start_s: Math.max(row.start_s, to) }] : []),
  ]);
  return [...rest, { start_s: from, end_s: to, label, label_source: HUMAN }].sort((one, two) => one.start_s - two.start_s);
}

function said(row, change) {
  return { ...row, ...change, label_source: HUMAN };
}
