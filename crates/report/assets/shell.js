// Functions of every page: sorting of tables, copying the command, the theme.
'use strict';
const PinwheelPage = (() => {
  const $ = (id) => document.getElementById(id);
  const make = (tag, attributes = {}, ...children) => {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (value === true) element.setAttribute(name, '');
      else if (value !== false && value !== undefined) element.setAttribute(name, value);
    }
    element.append(...children);
    return element;
  };

  /** Gives the reader a file. */
  function save(blob, name) {
    const href = URL.createObjectURL(blob);
    make('a', { href, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(href), 1000);
  }

  // ---- Sortable tables ------------------------------------------------------------------------
  function sortable(table) {
    const heads = [...table.querySelectorAll('thead tr.keys th')];
    heads.forEach((head, column) => {
      const button = make('button', { type: 'button', class: 'sort' });
      button.append(...head.childNodes);
      head.append(button);
      button.addEventListener('click', () => {
        const rising = head.getAttribute('aria-sort') !== 'ascending';
        heads.forEach((other) => other.removeAttribute('aria-sort'));
        head.setAttribute('aria-sort', rising ? 'ascending' : 'descending');
        const body = table.tBodies[0];
        const key = (row) => {
          const cell = row.cells[column];
          const text = cell.dataset.key ?? cell.textContent.trim();
          const value = text === '' ? NaN : Number(text);
          return Number.isNaN(value) ? text : value;
        };
        const rows = [...body.rows].map((row) => ({ row, key: key(row) }));
        rows.sort((a, b) => {
          // Rows without a value stand last in both orders.
          if (a.key === '' || b.key === '') return (a.key === '') - (b.key === '');
          const both = typeof a.key === 'number' && typeof b.key === 'number';
          const order = both ? a.key - b.key : String(a.key).localeCompare(String(b.key), 'en', { numeric: true });
          return rising ? order : -order;
        });
        body.append(...rows.map(({ row }) => row));
      });
    });
  }
  document.querySelectorAll('table.sortable').forEach(sortable);

  // ---- A link to what is folded opens it ------------------------------------------------------
  const openTarget = () => {
    const target = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!target) return;
    const folds = [target.closest('details'), target.querySelector(':scope > details.depth')].filter(Boolean);
    for (const fold of folds) for (let e = fold; e; e = e.parentElement) if (e.tagName === 'DETAILS') e.open = true;
    if (folds.length) target.scrollIntoView();
  };
  window.addEventListener('hashchange', openTarget);
  // A second click on a link leaves the address as it is.
  document.addEventListener('click', (event) => { if (event.target.closest?.('a[href^="#"]')?.hash === location.hash) openTarget(); });
  openTarget();

  // ---- Tables that are made when they are opened ----------------------------------------------
  let later = null;
  document.querySelectorAll('details.later').forEach((fold) => {
    fold.hidden = false;
    fold.addEventListener('toggle', async () => {
      later = later || PinwheelPacked.unpack($('later-data').textContent).then((bytes) => JSON.parse(new TextDecoder().decode(bytes)));
      const { caption, headings, rows } = (await later)[Number(fold.dataset.table)];
      const head = headings.map((heading) => make('th', { scope: 'col' }, heading));
      const body = rows.map(([first, ...rest]) => make('tr', {}, make('th', { scope: 'row' }, first), ...rest.map((text) => make('td', { class: 'num' }, text))));
      const table = make('table', { class: 'data sortable' }, make('thead', {}, make('tr', { class: 'keys' }, ...head)), make('tbody', {}, ...body));
      fold.append(make('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': caption }, table));
      sortable(table);
    }, { once: true });
  });

  // ---- Copying the command --------------------------------------------------------------------
  const copy = $('copy');
  if (copy && navigator.clipboard) {
    copy.hidden = false;
    copy.addEventListener('click', () => {
      navigator.clipboard.writeText($('command').textContent).then(() => {
        copy.textContent = 'Copied';
        setTimeout(() => { copy.textContent = 'Copy'; }, 1500);
      }, () => { copy.textContent = 'Not allowed here'; });
    });
  }

  // ---- Theme ----------------------------------------------------------------------------------
  const redraws = [];
  const redraw = () => redraws.forEach((each) => each());
  const theme = $('theme');
  theme.hidden = false;
  const THEMES = ['auto', 'light', 'dark'];
  theme.addEventListener('click', () => {
    const root = document.documentElement;
    const next = THEMES[(THEMES.indexOf(root.dataset.theme || 'auto') + 1) % THEMES.length];
    if (next === 'auto') delete root.dataset.theme; else root.dataset.theme = next;
    theme.querySelector('span').textContent = next;
    redraw();
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  // Paper is white: the canvases must be as well.
  window.addEventListener('beforeprint', () => { document.documentElement.classList.add('printing'); redraw(); });
  window.addEventListener('afterprint', () => { document.documentElement.classList.remove('printing'); redraw(); });
  /** Calls `each` whenever colours change. */
  const onRedraw = (each) => redraws.push(each);
  return { $, make, save, onRedraw };
})();
