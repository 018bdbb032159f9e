// Requests to the server, and the line that tells what happened.

// GET without a body, POST of JSON with one; an error is told and thrown.
export async function api(path, body) {
  const answer = await request(path, body);
  return answer.json();
}

export async function bytes(path, body) {
  const answer = await request(path, body);
  return answer.arrayBuffer();
}

async function request(path, body) {
  const how = body === undefined ? {} : { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) };
  let answer;
  try {
    answer = await fetch(`api/${path}`, how);
  } catch {
    told("The program does not answer any more; start it again by `bushing-noise open`.");
    throw new Error("no answer");
  }
  if (!answer.ok) {
    const said = await answer.text();
    let reason = said;
    try { reason = JSON.parse(said).error; } catch { /* plain text */ }
    told(reason);
    throw new Error(reason);
  }
  return answer;
}

export function told(text) {
  document.getElementById("status").textContent = text;
}
