// Requests to the server, and the status line.

export const GONE = "The program does not answer any more; start it again by `bushing-noise open`.";
const ENDED = "The program that this page is of has ended; open the address that it prints now.";
// The token is stored per tab, not in address and history. The cookie belongs to the page opened last,
// which may be of another folder at the same port.
const TOKEN = new URLSearchParams(location.search).get("token") ?? sessionStorage.token ?? null;
if (TOKEN !== null) sessionStorage.token = TOKEN;
history.replaceState(null, "", `${location.pathname}${location.hash}`);

// GET without a body, POST of JSON with one; errors are thrown and shown by `tell`.
export async function api(path, body, tell = told) {
  const answer = await request(path, body, tell);
  return answer.json();
}

export async function bytes(path, body) {
  const answer = await request(path, body);
  return answer.arrayBuffer();
}

async function request(path, body, tell = told) {
  const headers = TOKEN === null ? {} : { "Page-Token": TOKEN };
  const how = body === undefined ? { headers } : { method: "POST", headers: { ...headers, "Content-Type": "application/json" }, body: JSON.stringify(body) };
  const kind = path.replace(/\?.*|\d+/g, "");
  let answer;
  try {
    answer = await fetch(`api/${path}`, how);
  } catch {
    tell(GONE, "");
    throw new Error(GONE);
  }
  if (!answer.ok) {
    const said = await answer.text();
    let reason;
    try { reason = JSON.parse(said).error; } catch { reason = answer.status === 403 ? ENDED : said; }
    tell(reason, kind);
    throw new Error(reason);
  }
  if (told.by === kind || !told.by) told("");
  return answer;
}

// An error is cleared when the same kind of request succeeds, a hint (kind null) or that the program does not
// answer (kind "") by the next success.
export function told(text, by = null) {
  told.by = by;
  document.getElementById("status").textContent = text;
}
