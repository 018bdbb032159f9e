// The page that the views stand in: tabs, requests, what is told. A view is mounted when it is first shown.
import { api, told } from "./api.js";

const tabs = [...document.querySelectorAll("[role=tab]")];
const mounted = {};

async function show(name) {
  for (const tab of tabs) {
    const chosen = tab.dataset.view === name;
    tab.setAttribute("aria-selected", chosen);
    tab.tabIndex = chosen ? 0 : -1;
    document.getElementById(`view-${tab.dataset.view}`).hidden = !chosen;
  }
  history.replaceState(null, "", `${location.pathname}${location.search}#${name}`);
  const panel = document.getElementById(`view-${name}`);
  if (!mounted[name]) {
    mounted[name] = import(`./${name}/view.js`).then((view) => view.mount(panel));
    mounted[name].catch((error) => told(`this view does not start: ${error.message}`));
  }
  const view = await mounted[name];
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
  await api("stop", {});
  document.body.replaceChildren(Object.assign(document.createElement("p"), { textContent: "Stopped. This window can be closed." }));
});

const asked = location.hash.slice(1);
show(tabs.some((tab) => tab.dataset.view === asked) ? asked : tabs[0].dataset.view);
