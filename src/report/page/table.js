// A table that sorts by the column whose heading is clicked.
'use strict';

// columns: [{name, title, text(row), key(row): number or text, numeric}]; rows: any objects.
// options: {caption, mark(row): class, open(row)}.
function makeTable(columns, rows, options) {
  const body = make('tbody');
  const headings = columns.map(
      (column, k) => make(
          'th', {scope: 'col', 'aria-sort': 'none'},
          makeButton(column.name, () => sortBy(k), {title: column.title})));
  let sorted = -1, ascending = true;

  function sortBy(k) {
    ascending = sorted === k ? !ascending : true;
    sorted = k;
    headings.forEach(
        (heading, j) => heading.setAttribute(
            'aria-sort',
            j !== k       ? 'none' :
                ascending ? 'ascending' :
                            'descending'));
    fill();
  }

  function compare(a, b) {
    const x = columns[sorted].key(a), y = columns[sorted].key(b);
    const missing = (value) => value === null || value === undefined;
    if (missing(x) || missing(y)) return Number(missing(x)) - Number(missing(y));
    return (x < y ? -1 : x > y ? 1 : 0) * (ascending ? 1 : -1);
  }

  function fill() {
    const order = sorted < 0 ? rows : [...rows].sort(compare);
    body.replaceChildren(...order.map(
        (row) => make(
            'tr', {class: options.mark(row)},
            columns.map(
                (column) =>
                    make('td', {class: column.numeric ? 'number' : null}, column.text(row))))));
  }

  fill();
  const table = make(
      'table', {class: 'rows'}, make('caption', {}, options.caption),
      make('thead', {}, make('tr', {}, headings)), body);
  return make(
      'div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': options.caption}, table);
}

function numberColumn(name, get, title, format = formatNumber) {
  return {
    name,
    title,
    numeric: true,
    text: (row) => format(get(row)),
    key: (row) => isNumber(get(row)) ? get(row) : null
  };
}
