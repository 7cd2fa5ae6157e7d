// Puts the page together: a section for each study, then the pictures.
'use strict';

(() => {
  const sections = report.sections, host = document.getElementById('studies');
  const contents = document.getElementById('contents');
  document.getElementById('brand').textContent = `psf ${report.version}`;
  const names = {sweep: 'Sweep', converge: 'Convergence', ablate: 'Ablation'};
  sections.forEach(
      (section) => section.heading = `${names[section.study.kind]}: ${section.folder}`);
  const pictures = listPictures(sections);
  let viewer = null, sheet = null;

  function show(side, picture) {
    viewer.set(side, picture);
    document.getElementById('viewer').scrollIntoView({block: 'nearest'});
  }

  // From a map: the row's picture beside the one in A, where it is embedded.
  function open(row) {
    const picture = pictures.find((one) => one.row === row);
    if (!picture) return;
    viewer.set('b', picture);
    document.getElementById('pictures').scrollIntoView();
    viewer.frame.focus({preventScroll: true});
  }

  sections.forEach((section, k) => {
    const id = `study-${k}`;
    const element = make(
        'section', {id, 'aria-labelledby': `${id}-heading`, class: 'study'},
        make('h2', {id: `${id}-heading`}, section.heading));
    host.append(element);
    contents.append(make('a', {href: `#${id}`}, section.heading));
    const fill = {sweep: makeSweep, converge: makeConverge, ablate: makeAblation};
    fill[section.study.kind](section, element, open);
  });

  const leftOut = d3.sum(sections, (section) => section.left_out);
  if (pictures.length > 0 || leftOut > 0) {
    document.getElementById('pictures').hidden = false;
    contents.append(make('a', {href: '#pictures'}, 'Pictures'));
  }
  if (pictures.length > 0) {
    sheet = makeSheet(pictures, show);
    viewer = makeViewer(pictures, sheet.mark);
    document.getElementById('viewer').append(viewer.element);
    document.getElementById('sheet').append(sheet.element);
  }
  document.getElementById('pictures-note').textContent = leftOut === 0 ?
      '' :
      `${formatCount(leftOut)} more ${
          leftOut === 1 ? 'picture was' : 'pictures were'} left out, those of the largest ` +
          'errors; psf report --max-pictures embeds more.';
})();
