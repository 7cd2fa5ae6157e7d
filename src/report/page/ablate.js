// The section of an ablation: a table of errors for each part, its bars beside each other.
'use strict';

// What a part compares, as its heading.
const kAblationParts = {
  weights: 'Weights one after another',
  blocks: 'Blocks filtered apart',
  iterations: 'Iterations on one pass'
};

// "unfiltered, 16 passes": there is one for each number of passes.
function ablationLabel(row) {
  if (row.parameters) return row.label;
  return `${row.label}, ${formatCount(row.passes)} ${row.passes === 1 ? 'pass' : 'passes'}`;
}

// The unfiltered row of the same passes.
function ablationBase(study, row) {
  return study.rows.find((one) => !one.parameters && one.passes === row.passes) || null;
}

// A value and its share of the largest filtered one of its part; the unfiltered one may be beyond.
function makeBar(value, most) {
  const share = isNumber(value) && most > 0 ? Math.min(1, Math.max(0, value / most)) : 0;
  return make(
      'span', {class: 'bar-cell'},
      make('span', {class: 'bar-track', 'aria-hidden': 'true'}, make('span', {
             class: value > most ? 'bar-fill beyond' : 'bar-fill',
             style: `width:${(100 * share).toFixed(1)}%`
           })),
      make('span', {}, formatNumber(value)));
}

// "+0.06 %"
function formatChange(value) {
  if (!isNumber(value)) return kNothing;
  const text = Math.abs(100 * value).toFixed(2);
  const sign = Number(text) === 0 ? '' : value > 0 ? '+' : '\u2212';
  return `${sign}${text}\u202f%`;
}

function ablationColumns(study, rows, metric) {
  const value = (row) => metric ? metricValue(row, metric) : null;
  const most = d3.max(rows.filter((row) => row.parameters), value) || 0;
  const columns = [{name: 'picture', text: ablationLabel, key: (row) => row.id}];
  if (metric) {
    columns.push({
      name: metric.name,
      title: metricText(metric),
      text: (row) => makeBar(value(row), most),
      key: value
    });
  }
  if (metric && metric.lower) {
    const gain = (row) => row.parameters && value(row) > 0 ?
        metricValue(ablationBase(study, row), metric) / value(row) :
        null;
    columns.push(numberColumn('times less', gain, 'than the same passes unfiltered'));
  }
  columns.push(
      numberColumn('mean', (row) => row.mean, 'luminance of the picture'),
      numberColumn(
          'change', (row) => row.parameters ? row.change : null,
          'of the mean, against the same passes unfiltered', formatChange),
      numberColumn('neighbours', (row) => row.neighbors, 'mean of all records with a vertex'),
      numberColumn('seconds', (row) => row.seconds, 'of the filter'));
  return columns;
}

function makeAblation(section, host) {
  const study = section.study, metrics = metricsOf(study);
  const tables = make('div'), controls = make('div', {class: 'controls'});
  const parts = [...new Set(study.rows.map((row) => row.part))];

  function draw(metric) {
    tables.replaceChildren(...parts.flatMap((part) => {
      const rows = study.rows.filter((row) => row.part === part);
      const heading = kAblationParts[part] || part;
      const best = metric ? bestOf(rows, metric) : null;
      const table = makeTable(
          ablationColumns(study, rows, metric), rows,
          {caption: `${formatCount(rows.length)} pictures; a heading sorts`,
           mark: (row) => row === best ? 'best' : null});
      return [make('h3', {}, heading), table];
    }));
  }

  if (metrics.length > 0) {
    controls.append(makeChoice(
        'Metric', metricChoices(metrics), metrics[0].name,
        (name) => draw(metrics.find((metric) => metric.name === name))));
  }
  draw(metrics[0] || null);
  const constant = constantText(parametersOf(study.rows));
  host.append(
      makeFacts(study), make('div', {class: 'bar'}, controls), tables,
      make('p', {class: 'note'}, constant ? `The same in all: ${constant}.` : ''));
}
