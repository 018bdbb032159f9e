// Page of the app: tabs and views. A view is mounted when it is first shown, and only the current view is in
// the page, so that a blind jury cannot read names in another.
import { api, told } from "./api.js";

const tabs = [...document.querySelectorAll("[role=tab]")];
const mounted = {};
const away = {}; // nodes and scroll positions by view
let shown = null;

const panelOf = (view) => document.getElementById(`view-${view}`);

function putAway(view) {
  const panel = panelOf(view);
  if (!panel.hasChildNodes()) return;
  const scrolled = [...panel.querySelectorAll("*")].filter((node) => node.scrollTop).map((node) => [node, node.scrollTop]);
  away[view] = { nodes: [...panel.childNodes], scrolled };
  panel.replaceChildren();
}

function bringBack(view) {
  if (!away[view]) return;
  const { nodes, scrolled } = away[view];
  delete away[view];
  panelOf(view).replaceChildren(...nodes);
  for (const [node, top] of scrolled) node.scrollTop = top;
}

async function show(name) {
  if (shown !== null && shown !== name) {
    putAway(shown);
    if (told.by !== "") told(""); // clear errors of another view, but not that the program does not answer
  }
  shown = name;
  for (const tab of tabs) {
    const chosen = tab.dataset.view === name;
    tab.setAttribute("aria-selected", chosen);
    tab.tabIndex = chosen ? 0 : -1;
    panelOf(tab.dataset.view).hidden = !chosen;
  }
  bringBack(name);
  history.replaceState(null, "", `${location.pathname}#${name}`);
  if (!mounted[name]) {
    mounted[name] = import(`./${name}/view.js`).then((view) => view.mount(panelOf(name)));
    mounted[name].catch((error) => told(`This view could not start: ${error.message}`, "view"));
  }
  const view = await mounted[name];
  if (shown !== name) { // another view was chosen meanwhile
    putAway(name);
    return view;
  }
  document.dispatchEvent(new CustomEvent("view-shown", { detail: name }));
  return view;
}

for (const [at, tab] of tabs.entries()) {
  tab.addEventListener("click", () => show(tab.dataset.view));
  tab.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const next = tabs[(at + step + tabs.length) % tabs.length];
    next.focus();
    show(next.dataset.view);
  });
}

document.getElementById("stop").addEventListener("click", async () => {
  if (!dispatchEvent(new Event("beforeunload", { cancelable: true }))) return told("Not stopped: a correction is still being saved.");
  await api("stop", {});
  document.body.replaceChildren(Object.assign(document.createElement("p"), { textContent: "Stopped. This window can be closed." }));
});

const asked = location.hash.slice(1);
show(tabs.some((tab) => tab.dataset.view === asked) ? asked : document.body.dataset.first);
