// The viewer: two pictures to flick and wipe between, with their values under the pointer.
'use strict';

// To start with: unfiltered and the best, which follows it.
function firstPair(pictures) {
  const a = Math.max(0, pictures.findIndex((picture) => picture.label.startsWith('unfiltered')));
  return {a: pictures[a], b: pictures[Math.min(a + 1, pictures.length - 1)]};
}

// `pictures`: of all studies, as main.js lists them. Returns {element, set(side, picture)}.
function makeViewer(pictures, changed) {
  const state = {
    ...firstPair(pictures),
    mode: 'wipe',
    front: 'a',
    held: false,
    divider: 0.5,
    zoom: null,
    x: 0,
    y: 0,
    exposure: 0,
    errors: false,
    probe: null,
    probeShown: false
  };
  const stage = makeStage(state);
  const decoded = {a: null, b: null, reference: null};
  let request = 0;

  const tags = {a: make('span', {class: 'tag tag-a'}), b: make('span', {class: 'tag tag-b'})};
  const divider = make(
      'div', {
        class: 'divider',
        role: 'slider',
        tabindex: 0,
        'aria-label': 'Divider between A and B',
        'aria-valuemin': 0,
        'aria-valuemax': 100
      },
      make('span', {class: 'grip'}));
  const frame = make(
      'div', {
        class: 'stage',
        tabindex: 0,
        role: 'application',
        'aria-label': 'Pictures A and B; the keys are listed beside'
      },
      stage.canvas, tags.a, tags.b, divider);
  const readout = makeReadout();
  const panel = makePanel(state, pictures, {
    set,
    swap,
    redraw,
    update,
    stage,
    hold: (held) => {
      state.held = held;
      redraw();
    },
  });

  function set(side, picture) {
    state[side] = picture;
    update();
  }

  function swap() {
    [state.a, state.b] = [state.b, state.a];
    update();
  }

  // Decodes what is to be seen, then draws it; a later request overtakes.
  async function update() {
    const mine = ++request;
    const references = [state.a, state.b].map((picture) => picture.reference);
    const [a, b, ...truths] = await Promise.all([state.a, state.b, ...references].map(
        (picture) => picture ? decodePicture(picture.stored) : null));
    if (mine !== request) return;
    Object.assign(decoded, {a, b, reference: truths[0]});
    const fits = (picture, truth) =>
        truth !== null && truth.width === picture.width && truth.height === picture.height;
    const image = (picture, truth, epsilon) => canvasOf(
        state.errors && fits(picture, truth) ? imageOfErrors(picture, truth, epsilon) :
                                               imageOfColors(picture, state.exposure));
    stage.setPictures(image(a, truths[0], state.a.epsilon), image(b, truths[1], state.b.epsilon));
    panel.refresh();
    redraw();
    frame.dataset.ready = String(mine);
    changed(state);
  }

  function redraw() {
    stage.draw();
    const one = stage.alone();
    for (const side of ['a', 'b']) {
      tags[side].textContent = `${side.toUpperCase()}  ${state[side].label}`;
      tags[side].hidden = one !== null && one !== side;
    }
    divider.hidden = one !== null;
    divider.style.left = `${100 * state.divider}%`;
    divider.setAttribute('aria-valuenow', String(Math.round(100 * state.divider)));
    panel.refreshView();
    readout.show(state, decoded);
  }

  listenToViewer({state, stage, frame, divider, pictures, set, swap, redraw, update});
  onWidth(
      frame,
      (width) => stage.resize(
          width, Math.round(Math.max(300, Math.min(0.78 * window.innerHeight, 0.9 * width)))));
  update();
  const element = make(
      'div', {class: 'viewer-parts'}, frame,
      make('div', {class: 'panel'}, panel.element, readout.element, makeKeys()));
  return {element, frame, set, state};
}

// Linear values of the pixel under the pointer, of both pictures and the reference of A.
function makeReadout() {
  const head = make('caption', {}), names = ['A', 'B', 'Reference'];
  const cells = names.map(() => d3.range(4).map(() => make('td', {class: 'number'}, kNothing)));
  const rows = names.map((name, k) => make('tr', {}, make('th', {scope: 'row'}, name), cells[k]));
  const element = make(
      'table', {class: 'readout'}, head,
      make(
          'thead', {},
          make(
              'tr', {}, ['', 'R', 'G', 'B'].map((name) => make('th', {scope: 'col'}, name)),
              make(
                  'th', {
                    scope: 'col',
                    title: 'mean over R, G, B of (x \u2212 r)\u00b2 / (r\u00b2 + \u03b5)'
                  },
                  'rel. sq. error'))),
      make('tbody', {}, rows));

  function show(state, decoded) {
    const probe = state.probe, {a, reference} = decoded;
    head.textContent =
        probe ? `Linear values of pixel ${probe.x}, ${probe.y}` : 'Linear values: point at a pixel';
    ['a', 'b', 'reference'].forEach((name, k) => {
      const picture = decoded[name];
      const values = probe && picture ? pixelOf(
                                            picture, Math.floor(probe.x * picture.width / a.width),
                                            Math.floor(probe.y * picture.height / a.height)) :
                                        null;
      const same = picture && reference && picture.width === reference.width &&
          picture.height === reference.height;
      const error = values && same && name !== 'reference' ?
          relativeError(values, pixelOf(reference, probe.x, probe.y), state.a.epsilon) :
          null;
      cells[k].forEach((cell, j) => {
        const value = values ? [...values, error][j] : null;
        cell.textContent = value !== null && !isNumber(value) ? String(value) : formatNumber(value);
      });
    });
  }
  return {element, show};
}

const kViewerKeys = [
  ['Space', 'hold: the other picture'],
  ['F', 'flick: the other picture alone'],
  ['W', 'wipe, with the divider'],
  [', .', 'move the divider'],
  ['X', 'swap A and B'],
  ['N P', 'next, previous picture in B'],
  ['E', 'colours or errors'],
  ['[ ]', 'exposure, half a stop'],
  ['0', 'exposure back'],
  ['+ \u2212', 'zoom'],
  ['1 Z', 'actual pixels, whole picture'],
  ['Arrows', 'pan'],
  ['Shift Arrows', 'move the pixel read'],
];

function makeKeys() {
  return make(
      'details', {class: 'keys', open: true},
      make('summary', {}, 'Keys, while the pictures have the focus'),
      make(
          'dl', {},
          kViewerKeys.map(
              ([keys, what]) => make(
                  'div', {},
                  make('dt', {}, keys.split(' ').flatMap((key) => [make('kbd', {}, key), ' '])),
                  make('dd', {}, what)))),
      make(
          'p', {class: 'note'},
          'Drag to pan, drag the divider to wipe. The wheel zooms once the pictures were ',
          'clicked.'));
}
