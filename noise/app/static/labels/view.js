// Recordings view: list and page of the open recording.
import { made, stylesheet } from "../dom.js";
import { mountList, openRecording } from "./list.js";
import { RecordingPage } from "./recording.js";

export function mount(panel) {
  for (const name of ["labels", "list"]) stylesheet(new URL(`./${name}.css`, import.meta.url));
  const list = made("div", { className: "beside" });
  const page = made("article", { className: "recording", hidden: true });
  const empty = made("p", { className: "empty", textContent: "Choose a recording of the list: hear it, then correct its labels." });
  panel.replaceChildren(made("div", { className: "labels-view" }, list, made("div", { className: "page" }, empty, page)));
  const open = async (id) => {
    page.hidden = false;
    empty.hidden = true;
    try { await recording.open(id); } catch (error) {
      if (id !== recording.id || recording.sound) throw error;
      recording.player.stop();
      page.hidden = true; // it shows another recording
      empty.hidden = false;
      empty.textContent = error.message;
    }
  };
  const recording = new RecordingPage(page, openRecording);
  mountList(list, { onOpen: open, onSeen: (seen) => recording.corrections.seen(seen) }).then(({ rows: [first], marked }) => {
    if (first && marked === null) openRecording(first.id);
  });
  addEventListener("beforeunload", (event) => { if (recording.corrections.working) event.preventDefault(); }); // not saved yet
  document.addEventListener("view-shown", ({ detail }) => { if (detail !== "labels" && recording.player.playing) recording.player.stop(); });
  return { recording };
}
