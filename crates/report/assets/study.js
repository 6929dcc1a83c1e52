// A study's charts: curves on grids of their own, joined on one horizontal axis, with a legend that hides curves at a click.
'use strict';
(() => {
  const { $, make, onRedraw } = PinwheelPage;
  const GAP = null; // a value that does not exist; `undefined` is a place that belongs to another grid

  function decode(text) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    return Array.from({ length: bytes.length / 4 }, (_, k) => view.getFloat32(4 * k, true));
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
      return { label: s.label, style: s.colour, values, more: (at) => tags.get(at) ?? '', points: s.style === 'points', markers: s.style === 'both', thin: s.style === 'dashed' };
    });
    series.forEach((s, k) => {
      const item = make('button', { type: 'button', class: 'chip', 'aria-pressed': 'true' }, PinwheelCharts.swatch(s.style), make('span', {}, s.label));
      item.addEventListener('click', () => {
        const on = item.getAttribute('aria-pressed') !== 'true';
        item.setAttribute('aria-pressed', String(on));
        handle.show(k, on);
      });
      legend.append(item);
    });
    // Pins, coordinates and orders are counted.
    const ticks = [...union].every(Number.isInteger) ? [...union] : undefined;
    const handle = PinwheelCharts.chart(host, {
      height: 300,
      x: { values: [...union], label: chart.x.label, log: chart.x.log, ticks, name: (k) => `${chart.x.label}: ${PinwheelCharts.number(union[k], 4)}` },
      y: { label: chart.y.label, log: chart.y.log },
      series,
      describe: `${chart.title}: ${chart.y.label} over ${chart.x.label}, ${series.length} curves`,
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
