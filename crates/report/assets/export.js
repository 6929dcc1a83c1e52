// Charts as files: what is in sight as SVG or PNG, the values of the curves that are shown as CSV.
'use strict';
const PinwheelExport = (() => {
  const { make, save } = PinwheelPage;
  const ESCAPES = { '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' };
  const escape = (text) => String(text).replace(/[&<>"]/g, (c) => ESCAPES[c]);
  const shown = ({ spec }) => spec.series.filter((series) => series.visible !== false);
  /** Room for the title, and for a line of the legend, px. */
  const [TITLE, LINE] = [26, 18];

  function csv(state) {
    const { x, y } = state.spec;
    const cell = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const columns = shown(state).flatMap(({ label, values, band }) => [[`${label}: ${y.label}`, values], ...(band ? [[`${label}: plus or minus`, band]] : [])]);
    const head = [x.label, ...columns.map(([name]) => name)].map(cell);
    const rows = Array.from(x.values, (at, k) => [at, ...columns.map(([, values]) => values[k] ?? '')]);
    return [head, ...rows].map((row) => `${row.join()}\n`).join('');
  }

  /** The picture; `ink`: colours of the page by name, colour and dash of a curve by its style. */
  function svg(state, title, ink) {
    const { plot, spec } = state;
    const { offsetLeft: left, clientWidth: wide, clientHeight: high } = plot.over;
    const top = plot.over.offsetTop + TITLE;
    const [right, bottom] = [left + wide, top + high];
    const near = (value) => Number(value.toFixed(2));
    const at = (x, y) => `${near(left + plot.valToPos(x, 'x'))} ${near(top + plot.valToPos(y, 'y'))}`;
    const text = (x, y, said, more = '') => `<text x="${near(x)}" y="${near(y)}" fill="${ink.page('--ink-soft')}" ${more}>${escape(said)}</text>`;
    const axes = plot.axes.slice(0, 2).flatMap((axis, of) => axis._splits.map((value, k) => {
      const place = of === 0 ? left + plot.valToPos(value, 'x') : top + plot.valToPos(value, 'y');
      const line = of === 0 ? `M${near(place)} ${top}V${bottom}` : `M${left} ${near(place)}H${right}`;
      const said = axis._values[k] ?? '';
      return `<path d="${line}" stroke="${ink.page('--rule')}"/>${of === 0 ? text(place, bottom + 18, said, 'text-anchor="middle"') : text(left - 8, place + 4, said, 'text-anchor="end"')}`;
    }));
    const middle = (top + bottom) / 2;
    const labels = text((left + right) / 2, bottom + 40, spec.x.label, 'text-anchor="middle"')
      + text(14, middle, spec.y.label, `text-anchor="middle" transform="rotate(-90 14 ${middle})"`);
    const [from, to] = plot.series[0].idxs;
    const curves = shown(state).map((series) => {
      const points = [];
      const edges = [[], []];
      let pen = 'M';
      let line = '';
      for (let k = Math.max(0, from - 1); k <= Math.min(spec.x.values.length - 1, to + 1); k += 1) {
        const value = series.values[k];
        if (value === null) pen = 'M';
        else if (value !== undefined) {
          const place = at(spec.x.values[k], value);
          line += pen + place;
          pen = 'L';
          points.push(`M${place}h0`);
          const off = series.band?.[k];
          if (Number.isFinite(off)) [1, -1].forEach((sign, edge) => edges[edge].push(at(spec.x.values[k], value + sign * off)));
        }
      }
      const [colour, dash] = ink.curve(series);
      const drawn = series.points || series.marks ? '' : `<path d="${line}" stroke-width="${series.thin ? 1 : 1.6}" stroke-dasharray="${dash}"/>`;
      const dots = series.points || series.markers || series.marks ? `<path d="${points.join('')}" stroke-linecap="round" stroke-width="${series.marks ? 3.5 : 7}"/>` : '';
      const [above, below] = edges;
      const band = above.length ? `<path d="M${[...above, ...below.reverse()].join('L')}Z" fill="${colour}" stroke="none" opacity="0.2"/>` : '';
      return `<g stroke="${colour}" fill="none">${band}${drawn}${dots}</g>`;
    });
    const legend = shown(state).map((series, k) => {
      const [colour, dash] = ink.curve(series);
      const y = bottom + 62 + LINE * k;
      return `<path d="M${left} ${y}h28" stroke="${colour}" stroke-width="2.5" stroke-dasharray="${dash}"/>${text(left + 38, y + 4, series.label)}`;
    });
    const [width, height] = [plot.width, bottom + 62 + LINE * legend.length];
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" font-family="${escape(ink.font)}" font-size="12"><rect width="100%" height="100%" fill="${ink.page('--sheet')}"/>`
      + `<clipPath id="area"><rect x="${left}" y="${top}" width="${wide}" height="${high}"/></clipPath>`
      + `${text(left, 18, title, 'font-weight="600"')}${axes.join('')}${labels}<g clip-path="url(#area)">${curves.join('')}</g>${legend.join('')}</svg>`;
  }

  async function png(picture) {
    const image = new Image();
    image.src = `data:image/svg+xml,${encodeURIComponent(picture)}`;
    await image.decode();
    const canvas = make('canvas', { width: 3 * image.width, height: 3 * image.height });
    canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
    return new Promise((done) => canvas.toBlob(done));
  }

  /** The menu of a chart. */
  function menu(state, ink) {
    const title = () => state.spec.describe || state.spec.y.label;
    const kinds = {
      svg: () => new Blob([svg(state, title(), ink)], { type: 'image/svg+xml' }),
      png: () => png(svg(state, title(), ink)),
      csv: () => new Blob([csv(state)], { type: 'text/csv' }),
    };
    const box = make('details', { class: 'export' }, make('summary', { 'aria-label': `Save as a file: ${title()}`, title: 'Save as a file' }, '⋯'));
    for (const [kind, file] of Object.entries(kinds)) {
      const button = make('button', { type: 'button' }, kind.toUpperCase());
      button.addEventListener('click', async () => {
        const name = title().toLowerCase().replace(/[^a-z0-9]+/g, '-').slice(0, 60);
        save(await file(), `${name}.${kind}`);
        box.open = false;
      });
      box.append(button);
    }
    return box;
  }
  return { menu };
})();
