// The contact sheet: every picture small, with its parameters and error.
'use strict';

function makeSheet(pictures, choose) {
  const cards = new Map();
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      seen.unobserve(entry.target);
      drawThumbnail(entry.target);
    }
  }, {rootMargin: '300px'});

  async function drawThumbnail(canvas) {
    const picture = pictures[Number(canvas.dataset.picture)];
    const decoded = await decodePicture(picture.stored);
    canvas.getContext('2d').putImageData(imageOfColors(decoded, 0), 0, 0);
    canvas.dataset.drawn = 'true';
  }

  function makeCard(picture, k) {
    const canvas = make('canvas', {
      width: picture.stored.width,
      height: picture.stored.height,
      role: 'img',
      'aria-label': picture.label,
      'data-picture': k,
      onclick: () => choose('b', picture)
    });
    seen.observe(canvas);
    const side = (name) => makeButton(
        name.toUpperCase(), () => choose(name, picture),
        {'aria-label': `Show ${picture.label} as ${name.toUpperCase()}`, 'aria-pressed': 'false'});
    const buttons = {a: side('a'), b: side('b')};
    const card = make(
        'figure', {class: 'card'}, canvas,
        make(
            'figcaption', {}, make('span', {class: 'card-name'}, picture.label),
            make('span', {class: 'note'}, picture.detail),
            make('span', {class: 'card-sides'}, buttons.a, buttons.b)));
    cards.set(picture, {card, buttons});
    return card;
  }

  const element = make('div', {class: 'sheets'});
  for (const study of new Set(pictures.map((picture) => picture.study))) {
    const mine = pictures.filter((picture) => picture.study === study);
    element.append(
        make('h3', {}, `Contact sheet: ${study}`),
        make(
            'div', {class: 'sheet'},
            mine.map((picture) => makeCard(picture, pictures.indexOf(picture)))));
  }

  // Shows which pictures the viewer has.
  function mark(state) {
    for (const [picture, {card, buttons}] of cards) {
      for (const side of ['a', 'b'])
        buttons[side].setAttribute('aria-pressed', String(state[side] === picture));
      card.classList.toggle('in-use', state.a === picture || state.b === picture);
    }
  }
  return {element, mark};
}
