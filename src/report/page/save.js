// Plots as SVG files that stand alone, for papers.
'use strict';

const kSavedStyles = [
  'fill', 'stroke', 'stroke-width', 'stroke-dasharray', 'stroke-linejoin', 'stroke-linecap',
  'opacity', 'font-family', 'font-size', 'paint-order', 'display'
];

// The text of a file. In the light theme, whatever the page shows.
function svgFile(svg) {
  const root = document.documentElement, theme = root.dataset.theme;
  const copy = svg.cloneNode(true);
  root.dataset.theme = 'light';
  const originals = [svg, ...svg.querySelectorAll('*')];
  const copies = [copy, ...copy.querySelectorAll('*')];
  originals.forEach((original, k) => {
    const style = getComputedStyle(original);
    const texts = kSavedStyles.map((name) => `${name}:${style.getPropertyValue(name)}`);
    for (const name of ['class', 'data-series', 'tabindex', 'role', 'aria-label']) {
      copies[k].removeAttribute(name);
    }
    copies[k].setAttribute('style', texts.join(';'));
  });
  root.dataset.theme = theme;
  copy.setAttribute('viewBox', `0 0 ${svg.getAttribute('width')} ${svg.getAttribute('height')}`);
  copy.setAttribute('xmlns', 'http://www.w3.org/2000/svg');
  return new XMLSerializer().serializeToString(copy);
}

function makeSaveButton(title, plot) {
  return makeButton('SVG', () => {
    const svg = plot.querySelector('svg');
    if (!svg) return;
    const url = URL.createObjectURL(new Blob([svgFile(svg)], {type: 'image/svg+xml'}));
    const name = title.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/-$/, '');
    make('a', {href: url, download: `${name}.svg`}).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
  }, {class: 'quiet save', 'aria-label': `Save the plot ${title} as SVG`});
}
