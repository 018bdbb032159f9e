// Beside the page: fetches blocks of sound as the audio thread asks for them, with the design where it has changed.
const HEADER = 24, HEADROOM = 1.12; // bytes; peaks between two samples are higher
const STEPS = [1, 2, 5, 10];

let address = "", run = 0, design = null, serial = 0, sent = -1, port = null, fullScale = 0.1, next = 0, begun = null;
const early = new Map(); // blocks that came before those before them

self.onmessage = ({ data }) => {
  if (data.start) ({ address, run, fullScale } = data.start);
  if (data.design) ({ design, serial } = data.design);
  if (data.fullScale) fullScale = data.fullScale;
  if (data.port) {
    port = data.port;
    port.onmessage = ({ data: sequence }) => {
      if (sequence === 0) begun = fetched(0);
      else begun.then(() => fetched(sequence));
    };
  }
};

// Several are on their way at once; the server makes them in their order.
async function fetched(sequence) {
  for (let tries = 0; tries < 3; tries++) {
    const mine = serial, body = { run, sequence, serial: mine };
    if (mine !== sent) body.design = design;
    sent = mine;
    let answer;
    try {
      answer = await fetch(address, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
    } catch {
      self.postMessage({ ended: "The program does not answer any more; start it again by `bushing-noise open`." });
      return;
    }
    if (answer.ok) {
      early.set(sequence, await answer.arrayBuffer());
      for (; early.has(next); next++) {
        pass(early.get(next));
        early.delete(next);
      }
      return;
    }
    const said = await answer.text();
    let reason = said;
    try { reason = JSON.parse(said).error; } catch { /* plain text */ }
    self.postMessage({ refused: reason, serial: mine });
    if (sequence === 0 || !body.design) break; // there is no design to go on with
  }
  self.postMessage({ ended: "" });
}

function pass(bytes) {
  const [sequence, of, n, m] = new Uint32Array(bytes, 0, 4), [took, speed] = new Float32Array(bytes, 16, 2);
  const pressure = new Float32Array(bytes, HEADER, n), torque = new Float32Array(bytes, HEADER + 4 * n, m);
  let peak = 0;
  for (const one of pressure) peak = Math.max(peak, Math.abs(one));
  if (HEADROOM * peak > fullScale) {
    const ten = 10 ** Math.floor(Math.log10(HEADROOM * peak));
    fullScale = Number(STEPS.map((one) => one * ten).find((one) => one >= HEADROOM * peak * 0.9999).toPrecision(1));
  }
  self.postMessage({ block: { sequence, serial: of, pressure: pressure.slice(), torque: torque.slice(), took, speed, peak, fullScale } });
  port?.postMessage({ sequence, serial: of, pressure, gain: 1 / fullScale }, [bytes]);
}
