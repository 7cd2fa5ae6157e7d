// Tables of a convergence study: local slopes beside theory, and every point.
'use strict';

function makeSlopes(study, series, metrics) {
  const points = series.flatMap(
      (one) => one.points.map((point, k) => ({one, point, next: one.points[k + 1]})));
  const inSeries = {
    name: 'series',
    text: (row) => row.one.name,
    key: (row) => series.indexOf(row.one)
  };
  const delta = (row) => deltaOf(row.one);
  const slope = (name) => (row) => row.point.slope ? row.point.slope[name] : null;
  const theory = (quantity, which) => (row) => delta(row) === null ?
      null :
      theorySlope(theoryOf(quantity, delta(row))[which], row.point);
  const slopes = makeTable(
      [
        inSeries,
        numberColumn('from n', (row) => row.point.n, '', formatCount),
        numberColumn('to n', (row) => row.next.n, '', formatCount),
        numberColumn(
            metrics[0].name, slope(metrics[0].name), 'slope of the whole error', formatSlope),
        numberColumn('bias\u00b2', slope('bias_sq'), 'slope of the squared bias', formatSlope),
        numberColumn(
            'smooth', theory('bias_sq', 0),
            'theory of bias\u00b2, smooth radiance; comes to \u22122\u03b4',
            formatSlope),
        numberColumn(
            'edge', theory('bias_sq', 1), 'theory of bias\u00b2 at an edge; comes to \u2212\u03b4/2',
            formatSlope),
        numberColumn('variance', slope('variance'), 'slope of the variance', formatSlope),
        numberColumn(
            'theory', (row) => delta(row) === null ? -1 : theory('variance', 0)(row),
            'theory of variance with many neighbours; comes to \u2212(1 \u2212 \u03b4)',
            formatSlope),
        numberColumn('M(n)', (row) => row.point.neighbors, 'mean neighbours'),
        numberColumn('radius px', (row) => row.point.radius_px, ''),
      ],
      points.filter((row) => row.next), {caption: 'Local slopes, beside theory', mark: () => null});
  const seconds = (name) => (row) => row.point.seconds ? row.point.seconds[name] : null;
  const all = makeTable(
      [
        inSeries,
        numberColumn('n', (row) => row.point.n, 'passes', formatCount),
        ...metrics.map(
            (metric) => numberColumn(
                metric.name, (row) => metricValue(row.point, metric), metricText(metric))),
        numberColumn('bias\u00b2', (row) => row.point.bias_sq, 'as a part of relMSE'),
        numberColumn('variance', (row) => row.point.variance, 'as a part of relMSE'),
        numberColumn('render s', seconds('render'), ''),
        numberColumn('dump s', seconds('dump'), ''),
        numberColumn('filter s', seconds('filter'), ''),
      ],
      points, {caption: `${formatCount(points.length)} points; a heading sorts`, mark: () => null});
  return make(
      'div', {}, make('details', {}, make('summary', {}, 'Local slopes beside theory'), slopes),
      make('details', {}, make('summary', {}, 'All points'), all));
}
