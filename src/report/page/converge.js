// The section of a convergence study: error against n and time, bias and variance, n by n.
'use strict';

// Render, dump and filter together, of those that are known.
function pointSeconds(point) {
  const parts = point.seconds || {};
  const known = ['render', 'dump', 'filter'].map((name) => parts[name]).filter(isNumber);
  return known.length ? d3.sum(known) : null;
}

// What theory says of a quantity: the exponent that it comes to by delta, and the name of the local
// slopes that the study has for the n at hand.
function theoryOf(quantity, delta) {
  if (quantity === 'bias_sq') {
    return [
      {name: 'smooth', slope: -2 * delta, local: 'theory_bias_sq_smooth'},
      {name: 'edge', slope: -delta / 2, local: 'theory_bias_sq_edge'}
    ];
  }
  return [{name: '', slope: -(1 - delta), local: 'theory_variance'}];
}

// From a point to the next: as the study has it, else what it comes to.
function theorySlope(theory, point) {
  const local = point.slope ? point.slope[theory.local] : null;
  return isNumber(local) ? local : theory.slope;
}

function deltaOf(series) {
  const delta = series.parameters ? parseFloat(series.parameters.delta) : NaN;
  return Number.isFinite(delta) ? delta : null;
}

// A curve of given local slopes, slopeAt(k) from point k to the next, through the last point of a
// series, of which noise moves least; its slope is that over all of its points.
function guideThrough(points, slopeAt, name) {
  const known = points.map((point, k) => ({...point, k}))
                    .filter((point) => point.x > 0 && isNumber(point.y) && point.y > 0);
  if (known.length < 2) return [];
  const curve = [];
  for (let k = known.length - 1, y = known[k].y; k >= 0; --k) {
    if (k + 1 < known.length) y *= Math.pow(known[k].x / known[k + 1].x, slopeAt(known[k].k));
    curve.unshift({x: known[k].x, y});
  }
  const first = curve[0], last = curve[curve.length - 1];
  const slope = Math.log(last.y / first.y) / Math.log(last.x / first.x);
  return [{name, slope, points: curve}];
}

// How errors of pure noise fall with n; null where no power is expected.
function noiseSlope(metric) {
  return {relMSE: -1, MSE: -1, SMAPE: -0.5, MAPE: -0.5}[metric.name] || null;
}

function pointTip(series, point, metrics) {
  return [
    ['n', formatCount(point.n)],
    ...metrics.map((metric) => [metric.name, formatNumber(metricValue(point, metric))]),
    ['bias\u00b2', formatNumber(point.bias_sq)], ['variance', formatNumber(point.variance)],
    ['neighbours', formatNumber(point.neighbors)],
    ['radius', `${formatNumber(point.radius_px)} px`], ['time', formatSeconds(pointSeconds(point))]
  ];
}

function makeConverge(section, host) {
  const study = section.study, metrics = metricsOf(study), last = study.n.length - 1;
  const parameters = parametersOf(study.series);
  const varying = parameters.filter((parameter) => parameter.values.length > 1).map((p) => p.name);
  const series = study.series.map(
      (one) => ({...one, name: one.parameters ? rowText(one, varying) : 'unfiltered'}));
  const ends = series.filter((one) => one.parameters)
                   .map((one) => ({one, metrics: one.points[last].metrics}));
  const state = {metric: metrics[0], theory: null};
  const ranked = [...ends]
                     .sort((a, b) => {
                       const sign = state.metric.lower ? 1 : -1,
                             key = (end) => metricValue(end, state.metric);
                       return sign *
                           ((key(a) === null ? Infinity * sign : key(a)) -
                            (key(b) === null ? Infinity * sign : key(b)));
                     })
                     .map((end) => end.one);
  styleSeries(series, ranked);
  state.theory = ranked[0] || null;

  const lines = (x, y, band) =>
      series.filter((one) => one.shown)
          .map((one) => ({
                 ...one,
                 chosen: one === state.theory,
                 points: one.points.map((point, k) => ({
                                          x: x(point),
                                          y: y(point, one, k),
                                          low: band && point[band] ? point[band][0] : null,
                                          high: band && point[band] ? point[band][1] : null,
                                          lines: pointTip(one, point, metrics),
                                        })),
               }))
          .filter((one) => one.points.some((point) => isNumber(point.y)));
  const n = (point) => point.n, error = (point) => metricValue(point, state.metric);
  const noise = (x) => () => {
    const plain = series.find((one) => one.color === 0), slope = noiseSlope(state.metric);
    if (!plain || !plain.shown || slope === null) return [];
    return guideThrough(
        plain.points.map((point) => ({x: x(point), y: error(point)})), () => slope, '');
  };
  const parts = (quantity) => () => {
    const one = state.theory;
    if (!one || !one.shown || deltaOf(one) === null) return [];
    const points = one.points.map((point) => ({x: point.n, y: point[quantity]}));
    return theoryOf(quantity, deltaOf(one))
        .flatMap(
            (theory) => guideThrough(
                points, (k) => theorySlope(theory, one.points[k]), theory.name));
  };
  const overN = {label: 'passes n', ticks: study.n};
  const speedup = (key) => (point, one) => {
    const found = (study.speedups || []).find((s) => s.id === one.id && s.n === point.n);
    return found && isNumber(found[key]) ? found[key] : null;
  };
  const errorAxis = {
    get label() { return state.metric.name; },
    get log() { return state.metric.lower; }
  };
  const timed = series.some((one) => one.points.some((point) => pointSeconds(point) > 0));
  const apart = series.some((one) => one.points.some((point) => isNumber(point.bias_sq)));
  const charts = [
    {
      title: 'Error against n',
      x: overN,
      y: errorAxis,
      series: () => lines(n, error),
      guides: noise(n)
    },
    timed && {
      title: 'Error against time',
      note: timeNote(series),
      x: {label: 'seconds'},
      y: errorAxis,
      series: () => lines(pointSeconds, error),
      guides: noise(pointSeconds)
    },
    apart && {
      title: 'Bias\u00b2',
      note: 'as a part of relMSE',
      x: overN,
      y: {label: 'bias\u00b2', log: true},
      series: () => lines(n, (point) => point.bias_sq, 'bias_sq_ci'),
      guides: parts('bias_sq')
    },
    apart && {
      title: 'Variance',
      note: 'as a part of relMSE',
      x: overN,
      y: {label: 'variance', log: true},
      series: () => lines(n, (point) => point.variance, 'variance_ci'),
      guides: parts('variance')
    },
    {
      title: 'Neighbours M(n)',
      x: overN,
      y: {label: 'mean neighbours', log: true},
      series: () => lines(n, (point) => point.neighbors)
    },
    {
      title: 'Radius',
      x: overN,
      y: {label: 'radius, pixels', log: true},
      series: () => lines(n, (point) => point.radius_px)
    },
    ...['equal_time', 'equal_error'].map((key) => (study.speedups || []).length > 0 && {
      title: `Speed-up at ${key.replace('_', ' ')}`,
      x: overN,
      y: {label: `${key === 'equal_time' ? 'error' : 'time'}, unfiltered / filtered`, log: true},
      series: () => lines(n, speedup(key))
    }),
  ].filter(Boolean).map(makeChart);
  const redraw = () => charts.forEach((chart) => chart.draw());

  const summary = make('p', {class: 'summary'});
  const controls = make(
      'div', {class: 'controls'},
      makeChoice(
          'Metric', metricChoices(metrics), state.metric.name,
          (name) => {
            state.metric = metrics.find((metric) => metric.name === name);
            summarize();
            redraw();
          }),
      ranked.length === 0 ?
          null :
          makeChoice(
              'Theory for', ranked.map((one) => ({value: one.id, text: one.name})), state.theory.id,
              (id) => {
                state.theory = series.find((one) => one.id === id);
                redraw();
              }));

  function summarize() {
    const best = bestOf(ends, state.metric), plain = series.find((one) => one.color === 0);
    const base = plain ? metricValue(plain.points[last], state.metric) : null;
    if (!best) return summary.replaceChildren(`No series has a value of ${state.metric.name}.`);
    const value = metricValue(best, state.metric);
    summary.replaceChildren(
        `At n = ${formatCount(study.n[last])} the best by `,
        make('b', {}, metricText(state.metric)), ' is ', make('b', {}, best.one.name), ': ',
        make('b', {}, formatNumber(value)), besideUnfiltered(value, base, state.metric), '.');
  }

  summarize();
  const constant = constantText(parameters);
  host.append(
      makeFacts(study), makeVerdict(study.analytic, series), summary, controls,
      makeLegend(series, redraw),
      make('div', {class: 'charts'}, charts.map((chart) => chart.element)),
      make(
          'p', {class: 'note'}, 'Dotted lines are theory: n', make('sup', {}, '\u22121'),
          ' for noise alone; for the series chosen above ',
          'bias\u00b2 where the radiance is smooth and at an edge that no weight handles, ',
          'and variance while there are many neighbours. ',
          apart ? 'Bands are confidence intervals over the replicates. ' : '',
          constant ? `The same in all: ${constant}.` : ''),
      makeSlopes(study, series, metrics));
}

function timeNote(series) {
  const point = series[0].points[0], known = point.seconds || {};
  const names = ['render', 'dump', 'filter'].filter((name) => isNumber(known[name]));
  return names.length ? names.join(' + ') : '';
}

// The verdict of --analytic, and each slope that it looked at.
function makeVerdict(analytic, series) {
  if (!analytic) return '';
  const name = (id) => (series.find((one) => one.id === id) || {name: id}).name;
  const row = (slope) => make(
      'tr', {}, make('th', {scope: 'row'}, name(slope.id)),
      make('td', {}, slope.quantity.replace('_sq', '\u00b2')),
      make('td', {class: 'number'}, formatSlope(slope.measured)),
      make('td', {class: 'number'}, formatSlope(slope.theory)),
      make('td', {class: slope.passed ? 'good' : 'bad'}, slope.passed ? 'agrees' : 'differs'));
  const heads = ['series', 'quantity', 'slope', 'theory', ''];
  return make(
      'div', {class: analytic.passed ? 'verdict passed' : 'verdict failed'},
      make('b', {}, `The slopes ${analytic.passed ? '' : 'do not '}agree with theory.`),
      make(
          'table', {},
          make('thead', {}, make('tr', {}, heads.map((head) => make('th', {scope: 'col'}, head)))),
          make('tbody', {}, (analytic.slopes || []).map(row))));
}
