// Requests about one recording.
import { api, bytes } from "../api.js";

export const about = (id) => api(`sounds/${id}`);

function asked(id, what, said) {
  const query = Object.entries(said).filter(([, value]) => value !== null && value !== undefined);
  return `sounds/${id}/${what}?${new URLSearchParams(query)}`;
}

// Response of header length, JSON header and numbers.
export async function numbers(id, what, said, Kind) {
  const buffer = await bytes(asked(id, what, said));
  const length = new DataView(buffer).getUint32(0, true);
  const meaning = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  return { ...meaning, values: new Kind(buffer, 4 + length) };
}

// Levels of an interval in words.
export async function levelsOf(id, channel, from, to) {
  const { start, end, unit, level, level_a: weighted, level_af_max: most, third_octaves: octaves } = await api(asked(id, "bands", { channel, start: from, end: to }));
  const said = (value, what) => (value === null ? [] : [`${value.toFixed(1)} ${what}`]);
  const strongest = Object.entries(octaves).filter(([, value]) => value !== null).sort(([, one], [, two]) => two - one)[0];
  const weightedUnit = unit === "dBFS" ? "dBFS(A)" : "dB(A)";
  const words = [...said(level, unit), ...said(weighted, weightedUnit), ...said(most, `${weightedUnit} Fast maximum`)].join(", ");
  return `${start.toFixed(2)}–${end.toFixed(2)} s: ${words}${strongest ? `; strongest third octave ${strongest[0]} Hz, ${strongest[1].toFixed(1)} dB` : ""}`;
}

// Samples of a WAV file of floats.
export const samples = (id, said) => wav(asked(id, "audio", said));

export async function wav(path) {
  const buffer = await bytes(path);
  const view = new DataView(buffer);
  let at = 12;
  for (;;) {
    const name = view.getUint32(at), length = view.getUint32(at + 4, true);
    if (name === 0x64617461) return new Float32Array(buffer.slice(at + 8, at + 8 + length)); // "data"
    at += 8 + length + (length % 2);
  }
}
