// Colours of errors, and ticks of logarithmic axes.
'use strict';

// From good to bad; the same in both themes, so that a map means the same.
const kErrorColors = ['#16344f', '#1f6079', '#3f9084', '#92b879', '#e6cf7d', '#e39a5a', '#c2563f'];
const errorRamp =
    d3.scale.linear()
        .domain(d3.range(kErrorColors.length).map((k) => k / (kErrorColors.length - 1)))
        .range(kErrorColors)
        .interpolate(d3.interpolateLab)
        .clamp(true);

// Maps values of a metric to [0, 1], 0 the best. Logarithmic where the metric is an error.
function goodness(values, metric) {
  const known = values.filter((value) => value !== null && (!metric.lower || value > 0));
  const [low, high] = known.length ? d3.extent(known) : [1, 1];
  const logarithmic = metric.lower;
  const scale = (logarithmic ? d3.scale.log() : d3.scale.linear())
                    .domain(low === high ? [low, logarithmic ? low * 2 : low + 1] : [low, high])
                    .range(metric.lower ? [0, 1] : [1, 0])
                    .clamp(true);
  const map = (value) => value <= 0 && logarithmic ? 0 : scale(value);
  return {map, best: metric.lower ? low : high, worst: metric.lower ? high : low};
}

// Black or white ink on a colour, whichever has more contrast: never less than 4.5.
function inkOn(color) { return d3.lab(color).l > 49.4 ? '#000000' : '#ffffff'; }

// Decades, with others between where there are few: [{value, label}].
function logTicks(low, high) {
  const decades = Math.log10(high / low);
  const steps = decades < 0.7 ? [1, 1.5, 2, 3, 4, 5, 6, 7, 8] :
      decades < 1.3           ? [1, 2, 3, 5, 7] :
      decades < 2.6           ? [1, 2, 5] :
                                [1];
  const every = Math.max(1, Math.ceil(decades / 7));
  const ticks = [];
  for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) {
    if (steps.length === 1 && e % every !== 0) continue;
    for (const step of steps) {
      const value = Number(`${step}e${e}`);
      if (value >= low * 0.999 && value <= high * 1.001)
        ticks.push({value, label: tickText(value)});
    }
  }
  return ticks;
}

const kSuperscripts = '\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079';

function tickText(value) {
  if (value >= 1e-3 && value < 1e5) return formatCount(Number(value.toPrecision(3)));
  const exponent = Math.floor(Math.log10(value) + 1e-9);
  const digit = Number((value / Math.pow(10, exponent)).toPrecision(2));
  const power = '10' + (exponent < 0 ? '\u207b' : '') +
      String(Math.abs(exponent)).replace(/\d/g, (d) => kSuperscripts[Number(d)]);
  return digit === 1 ? power : `${digit}\u00b7${power}`;
}
