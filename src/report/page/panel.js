// The controls beside the pictures of the viewer.
'use strict';

// The pictures of all studies as choices, by study where there are several.
function pictureChoices(pictures) {
  const groups = new Map();
  pictures.forEach((picture, k) => {
    if (!groups.has(picture.study)) groups.set(picture.study, []);
    groups.get(picture.study).push({value: String(k), text: picture.label});
  });
  if (groups.size === 1) return [...groups.values()][0];
  return [...groups].map(([group, choices]) => ({group, choices}));
}

function makePanel(state, pictures, actions) {
  const choose = (side) => makeChoice(
      side.toUpperCase(), pictureChoices(pictures), String(pictures.indexOf(state[side])),
      (k) => actions.set(side, pictures[Number(k)]));
  const choiceA = choose('a'), choiceB = choose('b');
  const mode = makeSwitch(
      'How to compare',
      [
        {value: 'wipe', text: 'Wipe', title: 'A left of the divider, B right of it'},
        {value: 'a', text: 'A alone', title: 'press F to flick'},
        {value: 'b', text: 'B alone', title: 'press F to flick'},
      ],
      'wipe', (value) => {
        state.mode = value === 'wipe' ? 'wipe' : 'flick';
        if (value !== 'wipe') state.front = value;
        actions.redraw();
      });
  const hold = makeButton('Hold to flick', () => {}, {class: 'hold'});
  hold.addEventListener('pointerdown', (event) => {
    hold.setPointerCapture(event.pointerId);
    actions.hold(true);
  });
  const release = () => actions.hold(false);
  for (const name of ['pointerup', 'pointercancel', 'blur']) hold.addEventListener(name, release);
  hold.addEventListener('keydown', (event) => {
    if ((event.key === ' ' || event.key === 'Enter') && !event.repeat) actions.hold(true);
  });
  hold.addEventListener('keyup', release);

  const what = makeSwitch(
      'What to show',
      [
        {value: false, text: 'Colours'},
        {value: true, text: 'Errors', title: 'against the reference, in false colour'},
      ],
      state.errors, (value) => {
        state.errors = value;
        actions.update();
      });
  const exposureText = make('output');
  const exposure = make('input', {
    type: 'range',
    min: -8,
    max: 8,
    step: 0.5,
    value: 0,
    id: 'exposure',
    oninput: () => {
      state.exposure = Number(exposure.value);
      actions.update();
    }
  });
  const zoomText = make('output', {class: 'zoom-text'});
  const zoomed = (action) => () => {
    action();
    actions.redraw();
  };
  const stops = d3.range(0, 1.01, 0.1).map((t) => falseRamp(t)).join(',');
  const legend = make(
      'div', {class: 'ramp', role: 'img', 'aria-label': 'Colours of errors from 0.0001 to 10'},
      make('span', {}, '10\u207b\u2074'),
      make('span', {class: 'ramp-bar', style: `background:linear-gradient(to right,${stops})`}),
      make('span', {}, '10'));
  const exposureRow = make('div', {class: 'exposure'}, make('label', {for: 'exposure'
                           }, 'Exposure'), exposure, exposureText, makeButton('Reset', () => {
                             state.exposure = 0;
                             actions.update();
                           }));
  const element = make(
      'div', {class: 'panel-controls'}, choiceA, choiceB, mode.element,
      make(
          'div', {class: 'controls'}, makeButton('Swap', actions.swap, {title: 'swap A and B'}),
          hold),
      make('div', {class: 'controls'}, what.element, legend), exposureRow,
      make(
          'div', {class: 'controls'},
          makeButton('\u2212', zoomed(() => actions.stage.zoomBy(0.5)), {'aria-label': 'Zoom out'}),
          zoomText,
          makeButton('+', zoomed(() => actions.stage.zoomBy(2)), {'aria-label': 'Zoom in'}),
          makeButton(
              '1:1', zoomed(() => actions.stage.actualSize()), {'aria-label': 'Actual pixels'}),
          makeButton('Fit', zoomed(() => actions.stage.fit()))));

  // What follows from the pictures, and what from the way they are seen.
  function refresh() {
    choiceA.querySelector('select').value = String(pictures.indexOf(state.a));
    choiceB.querySelector('select').value = String(pictures.indexOf(state.b));
    const comparable = Boolean(state.a.reference || state.b.reference);
    what.element.lastChild.disabled = !comparable;
    what.set(state.errors);
    legend.hidden = !state.errors;
    for (const control of exposureRow.querySelectorAll('input, button')) {
      control.disabled = state.errors;
    }
    exposure.value = String(state.exposure);
    const stops = Math.abs(state.exposure);
    const sign = state.exposure > 0 ? '+' : state.exposure < 0 ? '\u2212' : '';
    exposureText.textContent = `${sign}${stops} ${stops === 1 ? 'stop' : 'stops'}`;
  }

  function refreshView() {
    mode.set(state.mode === 'wipe' ? 'wipe' : state.front);
    zoomText.textContent = state.zoom === null ? '' : `${formatNumber(100 * state.zoom)}\u202f%`;
  }
  return {element, refresh, refreshView};
}
