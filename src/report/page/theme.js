// Light or dark: as the system has it until the reader chooses.
'use strict';

(() => {
  const button = document.getElementById('theme');
  const system = window.matchMedia('(prefers-color-scheme: dark)');
  let chosen = null;

  function apply() {
    const theme = chosen || (system.matches ? 'dark' : 'light');
    document.documentElement.dataset.theme = theme;
    const other = theme === 'dark' ? 'light' : 'dark';
    button.textContent = other === 'dark' ? '\u263e Dark' : '\u2600 Light';
    button.setAttribute('aria-label', `Switch to the ${other} theme`);
  }

  button.addEventListener('click', () => {
    chosen = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    apply();
  });
  system.addEventListener('change', apply);
  apply();
})();
