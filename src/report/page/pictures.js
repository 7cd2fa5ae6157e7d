// The pictures of all studies, with names, errors and references for the viewer and the sheet.
'use strict';

// Of relMSE, as its settings say it: "epsilon 0.01".
function epsilonOf(metric) {
  const found = metric && /epsilon ([-+.\de]+)/.exec(metric.settings);
  return found && Number(found[1]) > 0 ? Number(found[1]) : 0.01;
}

// [{study, label, detail, epsilon, reference, row, stored}].
function listPictures(sections) {
  return sections.flatMap((section) => {
    const {study, pictures} = section, metrics = metricsOf(study), metric = metrics[0];
    const holders = study.kind === 'converge' ? study.series : study.rows;
    const varying = parametersOf(holders).filter((p) => p.values.length > 1).map((p) => p.name);
    const relative = metrics.find((one) => one.name === 'relMSE');
    const list = pictures.map((stored) => {
      const row = holders.find((holder) => holder.id === stored.id) || null;
      const point = stored.point === null ? null : row.points[stored.point];
      const measured = point || row || (stored.id === 'unfiltered' ? study.unfiltered : null);
      const name = stored.id === 'reference' ? 'reference' :
          study.kind === 'ablate'            ? ablationLabel(row) :
          row && row.parameters              ? rowText(row, varying) :
                                               'unfiltered';
      return {
        study: section.heading,
        stored,
        row,
        label: point ? `${name} \u00b7 n ${formatCount(point.n)}` : name,
        detail: !measured ? 'what the errors are against' :
            metric        ? `${metric.name} ${formatNumber(metricValue(measured, metric))}` :
                            `mean ${formatNumber(measured.mean)}`,
        epsilon: epsilonOf(relative),
      };
    });
    const reference = list.find((picture) => picture.stored.id === 'reference') || null;
    list.forEach((picture) => picture.reference = reference);
    return list;
  });
}
