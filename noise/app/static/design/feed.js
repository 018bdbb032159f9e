// Worker that passes the stream of blocks to the audio thread, and changes to the program.
const HEADER = 20, HEADROOM = 1.12; // bytes; peaks between two samples are higher
const STEPS = [1, 2, 5, 10];
const REFUSED = 0xFFFFFFFF; // sequence number of a refusal, followed by its reason

let address = "", run = 0, port = null, fullScale = 0.1, waiting = null, telling = false;

self.onmessage = ({ data }) => {
  if (data.fullScale) fullScale = data.fullScale;
  if (data.start) {
    ({ address, run, fullScale } = data.start);
    port = data.port;
    listen(data.design);
  } else if (data.design) {
    waiting = data.design;
    if (!telling) tell();
  }
};

const post = (what, said) => fetch(address + what, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(said) });

const refused = (reason, serial) => self.postMessage({ refused: reason, serial });

// Send changes one after the other; only the newest waiting change is sent.
async function tell() {
  telling = true;
  while (waiting) {
    const mine = waiting;
    waiting = null;
    const answer = await post("change", { run, ...mine }).catch(() => null); // the stream ends as well
    if (answer && !answer.ok) refused(await reason(answer), mine.serial);
  }
  telling = false;
}

async function reason(answer) {
  const said = await answer.text();
  try { return JSON.parse(said).error; } catch { return said; }
}

async function listen(design) {
  try {
    const answer = await post("sound", { run, ...design });
    if (!answer.ok) {
      refused(await reason(answer), design.serial);
      self.postMessage({ ended: "" });
      return;
    }
    const reader = answer.body.getReader();
    let rest = new Uint8Array(0);
    for (let more; !(more = await reader.read()).done;) {
      rest = joined(rest, more.value);
      for (let size; (size = sizeOf(rest)) && rest.length >= size; rest = rest.slice(size)) pass(rest.slice(0, size).buffer);
    }
    self.postMessage({ ended: "" }); // it was refused
  } catch {
    self.postMessage({ ended: "The program does not answer any more; start it again by `bushing-noise open`." });
  }
}

function joined(first, second) {
  const both = new Uint8Array(first.length + second.length);
  both.set(first);
  both.set(second, first.length);
  return both;
}

// Size of the first message [byte], 0 if incomplete.
function sizeOf(bytes) {
  if (bytes.length < HEADER) return 0;
  const [sequence, , n, m] = new Uint32Array(bytes.slice(0, HEADER).buffer, 0, 4);
  return HEADER + (sequence === REFUSED ? n : 4 * (n + m));
}

function pass(bytes) {
  const [sequence, serial, n, m] = new Uint32Array(bytes, 0, 4), [speed] = new Float32Array(bytes, 16, 1);
  if (sequence === REFUSED) {
    refused(new TextDecoder().decode(new Uint8Array(bytes, HEADER, n)), serial);
    return;
  }
  const pressure = new Float32Array(bytes, HEADER, n).slice(), torque = new Float32Array(bytes, HEADER + 4 * n, m).slice();
  let peak = 0;
  for (const one of pressure) peak = Math.max(peak, Math.abs(one));
  if (HEADROOM * peak > fullScale) {
    const ten = 10 ** Math.floor(Math.log10(HEADROOM * peak));
    fullScale = Number(STEPS.map((one) => one * ten).find((one) => one >= HEADROOM * peak * 0.9999).toPrecision(1));
  }
  self.postMessage({ block: { sequence, serial, pressure, torque, speed, fullScale } });
  port.postMessage({ sequence, serial, pressure, gain: 1 / fullScale }, [pressure.buffer]);
}
