// Cards, cursors, player bar and keyboard of a page.
const page = (function () {
  const $ = (id) => document.getElementById(id);
  const each = (selector, act) => document.querySelectorAll(selector).forEach(act);
  const press = (button, on) => button.setAttribute("aria-pressed", String(on));
  const cards = [...document.querySelectorAll("[data-card]")].filter((card) => about[card.dataset.card]);
  const mini = $("mini");
  let chosen = null, drawing = false, shown = null, said = null;

  function choose(key, move) {
    chosen = key;
    for (const card of cards) card.classList.toggle("chosen", card.dataset.card === key);
    const card = move && cards.find((one) => one.dataset.card === key);
    if (!card) return;
    card.focus({ preventScroll: true });
    card.scrollIntoView({ block: "nearest" });
  }

  function place(view, key) {
    const { duration } = about[key], at = Math.min(engine.now(), duration), slider = view.querySelector(".seek");
    view.querySelector(".cursor").style.left = 100 * at / duration + "%";
    slider.setAttribute("aria-valuenow", at.toFixed(2));
    slider.setAttribute("aria-valuetext", at.toFixed(2) + " s");
  }

  function frame() {
    each("[data-view]", (view) => {
      const key = view.dataset.view, on = Object.values(engine.slots).includes(key);
      view.classList.toggle("on", on);
      view.classList.toggle("heard", key === engine.key);
      if (on) place(view, key);
    });
    if (engine.key !== null) {
      place(mini, engine.key);
      $("time").textContent = `${engine.now().toFixed(2)} / ${about[engine.key].duration.toFixed(2)} s`;
    }
    drawing = engine.playing;
    if (drawing) requestAnimationFrame(frame);
  }

  function status(key) {
    const slot = engine.active.toUpperCase();
    if (engine.failure) return engine.failure;
    if (key === null) return slot + " is empty: play a sound to put it there.";
    const { title, label, facts } = about[key];
    return said && said.key === key ? said.text : slot + ": " + [title, label, facts].filter(Boolean).join(" · ");
  }

  function bar() {
    const { key, playing, slots } = engine;
    if (slots.a !== null || slots.b !== null) $("player").classList.add("used");
    $("toggle").textContent = playing ? "Pause" : "Play";
    $("toggle").setAttribute("aria-label", playing ? "Pause" : "Play");
    press($("loop"), engine.looping);
    each("[data-slot]", (button) => {
      const of = slots[button.dataset.slot];
      press(button, button.dataset.slot === engine.active);
      button.querySelector("span").textContent = of === null ? "empty" : about[of].title;
    });
    if (key !== shown) {
      shown = key;
      const image = mini.querySelector("img");
      image.hidden = key === null;
      if (key !== null) image.src = about[key].picture || document.querySelector(`[data-view="${key}"] img`)?.src || "";
      mini.classList.toggle("on", key !== null);
      mini.querySelector(".seek").setAttribute("aria-valuemax", key === null ? "0" : about[key].duration.toFixed(2));
    }
    const words = status(key);
    if ($("status").textContent !== words) $("status").textContent = words;
  }

  function update() {
    bar();
    each("[data-put]", (button) => press(button, engine.slots[button.dataset.put] === button.dataset.of));
    each("[data-play]", (button) => {
      const key = button.dataset.play, words = engine.playing && engine.key === key ? "Pause" : "Play";
      button.textContent = words;
      button.setAttribute("aria-label", `${words} ${about[key].title}`);
    });
    if (drawing) return;
    drawing = true;
    requestAnimationFrame(frame);
  }

  // Set the status line until another sound is played.
  function say(text) {
    said = { key: engine.key, text };
    bar();
  }

  function play(key) {
    choose(key, false);
    if (engine.key !== key) engine.begin(key);
    else engine.toggle();
  }

  // Play or pause; the first sound of the page if none is chosen.
  function start() {
    if (engine.key !== null) engine.toggle();
    else play(chosen || Object.keys(about)[0]);
  }

  function jump(view, event) {
    const key = view.dataset.view || engine.key;
    if (key === null) return;
    const box = view.getBoundingClientRect(), { slots } = engine;
    const at = about[key].duration * Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    if (view.dataset.view) choose(key, false);
    const slot = slots[engine.active] === key ? engine.active : Object.keys(slots).find((one) => slots[one] === key);
    if (slot) engine.hear(slot);
    if (!slot || !engine.playing) engine.begin(key, at);
    else engine.seek(at);
  }

  function show(button) {
    const label = button.dataset.show;
    each("[data-show]", (other) => press(other, other === button));
    each(".recordings .card", (card) => { card.hidden = label !== "*" && !card.dataset.labelled.split(" ").includes(label); });
  }

  // Choose the previous or next sound; playback continues with it.
  function step(by) {
    const seen = cards.filter((card) => !card.hidden);
    if (!seen.length) return;
    const at = seen.findIndex((card) => card.dataset.card === chosen);
    const key = seen[at < 0 ? (by > 0 ? 0 : seen.length - 1) : Math.min(seen.length - 1, Math.max(0, at + by))].dataset.card;
    choose(key, true);
    if (engine.playing) engine.begin(key);
    else { engine.put(engine.active, key); engine.seek(0); }
  }

  document.addEventListener("click", (event) => {
    const button = event.target.closest("button"), view = event.target.closest(".view:not(.still)");
    const { play: key, put, of, slot, show: label } = button ? button.dataset : {};
    const acts = { toggle: start, loop: () => engine.loop(), help: () => $("keys").showModal() };
    if (key) play(key);
    else if (put) { choose(of, false); engine.put(put, of); }
    else if (slot) engine.hear(slot);
    else if (label !== undefined) show(button);
    else if (button && acts[button.id]) acts[button.id]();
    else if (view) jump(view, event);
  });
  if (!mini) return { say() {} }; // page without sounds
  // Keep the focus after a click, so that the space bar still plays and pauses.
  document.addEventListener("mousedown", (event) => { if (event.target.closest("button, .seek")) event.preventDefault(); });

  // Focused buttons handle space and enter themselves.
  const keys = {
    " ": start, a: () => engine.hear("a"), b: () => engine.hear("b"), x: () => engine.hear(engine.active === "a" ? "b" : "a"),
    l: () => engine.loop(), Home: () => engine.seek(0),
    ArrowUp: () => step(-1), ArrowDown: () => step(1), "?": () => $("keys").showModal(),
    ArrowLeft: (by) => engine.seek(engine.now() - by), ArrowRight: (by) => engine.seek(engine.now() + by),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if ($("keys").open) {
      if (key !== "?") return;
      $("keys").close();
    } else if (event.target.closest("button, a, summary, input, select, textarea") && (key === " " || event.target.matches("select, input"))) return;
    else if (event.shiftKey && (key === "a" || key === "b")) { if (chosen) engine.put(key, chosen); }
    else if (keys[key]) keys[key](event.shiftKey ? 0.1 : 1);
    else return;
    event.preventDefault();
  });
  engine.addEventListener("change", update);
  update();
  return { choose, say };
})();
