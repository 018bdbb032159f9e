// Both designs outlive a reload, for as long as the tab and the program go on.
const NAME = "bushing-noise design";

export function keep(session, state) {
  try {
    sessionStorage.setItem(NAME, JSON.stringify({ session, state }));
  } catch { /* the browser keeps nothing: then a reload begins anew */ }
}

// What was kept of this session, undefined where nothing was.
export function kept(session) {
  try {
    const found = JSON.parse(sessionStorage.getItem(NAME));
    return found.session === session ? found.state : undefined;
  } catch { return undefined; }
}
