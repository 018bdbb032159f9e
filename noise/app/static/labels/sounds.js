// Requests about one recording.
import { api, bytes } from "../api.js";

export const about = (id) => api(`sounds/${id}`);

export function asked(id, what, said) {
  const query = Object.entries(said).filter(([, value]) => value !== null && value !== undefined);
  return `sounds/${id}/${what}?${new URLSearchParams(query)}`;
}

export const facts = (id, what, said) => api(asked(id, what, said));

// Response of header length, JSON header and numbers.
export async function numbers(id, what, said, Kind) {
  const buffer = await bytes(asked(id, what, said));
  const length = new DataView(buffer).getUint32(0, true);
  const meaning = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  return { ...meaning, values: new Kind(buffer, 4 + length) };
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
