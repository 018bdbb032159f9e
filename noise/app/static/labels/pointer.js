// Pointer on the lanes: readout, seek, selection and zoom.

const STILL = 4; // a press that moves less is a click [px]
const WHEEL = 0.0015; // of zoom for a pixel of the wheel

// Track a press until it ends, also outside of the node.
export function drag(node, { pointerId }, move, end) {
  node.setPointerCapture(pointerId);
  const over = new AbortController(), { signal } = over;
  const last = (event) => { over.abort(); end(event); };
  for (const [name, act] of Object.entries({ pointermove: move, pointerup: last, pointercancel: last })) node.addEventListener(name, act, { signal });
}

export function follow(page) {
  const { parts, timeline, spectrogram } = page;
  const at = ({ clientX }) => {
    const box = parts.area.getBoundingClientRect();
    return timeline.time((clientX - box.left) / box.width);
  };
  const height = ({ clientY }, node) => {
    const box = node.getBoundingClientRect();
    return Math.min(1, Math.max(0, (clientY - box.top) / box.height));
  };

  for (const lane of [parts.wave, parts.screen, parts.stack]) {
    lane.addEventListener("pointerdown", (event) => {
      if (event.button || !page.sound) return;
      const first = at(event);
      let moved = false;
      const move = (now) => {
        moved ||= Math.abs(now.clientX - event.clientX) > STILL;
        if (moved) timeline.select(first, at(now));
      };
      const end = (last) => {
        if (last.type === "pointercancel") timeline.select(null);
        else if (moved) page.seek(timeline.selection.start);
        else { if (timeline.selection) timeline.select(null); page.seek(first); }
      };
      drag(lane, event, move, end);
    });
  }
  parts.screen.addEventListener("pointermove", (event) => {
    if (page.sound && spectrogram.whole) spectrogram.read(at(event), spectrogram.frequency(height(event, parts.screen)));
  });
  parts.screen.addEventListener("pointerleave", () => spectrogram.read(null));

  parts.area.addEventListener("wheel", (event) => {
    if (!page.sound) return;
    event.preventDefault();
    if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) timeline.pan((event.deltaX || event.deltaY) / parts.area.clientWidth);
    else timeline.zoom(Math.exp(-WHEEL * event.deltaY), at(event));
  }, { passive: false });
}
