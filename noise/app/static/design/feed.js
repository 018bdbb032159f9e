// Beside the page: fetches blocks of sound as the audio thread asks for them, with the design where it has changed.
const HEADER = 24, HEADROOM = 1.12; // bytes; peaks between two samples are higher
const STEPS = [1, 2, 5, 10];

const AT_ONCE = 2, MOST = 8; // requests on their way; blocks in one of them, where the machine is busy

let address = "", run = 0, design = null, serial = 0, sent = -1, port = null, fullScale = 0.1, next = 0;
let onTheWay = 0, begun = false;
const wanted = []; // sequences, in a row
const early = new Map(); // blocks that came before those before them

self.onmessage = ({ data }) => {
  if (data.start) ({ address, run, fullScale } = data.start);
  if (data.design) ({ design, serial } = data.design);
  if (data.fullScale) fullScale = data.fullScale;
  if (data.port) {
    port = data.port;
    port.onmessage = ({ data: sequence }) => { wanted.push(sequence); more(); };
  }
};

// Several requests are on their way at once, the first alone; the server answers them in their order.
function more() {
  while (wanted.length && onTheWay < (begun ? AT_ONCE : 1)) {
    const some = wanted.splice(0, begun ? MOST : 1);
    onTheWay++;
    fetched(some[0], some.length).then(() => { begun = true; onTheWay--; more(); });
  }
}

async function fetched(sequence, count) {
  for (let tries = 0; tries < 3; tries++) {
    const mine = serial, body = { run, sequence, count, serial: mine };
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
      early.set(sequence, { bytes: await answer.arrayBuffer(), count });
      for (let found; (found = early.get(next)); next += found.count) {
        early.delete(next);
        for (let at = 0; at < found.bytes.byteLength;) at = pass(found.bytes, at);
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

// Hand a block on, and return where the next one begins.
function pass(bytes, at) {
  const [sequence, of, n, m] = new Uint32Array(bytes, at, 4), [took, speed] = new Float32Array(bytes, at + 16, 2);
  const end = at + HEADER + 4 * (n + m);
  const pressure = new Float32Array(bytes, at + HEADER, n).slice(), torque = new Float32Array(bytes, at + HEADER + 4 * n, m).slice();
  let peak = 0;
  for (const one of pressure) peak = Math.max(peak, Math.abs(one));
  if (HEADROOM * peak > fullScale) {
    const ten = 10 ** Math.floor(Math.log10(HEADROOM * peak));
    fullScale = Number(STEPS.map((one) => one * ten).find((one) => one >= HEADROOM * peak * 0.9999).toPrecision(1));
  }
  self.postMessage({ block: { sequence, serial: of, pressure, torque, took, speed, peak, fullScale } });
  port?.postMessage({ sequence, serial: of, pressure, gain: 1 / fullScale }, [pressure.buffer]);
  return end;
}
