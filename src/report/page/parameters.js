// Parameters of rows: which of them vary, their order, and short names for rows.
'use strict';

// A key to sort values by: numbers with units, powers, then words.
function parameterKey(text) {
  const power = /^(\d+)\^(\d+)$/.exec(text);
  if (power) return Math.pow(Number(power[1]), Number(power[2]));
  const fraction = /^(\d+)\/(\d+)$/.exec(text);
  if (fraction) return Number(fraction[1]) / Number(fraction[2]);
  const number = parseFloat(text);
  return Number.isNaN(number) ? Infinity : number;
}

function compareParameters(a, b) {
  const x = parameterKey(a), y = parameterKey(b);
  if (x !== y) return x < y ? -1 : 1;
  return a < b ? -1 : a > b ? 1 : 0;
}

// [{name, values: sorted texts}] of all that any row has, in the order of the first row.
function parametersOf(rows) {
  const values = new Map();
  for (const row of rows) {
    for (const [name, value] of Object.entries(row.parameters || {})) {
      if (!values.has(name)) values.set(name, new Set());
      values.get(name).add(value);
    }
  }
  return [...values].map(([name, set]) => ({name, values: [...set].sort(compareParameters)}));
}

// 0.333333 as 0.333, everything else as it is.
function shortValue(text) {
  return /^-?\d+\.\d{4,}$/.test(text) ? String(Number(Number(text).toPrecision(3))) : text;
}

function parameterText(name, value) {
  const shown = shortValue(value);
  if (name === 'r0') return `r\u2080 ${shown}`;
  if (name === 'delta') return `\u03b4 ${shown}`;
  return `${name} ${shown}`;
}

// "r0 8px, delta 0.333": the parameters of `names` that the row has.
function rowText(row, names) {
  if (row.parameters === null || row.parameters === undefined) return 'unfiltered';
  const parts = names.filter((name) => row.parameters[name] !== undefined)
                    .map((name) => parameterText(name, row.parameters[name]));
  return parts.join(' \u00b7 ') || row.id;
}

function axisName(name) {
  return name === 'r0' ? 'radius r\u2080' : name === 'delta' ? 'schedule \u03b4' : name;
}

// What is the same in all rows, as one line.
function constantText(parameters) {
  return parameters.filter((parameter) => parameter.values.length === 1)
      .map((parameter) => parameterText(parameter.name, parameter.values[0]))
      .join(' \u00b7 ');
}
