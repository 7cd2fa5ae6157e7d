// The stage of the viewer: where pixels lie on it, and drawing two pictures with a divider.
'use strict';

const kZoomRange = [1 / 8, 64];

// `state`: {zoom, x, y: stage position of the picture's left upper corner, divider, mode, front,
// held, probe, probeShown}.
function makeStage(state) {
  const canvas = make('canvas', {'aria-hidden': 'true'});
  const context = canvas.getContext('2d');
  let width = 1, height = 1, ratio = 1;
  let shown = {a: null, b: null};  // canvases of the pictures
  const size = () => shown.a ? [shown.a.width, shown.a.height] : [1, 1];

  function resize(newWidth, newHeight) {
    const fitted = isFitted();
    width = newWidth;
    height = newHeight;
    ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.height = `${height}px`;
    if (fitted) fit();
    draw();
  }

  // The whole picture; enlarged by whole numbers only, so that all pixels are equal.
  const fitZoom = () => {
    const zoom = Math.min(width / size()[0], height / size()[1]);
    return zoom > 1 ? Math.floor(zoom) : zoom;
  };
  const isFitted = () => state.zoom === null || Math.abs(state.zoom - fitZoom()) < 1e-9;

  function fit() { place(fitZoom(), width / 2, height / 2, size()[0] / 2, size()[1] / 2); }

  // Puts the picture's point (px, py) at the stage's (sx, sy).
  function place(zoom, sx, sy, px, py) {
    state.zoom = zoom;
    state.x = Math.round(sx - px * zoom);
    state.y = Math.round(sy - py * zoom);
  }

  // Keeps the point under (sx, sy), by default the middle, where it is.
  function zoomBy(factor, sx = width / 2, sy = height / 2) {
    const [px, py] = [(sx - state.x) / state.zoom, (sy - state.y) / state.zoom];
    const zoom = Math.min(kZoomRange[1], Math.max(kZoomRange[0], state.zoom * factor));
    place(zoom, sx, sy, px, py);
    pan(0, 0);
  }

  // Some of the picture always stays in sight.
  function pan(dx, dy) {
    const keep = 40, [w, h] = size();
    state.x = Math.min(width - keep, Math.max(keep - w * state.zoom, state.x + dx));
    state.y = Math.min(height - keep, Math.max(keep - h * state.zoom, state.y + dy));
  }

  // The pixel under a point of the stage, null beside the picture.
  function pixelAt(sx, sy) {
    const x = Math.floor((sx - state.x) / state.zoom), y = Math.floor((sy - state.y) / state.zoom);
    return x >= 0 && y >= 0 && x < size()[0] && y < size()[1] ? {x, y} : null;
  }

  // Which picture is to be seen alone, null where the divider shares the stage.
  function alone() {
    const front = state.mode === 'flick' ? state.front : null;
    if (!state.held) return front;
    return front === 'b' ? 'a' : 'b';
  }

  function drawPicture(picture, left, right) {
    if (!picture || right <= left) return;
    context.save();
    context.beginPath();
    context.rect(left, 0, right - left, height);
    context.clip();
    context.imageSmoothingEnabled = state.zoom * ratio < 1;
    context.drawImage(picture, state.x, state.y, size()[0] * state.zoom, size()[1] * state.zoom);
    context.restore();
  }

  function drawProbe() {
    if (!state.probe || !state.probeShown) return;
    const side = Math.max(state.zoom, 7), middle = (side - state.zoom) / 2;
    const left = state.x + state.probe.x * state.zoom - middle;
    const top = state.y + state.probe.y * state.zoom - middle;
    for (const [color, inset] of [['#000', -1.5], ['#fff', -0.5]]) {
      context.strokeStyle = color;
      context.lineWidth = 1;
      context.strokeRect(left + inset, top + inset, side - 2 * inset, side - 2 * inset);
    }
  }

  function draw() {
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const one = alone(), split = state.divider * width;
    if (one !== 'b') drawPicture(shown.a, 0, one === 'a' ? width : split);
    if (one !== 'a') drawPicture(shown.b, one === 'b' ? 0 : split, width);
    drawProbe();
  }

  function setPictures(a, b) {
    const before = size().join();
    shown = {a, b};
    if (state.zoom === null || size().join() !== before) fit();
    draw();
  }

  return {
    canvas,
    resize,
    fit,
    zoomBy,
    pan,
    pixelAt,
    alone,
    draw,
    setPictures,
    width: () => width,
    actualSize: () => zoomBy(1 / state.zoom / ratio)
  };
}
