// A study's charts: curves on grids of their own, joined on one horizontal axis, with a legend that
// shows what the reader points at and hides curves at a click.
'use strict';
(() => {
  const { $, make, onRedraw } = PinwheelPage;
  const GAP = null; // a value that does not exist; `undefined` is a place that belongs to another grid

  function decode(text) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    return Array.from({ length: bytes.length / 4 }, (_, k) => view.getFloat32(4 * k, true));
  }

  // The nearest value of a curve to the place pointed at; curves without a point near have none.
  function nearest(values, index) {
    for (let away = 0; away < values.length; away += 1) {
      for (const k of [index - away, index + away]) {
        if (k >= 0 && k < values.length && values[k] !== undefined && values[k] !== null) return k;
      }
    }
    return null;
  }

  function draw(host, legend, chart) {
    const fits = (v, log) => Number.isFinite(v) && (!log || v > 0);
    const grids = chart.grids.map(decode);
    // Points that share an abscissa would be lost in a join: each grid keeps its own repeats by
    // being moved by less than a pixel can show.
    const tables = chart.series.map((s) => {
      const ys = decode(s.y);
      const seen = [];
      const kept = grids[s.grid].map((x, k) => k).filter((k) => fits(grids[s.grid][k], chart.x.log));
      let last = -Infinity;
      const xs = kept.map((k) => {
        let x = grids[s.grid][k];
        if (x <= last) x = last + Math.abs(last) * 1e-9 + Number.MIN_VALUE;
        last = x;
        seen.push(k);
        return x;
      });
      return { xs, ys: kept.map((k) => (fits(ys[k], chart.y.log) ? ys[k] : GAP)), seen };
    });
    const union = Float64Array.from(new Set(tables.flatMap((t) => t.xs))).sort();
    const place = new Map([...union].map((x, k) => [x, k]));
    const series = chart.series.map((s, k) => {
      const values = new Array(union.length).fill(undefined);
      const tags = new Map();
      tables[k].xs.forEach((x, n) => {
        values[place.get(x)] = tables[k].ys[n];
        if (s.tags) tags.set(place.get(x), s.tags[tables[k].seen[n]]);
      });
      return { label: s.label, style: s.colour, values, tags, points: s.style === 'points', markers: s.style === 'both', thin: s.style === 'dashed' };
    });

    const cells = series.map((s, k) => {
      const value = make('b', {}, '');
      const tag = make('em', {}, '');
      const item = make('button', { type: 'button', class: 'reading toggle', 'aria-pressed': 'true', title: s.label }, PinwheelCharts.swatch(s.style), make('span', { class: 'who' }, s.label), value, tag);
      item.addEventListener('click', () => {
        const on = item.getAttribute('aria-pressed') !== 'true';
        item.setAttribute('aria-pressed', String(on));
        handle.show(k, on);
      });
      legend.append(item);
      return { value, tag };
    });
    const handle = PinwheelCharts.chart(host, {
      height: 300,
      x: { values: [...union], label: chart.x.label, log: chart.x.log },
      y: { label: chart.y.label, log: chart.y.log },
      series,
      describe: `${chart.title}: ${chart.y.label} over ${chart.x.label}, ${series.length} curves`,
      onCursor(index) {
        series.forEach((s, k) => {
          const near = index === null ? null : nearest(s.values, index);
          cells[k].value.textContent = near === null ? '' : PinwheelCharts.number(s.values[near], 4);
          cells[k].tag.textContent = near === null ? '' : s.tags.get(near) ?? `at ${PinwheelCharts.number(union[near], 4)}`;
        });
      },
    });
    onRedraw(() => handle.redraw());
  }

  const charts = JSON.parse($('study-data').textContent);
  const find = (name, k) => document.querySelector(`[data-${name}="${k}"]`);
  // Charts inside a closed line are drawn when it opens: before, they have no width.
  charts.forEach((chart, k) => {
    const host = find('chart', k);
    const closed = host.closest('details:not([open])');
    const start = () => draw(host, find('legend', k), chart);
    if (closed) closed.addEventListener('toggle', start, { once: true });
    else start();
  });
})();
