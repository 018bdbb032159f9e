// Condition maps: a click plays the sound there, or the nearest one of the same label.
// For compared designs it draws the difference of designs A and B.
const short = (value) => Number(value.toPrecision(3)).toString();
const at = (spot) => [parseFloat(spot.style.left) / 100, parseFloat(spot.style.bottom) / 100];

const comparison = (function () {
  const content = document.getElementById("compared");
  if (!content) return null;
  const data = JSON.parse(content.textContent);
  const NONE = data.labels.indexOf("none"), SOFT = 3, MUCH = 10; // dB
  const sections = [...document.querySelectorAll("[data-comparison]")];
  let [a, b] = data.pair, look = "noise";

  const signed = (value) => (Math.round(value) < 0 ? "\u2212" : Math.round(value) > 0 ? "+" : "") + Math.abs(Math.round(value));
  const placeOf = (map) => data.places[map.closest("[data-comparison]").dataset.comparison];
  const designOf = (map) => (map.dataset.design === undefined ? null : Number(map.dataset.design));
  const has = (of, cell) => of !== undefined && of.label[cell] >= 0;
  const noisy = (of, cell) => has(of, cell) && of.label[cell] !== NONE;

  function element(name, values, text = "") {
    const made = document.createElementNS(document.querySelector("svg").namespaceURI, name);
    for (const [key, value] of Object.entries(values)) made.setAttribute(key, value);
    made.textContent = text;
    return made;
  }

  // Difference of B and A in a cell.
  function differing(one, other, cell) {
    if (!has(one, cell) || !has(other, cell)) return "";
    const [before, after] = [noisy(one, cell), noisy(other, cell)];
    if (!before || !after) return before ? "gone" : after ? "new" : "quiet";
    const by = other.level[cell] - one.level[cell];
    if (one.level[cell] === null || other.level[cell] === null || Math.abs(by) < SOFT) return "alike";
    return (by < 0 ? "softer" : "louder") + (Math.abs(by) >= MUCH ? "-much" : "");
  }

  // Draw runs of equal cells as rectangles with text; the lowest row first.
  function drawDifference(map, { x, y, designs: { [a]: one, [b]: other } }) {
    const group = element("g", { class: "drawn" }), columns = x.length - 1;
    for (let row = 0; row + 1 < y.length; row++) {
      const kinds = Array.from({ length: columns }, (_, column) => differing(one, other, row * columns + column));
      for (let first = 0, end; first < columns; first = end) {
        const kind = kinds[first];
        end = first + 1;
        while (kinds[end] === kind) end++;
        if (!kind) continue;
        const width = x[end] - x[first], height = y[row] - y[row + 1];
        group.append(element("rect", { x: x[first], y: y[row + 1], width, height, fill: `url(#fill-${kind})` }));
        const by = Array.from({ length: end - first }, (_, i) => other.level[row * columns + first + i] - one.level[row * columns + first + i]);
        const text = /^(softer|louder)/.test(kind) ? `${signed(by.reduce((sum, each) => sum + each) / by.length)} dB` : kind;
        if (width > 9 * text.length && height > 18) group.append(element("text", { x: x[first] + 6, y: y[row] - 7 }, text));
      }
    }
    map.querySelector(".plot svg").append(group);
  }

  function cellAt(map, x, y) {
    const place = placeOf(map), svg = map.querySelector(".plot svg").viewBox.baseVal, columns = place.x.length - 1;
    const column = place.x.findLastIndex((edge) => edge <= x * svg.width), row = place.y.findLastIndex((edge) => edge >= (1 - y) * svg.height);
    return Math.max(0, Math.min(place.y.length - 2, row)) * columns + Math.max(0, Math.min(columns - 1, column));
  }

  function says(place, design, cell) {
    const of = place.designs[design];
    if (!has(of, cell)) return "not screened";
    const level = of.level[cell];
    return data.labels[of.label[cell]] + (noisy(of, cell) && level !== null ? `, ${Math.round(level)} dB(A)` : "");
  }

  // Words and labels of the designs at a point of a map, of both designs of the pair on their maps.
  function here(map, x, y) {
    const place = placeOf(map), cell = cellAt(map, x, y), own = designOf(map);
    const designs = own === null || own === a || own === b ? [...new Set([a, b])] : [own];
    const words = designs.map((design) => (designs.length > 1 ? (design === a ? "A " : "B ") : "") + says(place, design, cell));
    return { words: words.join("; "), labels: designs.map((design) => (has(place.designs[design], cell) ? place.designs[design].label[cell] : -1)).join() };
  }

  // Words of a spot, of both designs if both are playable.
  function words(map, spot) {
    const label = spot.getAttribute("aria-label"), found = here(map, ...at(spot));
    return found.labels.includes(",") ? label.split(":")[0] + ": " + found.words : label;
  }

  // Play both designs in step; a click on the other map switches between them.
  function play(map, spot) {
    const mates = spot.dataset.mates.split(","), own = designOf(map) ?? (engine.active === "a" ? a : b);
    if (own !== a && own !== b) choose(a, own);
    const slot = own === a ? "a" : "b", pair = { a: mates[a] || null, b: a === b ? null : mates[b] || null };
    const same = engine.playing && engine.active !== slot && engine.slots.a === pair.a && engine.slots.b === pair.b;
    engine.slots = pair;
    engine.hear(slot);
    if (!same && mates[own]) engine.begin(mates[own]);
    return mates[own];
  }

  function choose(one, other) {
    const changed = one !== a || other !== b;
    [a, b] = [one, other];
    for (const [slot, value] of Object.entries({ a, b })) {
      const select = document.getElementById("design-" + slot);
      if (select) select.value = String(value);
    }
    // Playback continues with the chosen designs, if they have sounds at this condition.
    const spot = changed && document.querySelector(".spot[aria-pressed=true][data-mates]");
    const mates = spot ? spot.dataset.mates.split(",") : [];
    if (mates[a]) engine.put("a", mates[a]);
    if (mates[b]) engine.put("b", mates[b]);
    update();
  }

  function update() {
    for (const section of sections) {
      const place = data.places[section.dataset.comparison];
      const both = place.designs[a] && place.designs[b] && a !== b;
      for (const map of section.querySelectorAll("[data-map]")) {
        const design = designOf(map), slot = map.querySelector(".slot");
        map.querySelector(".drawn")?.remove();
        map.style.order = design === null ? 2 : a === b || design === a ? 0 : design === b ? 1 : 3;
        if (design !== null) {
          slot.hidden = a === b || (design !== a && design !== b);
          slot.textContent = design === a ? "A" : "B";
          for (const areas of map.querySelectorAll(".areas")) areas.toggleAttribute("hidden", areas.dataset.areas !== look);
          continue;
        }
        map.hidden = !both;
        if (!both) continue;
        drawDifference(map, place);
        for (const spot of map.querySelectorAll(".spot")) {
          const cell = cellAt(map, ...at(spot)), where = spot.getAttribute("aria-label").split(":")[0];
          spot.setAttribute("aria-label", `${where}: A ${says(place, a, cell)}; B ${says(place, b, cell)}`);
        }
      }
    }
    for (const button of document.querySelectorAll("[data-look]")) button.setAttribute("aria-pressed", String(button.dataset.look === look));
    for (const key of document.querySelectorAll("[data-key]")) key.hidden = key.dataset.key === "difference" ? a === b : key.dataset.key !== look;
  }

  document.addEventListener("click", (event) => {
    const button = event.target.closest("[data-look], #swap");
    if (!button) return;
    if (button.id === "swap") choose(b, a);
    else { look = button.dataset.look; update(); }
  });
  document.addEventListener("change", ({ target }) => {
    if (target.id === "design-a") choose(Number(target.value), b);
    if (target.id === "design-b") choose(a, Number(target.value));
  });
  // Open folded sections for printing.
  let folded = [];
  addEventListener("beforeprint", () => {
    folded = sections.filter((section) => !section.open);
    for (const section of folded) section.open = true;
  });
  addEventListener("afterprint", () => { for (const section of folded) section.open = false; });
  update();
  return { here, play, words };
})();

for (const map of document.querySelectorAll("[data-map]")) {
  const plot = map.querySelector(".plot"), asked = map.querySelector(".asked"), section = map.closest("[data-comparison]");
  const told = (section || map).querySelector(".told"), spots = [...map.querySelectorAll(".spot")];
  const heard = spots.filter((spot) => spot.dataset.sounds);
  const [speeds, fits] = [map.dataset.speed, map.dataset.interference].map((text) => text.split(" ").map(Number));

  function tell(text) {
    told.textContent = text;
    page.say(text);
  }

  function play(spot, before = "") {
    const keys = spot.dataset.sounds.split(" ").filter(Boolean);
    for (const other of spots) other.tabIndex = other === spot ? 0 : -1;
    if (!keys.length) return tell(spot.getAttribute("aria-label") + ".");
    let key = keys[(keys.indexOf(engine.key) + 1) % keys.length];
    if (section) key = comparison.play(map, spot);
    else engine.begin(key);
    page.choose(key || null, false);
    const which = keys.length > 1 && !section ? ` (sound ${keys.indexOf(key) + 1} of ${keys.length})` : "";
    tell(before + (section ? comparison.words(map, spot) : spot.getAttribute("aria-label")) + which + ".");
  }

  plot.addEventListener("click", (event) => {
    const spot = event.target.closest(".spot");
    asked.hidden = Boolean(spot);
    if (spot) return play(spot);
    const box = plot.getBoundingClientRect();
    const x = (event.clientX - box.left) / box.width, y = 1 - (event.clientY - box.top) / box.height;
    asked.style.left = 100 * x + "%";
    asked.style.bottom = 100 * y + "%";
    let words = `${short(speeds[0] + x * (speeds[1] - speeds[0]))} rad/s, ${short(fits[0] + y * (fits[1] - fits[0]))} mm`, among = heard, of = "sound";
    if (section) {
      const found = comparison.here(map, x, y), alike = heard.filter((one) => comparison.here(map, ...at(one)).labels === found.labels);
      words += ": " + found.words;
      if (alike.length) among = alike;
      of += !alike.length ? ", which has other labels" : found.labels.includes(",") ? " of those labels" : " of that label";
    }
    if (!among.length) return tell(words + ". There is no sound on this map.");
    const far = (one) => Math.hypot(at(one)[0] - x, at(one)[1] - y);
    return play(among.reduce((best, one) => (far(one) < far(best) ? one : best)), `${words}. Nearest ${of}: `);
  });

  plot.addEventListener("keydown", (event) => {
    const spot = event.target.closest(".spot");
    const by = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (!spot || !by || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    event.stopPropagation();
    const next = spots[Math.min(spots.length - 1, Math.max(0, spots.indexOf(spot) + by))];
    for (const other of spots) other.tabIndex = other === next ? 0 : -1;
    next.focus();
  });

  engine.addEventListener("change", () => {
    for (const spot of spots) spot.setAttribute("aria-pressed", String(engine.key !== null && spot.dataset.sounds.split(" ").includes(engine.key)));
  });
}
