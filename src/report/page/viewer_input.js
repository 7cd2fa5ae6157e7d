// Pointer and keys on the stage of the viewer.
'use strict';

function listenToViewer(viewer) {
  const {state, stage, frame, divider, pictures, set, swap, redraw, update} = viewer;
  let drag = null;  // 'pan' or 'divider'

  function at(event) {
    const box = frame.getBoundingClientRect();
    return [event.clientX - box.left - frame.clientLeft, event.clientY - box.top - frame.clientTop];
  }

  function moveDivider(to) {
    state.divider = Math.min(1, Math.max(0, to));
    redraw();
  }

  frame.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    drag = divider.contains(event.target) ? 'divider' : 'pan';
    frame.setPointerCapture(event.pointerId);
    frame.classList.toggle('panning', drag === 'pan');
    (drag === 'divider' ? divider : frame).focus({preventScroll: true});
    event.preventDefault();
  });
  frame.addEventListener('pointermove', (event) => {
    const [x, y] = at(event);
    if (drag === 'divider') return moveDivider(x / stage.width());
    if (drag === 'pan') stage.pan(event.movementX, event.movementY);
    state.probe = stage.pixelAt(x, y);
    state.probeShown = false;
    redraw();
  });
  for (const name of ['pointerup', 'pointercancel']) {
    frame.addEventListener(name, () => {
      drag = null;
      frame.classList.remove('panning');
    });
  }
  // Only with the focus, so that the page still scrolls past the pictures.
  frame.addEventListener('wheel', (event) => {
    if (!frame.contains(document.activeElement)) return;
    event.preventDefault();
    stage.zoomBy(2 ** (-event.deltaY / 240), ...at(event));
    redraw();
  }, {passive: false});
  frame.addEventListener('blur', () => hold(false));

  function hold(held) {
    state.held = held;
    redraw();
  }

  function flick() {
    if (state.mode === 'flick') state.front = state.front === 'a' ? 'b' : 'a';
    state.mode = 'flick';
    redraw();
  }

  function expose(stops) {
    state.exposure = stops === 0 ? 0 : Math.min(8, Math.max(-8, state.exposure + stops));
    update();
  }

  function moveProbe(dx, dy) {
    const {width, height} = state.a.stored;
    const from = state.probe || {x: Math.floor(width / 2), y: Math.floor(height / 2)};
    state.probe = {
      x: Math.min(width - 1, Math.max(0, from.x + dx)),
      y: Math.min(height - 1, Math.max(0, from.y + dy))
    };
    state.probeShown = true;
    redraw();
  }

  function step(by) {
    const k = pictures.indexOf(state.b) + by;
    set('b', pictures[(k + pictures.length) % pictures.length]);
  }

  const seen = (action) => () => {
    action();
    redraw();
  };
  const keys = {
    ' ': () => hold(true),
    f: flick,
    x: swap,
    n: () => step(1),
    p: () => step(-1),
    w: seen(() => state.mode = 'wipe'),
    e: () => {
      state.errors = !state.errors && Boolean(state.a.reference || state.b.reference);
      update();
    },
    ',': () => moveDivider(state.divider - 0.02),
    '.': () => moveDivider(state.divider + 0.02),
    '[': () => expose(-0.5),
    ']': () => expose(0.5),
    0: () => expose(0),
    '+': seen(() => stage.zoomBy(2)),
    '=': seen(() => stage.zoomBy(2)),
    '-': seen(() => stage.zoomBy(0.5)),
    1: seen(stage.actualSize),
    z: seen(stage.fit),
  };
  const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};

  frame.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = arrows[event.key],
          action = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (arrow && event.target === divider && arrow[0] !== 0) {
      moveDivider(state.divider + 0.02 * arrow[0]);
    } else if (arrow && event.shiftKey) {
      moveProbe(...arrow);
    } else if (arrow) {
      stage.pan(-40 * arrow[0], -40 * arrow[1]);
      redraw();
    } else if (action) {
      if (!(event.key === ' ' && event.repeat)) action();
    } else {
      return;
    }
    event.preventDefault();
  });
  frame.addEventListener('keyup', (event) => {
    if (event.key === ' ') hold(false);
  });
}
