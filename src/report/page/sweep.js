// The section of a sweep: the best row, error maps, the table of all rows.
'use strict';

function sweepTip(row, study, names, base) {
  const metrics = metricsOf(study);
  const lines = [
    rowText(row, names),
    ...metrics.map((metric) => [metric.name, formatNumber(metricValue(row, metric))])
  ];
  const gain = formatGain(metricValue(row, metrics[0]), metricValue(base, metrics[0]));
  if (gain) lines.push(`${metrics[0].name} ${gain}`);
  lines.push(['neighbours', formatNumber(row.neighbors)]);
  if (row.radius) {
    lines.push([
      'radius',
      `${formatNumber(row.radius.first_px)} to ` +
          `${formatNumber(row.radius.last_px)} px`
    ]);
  }
  lines.push(['row', row.id]);
  return lines;
}

function sweepColumns(study, varying) {
  const columns = [{name: 'row', text: (row) => row.id, key: (row) => row.id}];
  for (const {name} of varying) {
    columns.push({
      name,
      text: (row) => shortValue(row.parameters[name] || kNothing),
      key: (row) => parameterOrder(row.parameters[name], varying, name),
      numeric: true
    });
  }
  for (const metric of metricsOf(study)) {
    columns.push(numberColumn(metric.name, (row) => metricValue(row, metric), metricText(metric)));
  }
  const orphans = numberColumn(
      'orphans', (row) => row.orphans, 'queries without a source in reach', formatCount);
  columns.push(
      numberColumn('neighbours', (row) => row.neighbors, 'mean of all records with a vertex'),
      numberColumn(
          'r first', (row) => row.radius && row.radius.first_px,
          'radius after the first block, pixels'),
      numberColumn(
          'r last', (row) => row.radius && row.radius.last_px,
          'radius after the last block, pixels'),
      ...(study.rows.some((row) => row.orphans > 0) ? [orphans] : []),
      numberColumn('seconds', (row) => row.seconds, 'of the traversal, which rows share'),
      numberColumn('shared by', (row) => row.shared, 'rows of the same traversal', formatCount));
  return columns;
}

function parameterOrder(value, varying, name) {
  const rank = varying.find((parameter) => parameter.name === name).values.indexOf(value);
  return rank < 0 ? null : rank;
}

// The axes to start with: r0 and delta where they vary, else the first that do.
function startAxes(varying) {
  const names = varying.map((parameter) => parameter.name);
  const x = names.includes('r0') ? 'r0' : names[0];
  const rest = names.filter((name) => name !== x);
  return {x, y: rest.includes('delta') ? 'delta' : rest[0] || ''};
}

function makeSweep(section, host, open) {
  const study = section.study, metrics = metricsOf(study);
  const parameters = parametersOf(study.rows);
  const varying = parameters.filter((parameter) => parameter.values.length > 1);
  const names = varying.map((parameter) => parameter.name);
  const maps = make('div', {class: 'heat-maps'}), summary = make('p', {class: 'summary'});
  const ramp = make('div'), controls = make('div', {class: 'controls'});
  const state = {metric: metrics[0], ...startAxes(varying.length ? varying : parameters)};
  const find = (name) => parameters.find((parameter) => parameter.name === name);

  function draw() {
    const {metric} = state, x = find(state.x), y = state.y ? find(state.y) : null;
    const best = bestOf(study.rows, metric);
    const base = metricValue(study.unfiltered, metric);
    const scale = goodness(study.rows.map((row) => metricValue(row, metric)), metric);
    const others = varying.filter((parameter) => parameter !== x && parameter !== y);
    summary.replaceChildren(...bestText(best, metric, base));
    ramp.replaceChildren(best ? makeRamp(metric, scale) : '');
    const options = {x, y, metric, scale, best, base, open};
    options.tip = (row) => sweepTip(row, study, names, study.unfiltered);
    const makeMap = ({label, rows}) =>
        makeHeatMap(others.length ? label : 'all rows', rows, options);
    maps.replaceChildren(...combinations(study.rows, others).map(makeMap));
  }

  function bestText(best, metric, base) {
    if (best === null) return [`No row has a value of ${metric.name}.`];
    const value = metricValue(best, metric);
    return [
      'The best by ', make('b', {}, metricText(metric)), ' is ',
      make('b', {}, rowText(best, names)), ': ', make('b', {}, formatNumber(value)),
      besideUnfiltered(value, base, metric), '.'
    ];
  }

  function drawControls() {
    const axis = (other) =>
        varying.filter((parameter) => parameter.name !== other)
            .map((parameter) => ({value: parameter.name, text: parameter.name}));
    const choices = [makeChoice('Metric', metricChoices(metrics), state.metric.name, (name) => {
      state.metric = metrics.find((metric) => metric.name === name);
      draw();
    })];
    if (varying.length > 2) {
      for (const [label, mine, other] of [['Across', 'x', 'y'], ['Up', 'y', 'x']]) {
        choices.push(makeChoice(label, axis(state[other]), state[mine], (name) => {
          state[mine] = name;
          drawControls();
          draw();
          controls.querySelector(`[data-axis="${mine}"]`).focus();
        }));
        choices[choices.length - 1].querySelector('select').dataset.axis = mine;
      }
    }
    controls.replaceChildren(...choices);
  }

  drawControls();
  draw();
  const constant = constantText(parameters);
  const first = metrics[0], winner = bestOf(study.rows, first);
  host.append(
      makeFacts(study), summary, make('h3', {}, 'Error maps'),
      make('div', {class: 'bar'}, controls, ramp), maps,
      make(
          'p', {class: 'note'},
          'The best of all has a star, the best of each map a ring; a corner marks what is ',
          'worse than unfiltered. Arrow keys move among the cells, Enter or a click shows the ',
          'picture.'),
      make('h3', {}, 'All rows'),
      make('p', {class: 'note'}, constant ? `The same in all: ${constant}.` : ''),
      makeTable(sweepColumns(study, varying), study.rows, {
        caption: `${formatCount(study.rows.length)} ${
            study.rows.length === 1 ? 'row' : 'rows'}; a heading sorts`,
        mark: (row) => row === winner ? 'best' : null,
      }));
}
