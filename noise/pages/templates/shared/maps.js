// Maps of compared designs: a click plays the sound there, or the nearest one of the same label, of A and B in step.
if (document.getElementById("designs")) (function () {
  const controls = document.getElementById("designs"), maps = [...document.querySelectorAll("[data-map]")];
  const short = (value) => Number(value.toPrecision(3)).toString();
  const at = (spot) => [parseFloat(spot.style.left) / 100, parseFloat(spot.style.bottom) / 100];
  const spotsOf = (map) => [...map.querySelectorAll(".spot")];
  const designOf = (map) => Number(map.dataset.design);
  let [a, b] = controls.dataset.pair.split(" ").map(Number);

  // Result at a point of a map in words: label and its area.
  function labelAt(map, x, y) {
    const { width, height } = map.querySelector(".plot svg").viewBox.baseVal, [left, top] = [x * width, (1 - y) * height];
    const inside = ({ x: { baseVal: from }, y: { baseVal: upper }, width: w, height: h }) =>
      from.value <= left && left <= from.value + w.baseVal.value && upper.value <= top && top <= upper.value + h.baseVal.value;
    return [...map.querySelectorAll("rect.area")].find(inside)?.dataset.label;
  }

  // Words of a spot, of both designs if both are playable.
  function words(spot) {
    const [where, own] = spot.getAttribute("aria-label").split(": "), mates = spot.dataset.mates.split(",");
    const [one, other] = [a, b].map((design) => document.querySelector(`.spot[data-sound="${mates[design] || "-"}"]`));
    if (a === b || !one || !other || (spot !== one && spot !== other)) return `${where}: ${own}`;
    return `${where}: A ${one.getAttribute("aria-label").split(": ")[1]}; B ${other.getAttribute("aria-label").split(": ")[1]}`;
  }

  function choose(one, other) {
    const changed = one !== a || other !== b;
    [a, b] = [one, other];
    for (const [slot, value] of Object.entries({ a, b })) {
      const select = document.getElementById("design-" + slot);
      if (select) select.value = String(value);
    }
    // Playback continues with the chosen designs, if they have sounds at this condition.
    const mates = (changed && document.querySelector(".spot[aria-pressed=true]"))?.dataset.mates.split(",") ?? [];
    if (mates[a]) engine.put("a", mates[a]);
    if (mates[b]) engine.put("b", mates[b]);
    update();
  }

  function update() {
    for (const map of maps) {
      const design = designOf(map), slot = map.querySelector(".slot");
      map.style.order = design === a ? 0 : design === b ? 1 : 2;
      slot.hidden = a === b || (design !== a && design !== b);
      slot.textContent = design === a ? "A" : "B";
    }
  }

  // Play both designs in step; a click on the other map switches between them.
  function play(map, spot, before = "") {
    for (const other of spotsOf(map)) other.tabIndex = other === spot ? 0 : -1;
    const mates = spot.dataset.mates.split(","), own = designOf(map);
    if (own !== a && own !== b) choose(a, own);
    const slot = own === a ? "a" : "b", pair = { a: mates[a] || null, b: a === b ? null : mates[b] || null };
    const same = engine.playing && engine.active !== slot && engine.slots.a === pair.a && engine.slots.b === pair.b;
    engine.slots = pair;
    engine.hear(slot);
    if (!same) engine.begin(mates[own]);
    page.choose(mates[own], false);
    tell(map, `${before}${words(spot)}.`);
  }

  function tell(map, text) {
    map.closest(".place").querySelector(".told").textContent = text;
    page.say(text);
  }

  // Play the nearest sound of the same label, else of any.
  function playNear(map, { clientX, clientY }) {
    const plot = map.querySelector(".plot"), asked = map.querySelector(".asked"), box = plot.getBoundingClientRect();
    const x = (clientX - box.left) / box.width, y = 1 - (clientY - box.top) / box.height;
    asked.hidden = false;
    asked.style.left = 100 * x + "%";
    asked.style.bottom = 100 * y + "%";
    const [speed, fit] = [[x, map.dataset.speed], [y, map.dataset.interference]].map(([share, ends]) => {
      const [low, high] = ends.split(" ").map(Number);
      return short(low + share * (high - low));
    });
    const label = labelAt(map, x, y), found = `${speed} rad/s, ${fit} mm: ${label}`, spots = spotsOf(map);
    if (!spots.length) return tell(map, `${found}. There is no sound on this map.`);
    const alike = spots.filter((spot) => labelAt(map, ...at(spot)) === label), far = (spot) => Math.hypot(at(spot)[0] - x, at(spot)[1] - y);
    const nearest = (alike.length ? alike : spots).reduce((best, one) => (far(one) < far(best) ? one : best));
    return play(map, nearest, `${found}. Nearest sound${alike.length ? " of that label" : ", which has another label"}: `);
  }

  for (const map of maps) {
    const plot = map.querySelector(".plot"), spots = spotsOf(map);
    plot.addEventListener("click", (event) => {
      const spot = event.target.closest(".spot");
      if (!spot) return playNear(map, event);
      map.querySelector(".asked").hidden = true;
      return play(map, spot);
    });
    plot.addEventListener("keydown", (event) => {
      const by = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -1, ArrowDown: 1 }[event.key], from = spots.indexOf(event.target.closest(".spot"));
      if (from < 0 || !by || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      event.stopPropagation();
      const next = spots[Math.min(spots.length - 1, Math.max(0, from + by))];
      for (const other of spots) other.tabIndex = other === next ? 0 : -1;
      next.focus();
    });
    engine.addEventListener("change", () => {
      for (const spot of spots) spot.setAttribute("aria-pressed", String(engine.key === spot.dataset.sound));
    });
  }
  controls.addEventListener("change", ({ target }) => {
    if (target.id === "design-a") choose(Number(target.value), b);
    if (target.id === "design-b") choose(a, Number(target.value));
  });
  update();
})();
