// Error maps: one table of coloured cells for each combination of the parameters off the axes.
'use strict';

// The combinations of `others`' values that occur: [{label, rows}].
function combinations(rows, others) {
  const found = new Map();
  for (const row of rows) {
    const key = JSON.stringify(others.map((other) => row.parameters[other.name]));
    if (!found.has(key)) {
      found.set(key, {label: rowText(row, others.map((other) => other.name)), rows: []});
    }
    found.get(key).rows.push(row);
  }
  return [...found.values()];
}

// Arrow keys move the focus among the cells; one of them is reached by Tab.
function roveCells(table) {
  const cells = [...table.querySelectorAll('td[tabindex]')];
  if (cells.length === 0) return;
  (cells.find((cell) => cell.classList.contains('best')) || cells[0]).tabIndex = 0;
  const steps = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
  table.addEventListener('keydown', (event) => {
    const step = steps[event.key], cell = event.target.closest('td');
    if (!step || !cell) return;
    event.preventDefault();
    const line =
        cell.parentElement.parentElement.rows[cell.parentElement.sectionRowIndex + step[1]];
    const next = line && line.cells[cell.cellIndex + step[0]];
    if (!next || !next.hasAttribute('tabindex')) return;
    cells.forEach((other) => other.tabIndex = -1);
    next.tabIndex = 0;
    next.focus();
  });
}

// options: {x, y: parameters, metric, scale, best, base, tip(row), open(row)}
function makeHeatMap(label, rows, options) {
  const {x, y, metric, scale} = options;
  const inHere = bestOf(rows, metric);
  const cellOf = (a, b) =>
      rows.find((row) => row.parameters[x.name] === a && (!y || row.parameters[y.name] === b));
  const makeCell = (row) => {
    const value = row ? metricValue(row, metric) : null;
    if (value === null) return make('td', {class: 'empty'}, row ? kNothing : '');
    const color = errorRamp(scale.map(value));
    const best = row === options.best;
    const worse =
        options.base !== null && (metric.lower ? value > options.base : value < options.base);
    const cell = make(
        'td', {
          tabindex: -1,
          class:
              [best ? 'best' : '', row === inHere ? 'local' : '', worse ? 'worse' : ''].join(' '),
          style: `background:${color};color:${inkOn(color)}`,
          'aria-label': `${rowText(row, [x.name, y ? y.name : ''])}: ${metric.name} ` +
              formatNumber(value) + (best ? ', the best of all' : ''),
          onclick: () => options.open(row),
          onkeydown: (event) => {
            if (event.key === 'Enter') options.open(row);
          },
        },
        formatNumber(value, 2));
    tooltip.attach(cell, () => options.tip(row));
    return cell;
  };
  const lines = y ? [...y.values].reverse() : [null];
  const table = make(
      'table', {class: 'heat'}, make('caption', {}, label),
      make(
          'tbody', {},
          lines.map(
              (b) => make(
                  'tr', {}, make('th', {scope: 'row'}, b === null ? '' : shortValue(b)),
                  x.values.map((a) => makeCell(cellOf(a, b)))))),
      make(
          'tfoot', {},
          make(
              'tr', {}, make('td', {}),
              x.values.map((a) => make('th', {scope: 'col'}, shortValue(a))))));
  roveCells(table);
  const axes =
      y ? `${axisName(y.name)} \u2191   ${axisName(x.name)} \u2192` : `${axisName(x.name)} \u2192`;
  return make('div', {class: 'heat-map'}, table, make('p', {class: 'axes'}, axes));
}

// What the colours mean.
function makeRamp(metric, scale) {
  const stops = d3.range(0, 1.01, 0.1).map((t) => errorRamp(t)).join(',');
  return make(
      'div', {
        class: 'ramp',
        role: 'img',
        'aria-label':
            `Colours from ${formatNumber(scale.best)}, the best, to ` + formatNumber(scale.worst)
      },
      make('span', {}, `best ${formatNumber(scale.best)}`),
      make('span', {class: 'ramp-bar', style: `background:linear-gradient(to right,${stops})`}),
      make('span', {}, `${formatNumber(scale.worst)} worst`));
}
