// What the page holds: the studies, their metrics, and the pictures by id.
'use strict';

const report = JSON.parse(document.getElementById('data').textContent);

// The metrics of a study as [{name, lower, settings}].
function metricsOf(study) {
  return study.metrics.map((metric) => ({
                             name: metric.name,
                             lower: metric.lower_is_better !== false,
                             settings: metric.settings || '',
                           }));
}

// null where there is none.
function metricValue(holder, metric) {
  const value = holder ? holder.metrics[metric.name] : null;
  return isNumber(value) ? value : null;
}

// The best of `holders` by a metric, null where none has a value.
function bestOf(holders, metric) {
  let best = null;
  for (const holder of holders) {
    const value = metricValue(holder, metric);
    if (value === null) continue;
    const leader = best === null ? null : metricValue(best, metric);
    if (leader === null || (metric.lower ? value < leader : value > leader)) best = holder;
  }
  return best;
}

// ", 8.1x less than unfiltered (0.24)"
function besideUnfiltered(value, base, metric) {
  if (base === null) return '';
  const gain = metric.lower ? formatGain(value, base) : '';
  return gain ? `, ${gain} (${formatNumber(base)})` : `; unfiltered ${formatNumber(base)}`;
}

// "relMSE (\u03b5 = 0.01)"
function metricText(metric) {
  return metric.settings ? `${metric.name} (${metric.settings.replace('epsilon ', '\u03b5 = ')})` :
                           metric.name;
}

function metricChoices(metrics) {
  return metrics.map((metric) => ({
                       value: metric.name,
                       text: metric.lower ? metric.name : `${metric.name}, more is better`
                     }));
}

// What was studied, as pairs of name and text.
function factsOf(study) {
  const inputs = study.inputs || [study.input];
  const first = inputs[0];
  const facts = [];
  const add = (name, value) => {
    if (value !== null && value !== undefined && value !== '') facts.push([name, String(value)]);
  };
  add('Scene', first.scene);
  add(inputs.length > 1 ? 'Dumps' : 'Dump',
      inputs.length > 1 ? `${first.file} and ${inputs.length - 1} more` : first.file);
  add('Camera', first.camera);
  if (isNumber(first.width)) add('Size', `${first.width} \u00d7 ${first.height}`);
  if (isNumber(first.passes)) add('Passes', formatCount(first.passes));
  if (isNumber(first.records)) add('Records', formatCount(first.records));
  add('Vertex', first.vertex);
  add('Integrator', first.integrator);
  add('Sampler', first.sampler);
  const seeds = inputs.map((input) => input.seed).filter((seed) => seed !== undefined);
  add(inputs.length > 1 ? 'Seeds' : 'Seed', seeds.join(', '));
  if (study.reference && study.reference.file) add('Reference', study.reference.file);
  add('Written by', `psf ${study.version}`);
  return facts;
}

function makeFacts(study) {
  return make(
      'dl', {class: 'facts'},
      factsOf(study).map(
          ([name, text]) => make('div', {}, make('dt', {}, name), make('dd', {}, text))));
}
