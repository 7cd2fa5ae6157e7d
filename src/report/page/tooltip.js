// One tip for the whole page, beside the pointer or the focused element.
'use strict';

const tooltip = (() => {
  const element = document.getElementById('tooltip');

  // `lines`: texts, the first one is the heading, or pairs of name and value.
  function show(lines, x, y) {
    element.replaceChildren(...lines.map((line, k) => {
      if (Array.isArray(line)) {
        return make('div', {class: 'tip-row'}, make('span', {}, line[0]), make('b', {}, line[1]));
      }
      return make('div', {class: k === 0 ? 'tip-head' : 'tip-line'}, line);
    }));
    element.hidden = false;
    const gap = 14, box = element.getBoundingClientRect();
    const right = x + gap + box.width <= window.innerWidth - 4;
    const below = y + gap + box.height <= window.innerHeight - 4;
    element.style.left = `${Math.max(4, right ? x + gap : x - gap - box.width)}px`;
    element.style.top = `${Math.max(4, below ? y + gap : y - gap - box.height)}px`;
  }

  function hide() { element.hidden = true; }

  // Shows lines() while the pointer or the focus is on `target`.
  function attach(target, lines) {
    target.addEventListener('pointermove', (event) => show(lines(), event.clientX, event.clientY));
    target.addEventListener('pointerleave', hide);
    target.addEventListener('focus', () => {
      if (!target.matches(':focus-visible')) return;
      const box = target.getBoundingClientRect();
      show(lines(), box.right - gapInside(box.width), box.bottom - gapInside(box.height));
    });
    target.addEventListener('blur', hide);
  }

  const gapInside = (size) => Math.min(12, size / 2);

  document.addEventListener('keydown', (event) => {
    if (event.key === 'Escape') hide();
  });
  window.addEventListener('scroll', hide, {passive: true});
  return {show, hide, attach};
})();
