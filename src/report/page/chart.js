// A plot of lines over one or two logarithmic axes, in SVG by D3.
//
// series: [{id, name, color, dash, points: [{x, y, low, high, lines}]}], `lines` for the tip;
// guides: [{name, slope, points: [{x, y}]}], what theory expects, and its slope over all of them.
'use strict';

const kMargin = {
  left: 62,
  right: 18,
  top: 12,
  bottom: 44
};
let clipCount = 0;

function strokeOf(series) {
  return `stroke:var(--series-${series.color});stroke-dasharray:${series.dash || 'none'}`;
}

// The values that an axis must hold; on a logarithmic one those above 0.
function extentOf(values, logarithmic) {
  const [low, high] = d3.extent(values.filter((v) => isNumber(v) && (!logarithmic || v > 0)));
  if (low === undefined) return null;
  if (logarithmic) return low === high ? [low / 1.5, high * 1.5] : [low, high];
  return low === high ? [low - 0.5, high + 0.5] : [low, high];
}

function paddedExtent(extent, logarithmic) {
  const pad = 0.06, [low, high] = extent;
  if (!logarithmic) return [low - pad * (high - low), high + pad * (high - low)];
  const factor = Math.pow(high / low, pad);
  return [low / factor, high * factor];
}

// options: {title, x: {label, ticks or null}, y: {label, log}, series(), guides()}; series() gives
// those to show. Returns {element, draw}.
function makeChart(options) {
  const plot = make('div', {class: 'plot'});
  const empty = make('p', {class: 'note', hidden: true}, 'No values to show.');
  const element = make(
      'figure', {class: 'chart'},
      make(
          'figcaption', {}, make('b', {}, options.title),
          make('span', {class: 'note'}, options.note || ''), makeSaveButton(options.title, plot)),
      plot, empty);
  let width = 0;

  function draw() {
    if (width === 0) return;
    const series = options.series(), guides = options.guides ? options.guides() : [];
    const points = series.flatMap((line) => line.points);
    const xExtent = extentOf(points.map((point) => point.x), true);
    const yExtent = extentOf(points.map((point) => point.y), options.y.log);
    plot.replaceChildren();
    empty.hidden = xExtent !== null && yExtent !== null;
    if (!empty.hidden) return;
    const height = Math.round(Math.min(340, Math.max(230, 0.68 * width)));
    const inner = {
      width: width - kMargin.left - kMargin.right,
      height: height - kMargin.top - kMargin.bottom
    };
    const x = d3.scale.log().domain(paddedExtent(xExtent, true)).range([0, inner.width]);
    const y = (options.y.log ? d3.scale.log() : d3.scale.linear())
                  .domain(paddedExtent(yExtent, options.y.log))
                  .range([inner.height, 0]);
    const svg = d3.select(plot)
                    .append('svg')
                    .attr('width', width)
                    .attr('height', height)
                    .attr('role', 'application')
                    .attr('tabindex', 0)
                    .attr(
                        'aria-label',
                        `${options.title}: ${options.y.label} over ${options.x.label}, ` +
                            `${series.length} lines; arrow keys read the points`);
    const area = svg.append('g').attr('transform', `translate(${kMargin.left},${kMargin.top})`);
    drawAxes(area, x, y, inner, options);
    const clip = `clip-${++clipCount}`;
    area.append('clipPath')
        .attr('id', clip)
        .append('rect')
        .attr('width', inner.width)
        .attr('height', inner.height);
    const lines = area.append('g').attr('clip-path', `url(#${clip})`);
    series.forEach((one) => drawBand(lines, one, x, y));
    guides.forEach((guide) => drawGuide(lines, guide, x, y));
    series.forEach((one) => drawSeries(lines, one, x, y, options.y.log));
    guides.forEach((guide) => drawGuideName(lines, guide, x, y));
    listenToChart(svg, area, series, x, y, options);
  }

  onWidth(plot, (now) => {
    width = now;
    draw();
  });
  return {element, draw};
}

function drawAxes(area, x, y, inner, options) {
  const xTicks = options.x.ticks ?
      thinned(options.x.ticks.filter((t) => t >= x.domain()[0] && t <= x.domain()[1]), x, 34)
          .map((value) => ({value, label: formatCount(value)})) :
      logTicks(...x.domain());
  const yTicks = options.y.log ?
      logTicks(...y.domain()) :
      y.ticks(6).map((value) => ({value, label: y.tickFormat(6)(value)}));
  for (const tick of yTicks) {
    const at = Math.round(y(tick.value)) + 0.5;
    area.append('line').attr('class', 'grid').attr('x2', inner.width).attr('y1', at).attr('y2', at);
    area.append('text')
        .attr('class', 'tick')
        .attr('x', -8)
        .attr('y', at)
        .attr('dy', '0.32em')
        .attr('text-anchor', 'end')
        .text(tick.label);
  }
  for (const tick of xTicks) {
    const at = Math.round(x(tick.value)) + 0.5;
    area.append('line')
        .attr('class', 'grid')
        .attr('y2', inner.height)
        .attr('x1', at)
        .attr('x2', at);
    area.append('text')
        .attr('class', 'tick')
        .attr('x', at)
        .attr('y', inner.height + 17)
        .attr('text-anchor', 'middle')
        .text(tick.label);
  }
  area.append('rect')
      .attr('class', 'frame')
      .attr('width', inner.width)
      .attr('height', inner.height);
  area.append('text')
      .attr('class', 'axis-name')
      .attr('x', inner.width / 2)
      .attr('y', inner.height + 37)
      .attr('text-anchor', 'middle')
      .text(options.x.label);
  area.append('text')
      .attr('class', 'axis-name')
      .attr('text-anchor', 'middle')
      .attr('transform', `translate(-50,${inner.height / 2}) rotate(-90)`)
      .text(options.y.label);
}

// Leaves out ticks that are closer than `gap` pixels to the one before.
function thinned(ticks, scale, gap) {
  const kept = [];
  for (const tick of ticks) {
    if (!kept.length || scale(tick) - scale(kept[kept.length - 1]) >= gap) kept.push(tick);
  }
  return kept;
}

function drawSeries(area, series, x, y, logarithmic) {
  const shown = (point) => isNumber(point.y) && (!logarithmic || point.y > 0) && point.x > 0;
  const line = d3.svg.line().x((point) => x(point.x)).y((point) => y(point.y)).defined(shown);
  area.append('path')
      .attr('class', 'line')
      .attr('data-series', series.id)
      .attr('style', strokeOf(series))
      .attr('d', line(series.points));
  area.selectAll(null)
      .data(series.points.filter(shown))
      .enter()
      .append('circle')
      .attr('class', 'dot')
      .attr('data-series', series.id)
      .attr('r', 3)
      .attr('style', `fill:var(--series-${series.color})`)
      .attr('cx', (point) => x(point.x))
      .attr('cy', (point) => y(point.y));
}

// Below what a logarithmic axis shows a band ends at its edge.
function drawBand(area, series, x, y) {
  const known = series.points.filter(
      (point) => isNumber(point.low) && isNumber(point.high) && point.high > 0);
  if (known.length < 2) return;
  const at = (value) => y(Math.max(value, y.domain()[0]));
  const band = d3.svg.area()
                   .x((point) => x(point.x))
                   .y0((point) => at(point.low))
                   .y1((point) => at(point.high));
  area.append('path')
      .attr('class', 'band')
      .attr('data-series', series.id)
      .classed('chosen', series.chosen)
      .attr('style', `fill:var(--series-${series.color})`)
      .attr('d', band(known));
}

function drawGuide(area, guide, x, y) {
  const line = d3.svg.line().x((point) => x(point.x)).y((point) => y(point.y));
  area.append('path').attr('class', 'guide').attr('d', line(guide.points));
}

// After all lines, so that none crosses it out; where guides begin, since they end in one point.
function drawGuideName(area, guide, x, y) {
  const start = guide.points[0];
  const text = area.append('text')
                   .attr('class', 'guide-name')
                   .attr('x', x(start.x) + 6)
                   .attr('y', Math.max(14, y(start.y) - 5));
  text.append('tspan').text(`${guide.name} n`);
  text.append('tspan')
      .attr('dy', -4)
      .attr('font-size', 9)
      .text(String(Number(guide.slope.toFixed(2))).replace('-', '\u2212'));
}
