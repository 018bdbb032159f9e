// Requests to the server, and the line that tells what happened.

export const GONE = "The program does not answer any more; start it again by `bushing-noise open`.";

// GET without a body, POST of JSON with one; an error is thrown, and told unless the caller does that.
export async function api(path, body, tell = told) {
  const answer = await request(path, body, tell);
  return answer.json();
}

export async function bytes(path, body) {
  const answer = await request(path, body);
  return answer.arrayBuffer();
}

async function request(path, body, tell = told) {
  const how = body === undefined ? {} : { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) };
  let answer;
  try {
    answer = await fetch(`api/${path}`, how);
  } catch {
    tell(GONE);
    throw new Error(GONE);
  }
  if (!answer.ok) {
    const said = await answer.text();
    let reason = said;
    try { reason = JSON.parse(said).error; } catch { /* plain text */ }
    tell(reason);
    throw new Error(reason);
  }
  return answer;
}

export function told(text) {
  document.getElementById("status").textContent = text;
}
