// From linear radiance to the screen: the tone curve of psf's PNG pictures, and errors in false
// colour.
'use strict';

// Linear up to a shoulder, above it an exponential that reaches 1 at infinity.
function toneMap(linear) {
  const shoulder = 0.7;
  if (!(linear > 0)) return 0;
  if (linear < shoulder) return linear;
  return 1 - (1 - shoulder) * Math.exp(-(linear - shoulder) / (1 - shoulder));
}

// IEC 61966-2-1.
function srgbFromLinear(linear) {
  const x = Math.min(1, Math.max(0, linear));
  return x <= 0.0031308 ? 12.92 * x : 1.055 * Math.pow(x, 1 / 2.4) - 0.055;
}

// The byte that shows each of the 65,536 half floats, by exposure in stops.
const toneTables = new Map();
function toneTable(exposure) {
  if (!toneTables.has(exposure)) {
    if (toneTables.size > 64) toneTables.clear();
    const scale = 2 ** exposure;
    toneTables.set(
        exposure,
        Uint8Array.from(
            halfValues, (value) => Math.round(255 * srgbFromLinear(toneMap(value * scale)))));
  }
  return toneTables.get(exposure);
}

function imageOfColors(decoded, exposure) {
  const {width, height, halves} = decoded, plane = width * height, table = toneTable(exposure);
  const image = new ImageData(width, height);
  for (let at = 0; at < plane; ++at) {
    for (let k = 0; k < 3; ++k) image.data[4 * at + k] = table[halves[k * plane + at]];
    image.data[4 * at + 3] = 255;
  }
  return image;
}

const kErrorRange = [1e-4, 10];  // of relative squared errors, in false colour
const kFalseColors = ['#000004', '#2c115f', '#721f81', '#b73779', '#f1605d', '#feb078', '#fcfdbf'];
const falseRamp =
    d3.scale.linear()
        .domain(d3.range(kFalseColors.length).map((k) => k / (kFalseColors.length - 1)))
        .range(kFalseColors)
        .clamp(true);

const falseTable = d3.range(256).map((k) => {
  const color = d3.rgb(falseRamp(k / 255));
  return [color.r, color.g, color.b];
});

// Mean over R, G, B of (x - r)^2 / (r^2 + epsilon).
function relativeError(value, reference, epsilon) {
  return d3.mean(value.map((x, k) => (x - reference[k]) ** 2 / (reference[k] ** 2 + epsilon)));
}

function imageOfErrors(decoded, reference, epsilon) {
  const {width, height, halves} = decoded, plane = width * height,
                        image = new ImageData(width, height);
  const low = Math.log(kErrorRange[0]), range = Math.log(kErrorRange[1]) - low;
  for (let at = 0; at < plane; ++at) {
    let sum = 0;
    for (let k = 0; k < 3; ++k) {
      const r = halfValues[reference.halves[k * plane + at]],
            d = halfValues[halves[k * plane + at]] - r;
      sum += d * d / (r * r + epsilon);
    }
    const t = (Math.log(sum / 3) - low) / range;
    const color = falseTable[Number.isNaN(t) ? 255 : Math.round(255 * Math.min(1, Math.max(0, t)))];
    image.data.set(color, 4 * at);
    image.data[4 * at + 3] = 255;
  }
  return image;
}

// An ImageData as a canvas, which can be drawn at any scale.
function canvasOf(image) {
  const canvas = make('canvas', {width: image.width, height: image.height});
  canvas.getContext('2d').putImageData(image, 0, 0);
  return canvas;
}
