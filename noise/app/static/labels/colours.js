// Colours of levels: the same on every spectrogram of the program, dark on light.

const ANCHORS = "ffffff fde0a1 fec287 fea571 fb8761 f4695c e55064 cf4070 b5367a 9b2e7f 812581 681c81 4f127b 341069 1c1044 090720 000004".split(" ")
  .map((hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)));

// Colour of each step of a level in bytes, as words of a picture.
export function palette(floor, step, top, range) {
  const words = new Uint32Array(256);
  for (let byte = 0; byte < 256; byte++) {
    const [red, green, blue] = colour((floor + byte * step - top + range) / range);
    words[byte] = 0xff000000 | (blue << 16) | (green << 8) | red; // as little-endian machines have it
  }
  return words;
}

export function colour(share) {
  const at = Math.min(1, Math.max(0, share)) * (ANCHORS.length - 1);
  const low = Math.min(ANCHORS.length - 2, Math.floor(at));
  return ANCHORS[low].map((from, part) => Math.round(from + (at - low) * (ANCHORS[low + 1][part] - from)));
}
