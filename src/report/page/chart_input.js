// Points of a plot read by pointer and by arrow keys.
'use strict';

function listenToChart(svg, area, series, x, y, options) {
  const points = [];
  series.forEach((one, k) => one.points.forEach((point) => {
    if (!isNumber(point.y) || (options.y.log && point.y <= 0) || !(point.x > 0)) return;
    points.push({one, k, point, x: x(point.x), y: y(point.y)});
  }));
  const mark = area.append('circle').attr('class', 'mark').attr('r', 6).style('display', 'none');
  let current = -1;

  function leave() {
    mark.style('display', 'none');
    area.classed('reading', false).selectAll('.read').classed('read', false);
    tooltip.hide();
  }

  function show(found) {
    current = points.indexOf(found);
    mark.style('display', null)
        .attr('cx', found.x)
        .attr('cy', found.y)
        .attr('style', `stroke:var(--series-${found.one.color})`);
    area.classed('reading', true)
        .selectAll('[data-series]')
        .classed('read', function() { return this.dataset.series === found.one.id; });
    const box = svg.node().getBoundingClientRect();
    tooltip.show(
        [found.one.name, ...found.point.lines], box.left + kMargin.left + found.x,
        box.top + kMargin.top + found.y);
  }

  function nearest(px, py, among) {
    let best = null, bestDistance = Infinity;
    for (const candidate of among) {
      const distance = Math.hypot(candidate.x - px, candidate.y - py);
      if (distance < bestDistance) [best, bestDistance] = [candidate, distance];
    }
    return best;
  }

  const node = svg.node();
  node.addEventListener('pointermove', (event) => {
    const box = node.getBoundingClientRect();
    const px = event.clientX - box.left - kMargin.left, py = event.clientY - box.top - kMargin.top;
    const found = nearest(px, py, points);
    if (found && Math.hypot(found.x - px, found.y - py) < 40)
      show(found);
    else
      leave();
  });
  node.addEventListener('pointerleave', leave);
  node.addEventListener('blur', leave);
  node.addEventListener('keydown', (event) => {
    if (!event.key.startsWith('Arrow') || points.length === 0) return;
    event.preventDefault();
    if (current < 0) return show(points[0]);
    const from = points[current];
    const line = (k) => points.filter((candidate) => candidate.k === k);
    const mine = line(from.k), place = mine.indexOf(from);
    if (event.key === 'ArrowLeft') return show(mine[Math.max(0, place - 1)]);
    if (event.key === 'ArrowRight') return show(mine[Math.min(mine.length - 1, place + 1)]);
    const step = event.key === 'ArrowDown' ? 1 : -1;
    for (let k = from.k + step; k >= 0 && k < series.length; k += step) {
      if (line(k).length) return show(nearest(from.x, from.y, line(k)));
    }
  });
}
