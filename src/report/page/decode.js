// Pictures back from the page's text: half floats as 16-bit patterns.
'use strict';

// Values of all 65,536 half floats.
const halfValues = (() => {
  const values = new Float32Array(65536);
  for (let bits = 0; bits < 65536; ++bits) {
    const sign = bits & 0x8000 ? -1 : 1, exponent = (bits >> 10) & 31, mantissa = bits & 1023;
    if (exponent === 31) {
      values[bits] = mantissa ? NaN : sign * Infinity;
    } else if (exponent === 0) {
      values[bits] = sign * mantissa * 2 ** -24;
    } else {
      values[bits] = sign * (1 + mantissa / 1024) * 2 ** (exponent - 15);
    }
  }
  return values;
})();

async function inflated(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; ++k) bytes[k] = text.charCodeAt(k);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Three planes; each value is stored as the difference to its left neighbour, in the first column
// to the one above; all low bytes come before all high bytes.
function unpredicted(bytes, width, height) {
  const plane = width * height, count = 3 * plane, halves = new Uint16Array(count);
  for (let at = 0; at < count; ++at) {
    const pixel = at % plane, difference = bytes[at] | (bytes[count + at] << 8);
    const before = pixel === 0 ? 0 : pixel % width === 0 ? halves[at - width] : halves[at - 1];
    halves[at] = before + difference;
  }
  return halves;
}

const decodedPictures = new Map();  // of a payload

// {width, height, halves}: planes R, G, B of 16-bit patterns. Decoded once.
function decodePicture(picture) {
  if (!decodedPictures.has(picture.payload)) {
    const text = document.getElementById(`payload-${picture.payload}`).textContent;
    decodedPictures.set(
        picture.payload,
        inflated(text).then((bytes) => ({
                              width: picture.width,
                              height: picture.height,
                              halves: unpredicted(bytes, picture.width, picture.height),
                            })));
  }
  return decodedPictures.get(picture.payload);
}

// Linear R, G, B of a pixel.
function pixelOf(decoded, x, y) {
  const plane = decoded.width * decoded.height, at = y * decoded.width + x;
  return [0, 1, 2].map((k) => halfValues[decoded.halves[k * plane + at]]);
}
