// The scale as a picture: a point for each sound, on its 95 % interval.

const NS = "http://www.w3.org/2000/svg";
const ROW = 26, TOP = 8, AXIS = 34, LETTER = 7.2, GAP = 10; // px
const STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50];

function drawn(tag, attributes, text) {
  const node = document.createElementNS(NS, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  if (text !== undefined) node.textContent = text;
  return node;
}

export function drawScale(svg, { sounds, question }) {
  const placed = sounds.filter(({ value }) => value !== null);
  svg.replaceChildren();
  svg.toggleAttribute("hidden", !placed.length);
  const width = Math.max(200, svg.parentElement.clientWidth), height = TOP + placed.length * ROW + AXIS;
  for (const [name, value] of Object.entries({ width, height, viewBox: `0 0 ${width} ${height}` })) svg.setAttribute(name, value);
  if (!placed.length) return;
  const letters = Math.min(Math.max(...placed.map(({ sound }) => sound.length)), Math.floor((0.4 * width) / LETTER));
  const left = letters * LETTER + GAP, right = width - 12;
  const low = Math.min(...placed.map((one) => one.low_95)), high = Math.max(...placed.map((one) => one.high_95));
  const x = (value) => left + ((value - low) / (high - low)) * (right - left);
  const bottom = TOP + placed.length * ROW;
  const step = STEPS.find((one) => ((right - left) / (high - low)) * one >= 44) ?? 100;
  for (let at = Math.ceil(low / step); at * step <= high; at++) {
    const text = `${Number((at * step).toFixed(1))}`.replace("-", "−");
    svg.append(drawn("line", { x1: x(at * step), x2: x(at * step), y1: TOP, y2: bottom, class: at ? "grid" : "zero" }),
      drawn("text", { x: x(at * step), y: bottom + 14, "text-anchor": "middle" }, text));
  }
  svg.append(drawn("text", { x: (left + right) / 2, y: bottom + 30, "text-anchor": "middle" }, "scale value"));
  for (const [at, one] of placed.entries()) {
    const y = TOP + (at + 0.5) * ROW;
    const name = one.sound.length > letters ? `${one.sound.slice(0, letters - 1)}…` : one.sound;
    const row = drawn("g", {});
    row.append(drawn("title", {}, `${one.sound}: ${one.value}, ${one.low_95} to ${one.high_95}`),
      drawn("text", { x: left - GAP, y: y + 4, "text-anchor": "end" }, name),
      drawn("line", { x1: x(one.low_95), x2: x(one.high_95), y1: y, y2: y, class: "interval" }),
      drawn("circle", { cx: x(one.value), cy: y, r: 5 }));
    svg.append(row);
    if (at && placed[at - 1].group !== one.group) svg.append(drawn("line", { x1: 0, x2: width, y1: y - ROW / 2, y2: y - ROW / 2, class: "apart" }));
  }
  svg.setAttribute("aria-label", `${question} Scale of ${placed.length} sounds with 95 % intervals, the same as in the table below`);
}
