// Which lines are shown: one legend for all plots of a section.
'use strict';

const kSeriesColors = 8;  // --series-1 ... in the style; 0 is the unfiltered one's grey
const kDashes = ['', '7 4', '2 4', '10 4 2 4'];
const kShownAtFirst = 6;

// Gives each series its color and dash, and shows unfiltered and the best few.
function styleSeries(series, order) {
  let count = 0;
  for (const one of series) {
    const filtered = one.parameters !== null && one.parameters !== undefined;
    one.color = filtered ? 1 + count % kSeriesColors : 0;
    one.dash = filtered ? kDashes[Math.floor(count / kSeriesColors) % kDashes.length] : '';
    if (filtered) ++count;
    one.shown = !filtered || order.indexOf(one) < kShownAtFirst;
  }
}

function makeLegend(series, changed) {
  const buttons = series.map((one) => {
    const button = makeButton('', () => {
      one.shown = !one.shown;
      mark();
      changed();
    }, {class: 'legend-entry'});
    const svg = d3.select(button)
                    .append('svg')
                    .attr('width', 26)
                    .attr('height', 10)
                    .attr('aria-hidden', 'true');
    svg.append('line')
        .attr('class', 'line')
        .attr('x1', 1)
        .attr('x2', 25)
        .attr('y1', 5)
        .attr('y2', 5)
        .attr('style', strokeOf(one));
    button.append(one.name);
    return button;
  });
  const mark = () =>
      buttons.forEach((button, k) => button.setAttribute('aria-pressed', String(series[k].shown)));
  const all = (shown) => () => {
    series.forEach((one) => one.shown = shown || one.color === 0);
    mark();
    changed();
  };
  mark();
  return make(
      'div', {class: 'legend', role: 'group', 'aria-label': 'Lines to show'}, buttons,
      makeButton('all', all(true), {class: 'quiet'}),
      makeButton('none', all(false), {class: 'quiet'}));
}
