// Figures over a grid of parameters: lines along one axis, maps over two, a panel for each value of a third.
'use strict';
(() => {
  const { make, onRedraw } = PinwheelPage;
  const { number } = PinwheelCharts;

  function grid(host) {
    const { axes, figures, runs } = JSON.parse(host.querySelector('script').textContent);
    const at = new Map(runs.map((places, run) => [places.join(), run]));
    const many = axes.map((_, k) => k).filter((k) => axes[k].values.length > 1);
    const longest = (a, b) => (axes[b].numbers ? 1 : 0) - (axes[a].numbers ? 1 : 0) || axes[b].values.length - axes[a].values.length || a - b;
    const [x = 0, second = -1, third = -1] = [...many].sort(longest);
    // -1: on no axis; what is on none stands at its chosen value.
    const state = { figure: 0, map: second >= 0 && Boolean(axes[second].numbers), x, second, third, fixed: axes.map(() => 0) };
    const controls = make('div', { class: 'chart-controls' });
    const panels = make('div', { class: 'charts' });
    const note = make('p', { class: 'note' });
    host.append(controls, panels, note);
    let handles = [];

    const choose = (label, options, chosen, change) => {
      const select = make('select', {});
      select.append(...options.map(([value, text]) => make('option', { value, selected: value === chosen }, text)));
      select.addEventListener('change', () => { change(Number(select.value)); draw(); });
      return make('label', { class: 'control' }, make('span', { class: 'control-label' }, label), select);
    };
    const named = (list) => list.map((k) => [k, axes[k].label]);
    // Two axes cannot be the same: what is taken away from one goes to the other.
    const place = (which) => (axis) => {
      for (const other of ['x', 'second', 'third']) if (other !== which && state[other] === axis) state[other] = state[which];
      state[which] = axis;
    };
    function control() {
      const shown = [state.x, state.second, state.third];
      const kinds = make('div', { class: 'buttons', role: 'group', 'aria-label': 'Drawn as' }, ...[['lines', false], ['map', true]].map(([word, map]) => {
        const button = make('button', { type: 'button', 'aria-pressed': String(state.map === map) }, word);
        button.addEventListener('click', () => { state.map = map; draw(); });
        return button;
      }));
      controls.replaceChildren(
        choose('Figure', figures.map((f, k) => [k, f.label]), state.figure, (k) => { state.figure = k; }),
        choose('along', named(many), state.x, place('x')),
        ...(many.length > 1 ? [choose(state.map ? 'up' : 'a line each', [...named(many), [-1, 'nothing']], state.second, place('second'))] : []),
        ...(many.length > 2 ? [choose('a panel each', [...named(many), [-1, 'nothing']], state.third, place('third'))] : []),
        ...many.filter((k) => !shown.includes(k)).map((k) => choose(axes[k].label, axes[k].values.map((v, n) => [n, v]), state.fixed[k], (n) => { state.fixed[k] = n; })),
        ...(many.length > 1 ? [kinds] : []),
      );
    }
    const all = (axis) => (axis < 0 ? [null] : axes[axis].values.map((_, n) => n));
    const runAt = (along, up, panel) => {
      const places = [...state.fixed];
      for (const [axis, n] of [[state.x, along], [state.second, up], [state.third, panel]]) if (axis >= 0 && n !== null) places[axis] = n;
      return at.get(places.join());
    };
    const bound = (u) => (u === null || u === undefined ? '' : ` ± ${number(u, 1)}`);

    function lines(panel) {
      const figure = figures[state.figure];
      const along = axes[state.x];
      const xs = along.numbers || along.values.map((_, n) => n + 1);
      const order = xs.map((_, n) => n).sort((a, b) => xs[a] - xs[b]);
      const series = all(state.second).map((up, k) => {
        const own = order.map((n) => runAt(n, up, panel));
        const take = (list) => own.map((run) => (run === undefined ? null : list[run] ?? null));
        const [values, band] = [take(figure.values), take(figure.uncertainty)];
        return { label: up === null ? figure.label : `${axes[state.second].label.replace(/ \(.*/, '')} ${axes[state.second].values[up]}`, style: k, values, band, markers: true, more: (n) => bound(band[n]) };
      });
      const values = order.map((n) => xs[n]);
      const log = values[0] > 0 && values[values.length - 1] / values[0] > 30;
      const known = series.flatMap((s) => s.band).filter((u) => u !== null);
      const every = figure.values.filter((v) => v !== null);
      const size = Math.max(...every.map(Math.abs));
      return {
        legend: series,
        spec: {
          height: 300,
          x: { values, label: along.label, log, ticks: values, name: (n) => `${along.label}: ${along.values[order[n]]}` },
          // Less than what a figure may be off, or than a thousandth, is not spread over the whole chart.
          y: { label: figure.label, span: Math.max(6 * Math.max(0, ...known), 1e-3 * size), include: [Math.min(...every), Math.max(...every)] },
          series,
          describe: `${figure.label} over ${along.label}, ${series.length} curves`,
        },
      };
    }
    function map(panel, [low, high], title) {
      const figure = figures[state.figure];
      const [along, up] = [axes[state.x], state.second < 0 ? null : axes[state.second]];
      const head = make('tr', {}, make('td', { class: 'corner' }, up ? `${up.label} ↓ ${along.label} →` : along.label), ...along.values.map((v) => make('th', { scope: 'col', class: 'num' }, v)));
      const rows = all(state.second).map((n) => make('tr', {}, make('th', { scope: 'row' }, up ? up.values[n] : ''), ...along.values.map((_, k) => {
        const run = runAt(k, n, panel);
        const value = run === undefined ? null : figure.values[run];
        if (value === null || value === undefined) return make('td', { class: 'num muted' }, '–');
        const heat = high > low ? (0.85 * (value - low)) / (high - low) : 0;
        return make('td', { class: 'num map', style: `--heat:${heat.toFixed(3)}`, title: `run ${run + 1}${bound(figure.uncertainty[run])}` }, number(value, 4));
      })));
      return make('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': panel === null ? `Map of ${title}` : `Map of ${figure.label}, ${title}` }, make('table', { class: 'data heat-map' }, make('thead', {}, head), make('tbody', {}, ...rows)));
    }
    function draw() {
      handles.forEach((handle) => handle.destroy());
      handles = [];
      control();
      const figure = figures[state.figure];
      const finite = figure.values.filter((v) => v !== null);
      const known = figure.uncertainty.filter((u) => u !== null);
      const spread = Math.max(...finite) - Math.min(...finite);
      const largest = Math.max(0, ...known);
      note.textContent = known.length === 0 ? 'Nothing is known of how far these figures may be off: solver.integrator = "auto" verifies every run.'
        : `Bands are what a figure may be off: the engine's numerical uncertainty, and of means how far those of the window's halves are apart; ${number(largest, 2)} at most. The figures differ by ${number(spread, 2)}${spread <= 2 * largest ? ': no more than that, so no trend is shown' : ''}.`;
      panels.replaceChildren(...all(state.third).map((panel) => {
        const title = panel === null ? figure.label : `${axes[state.third].label}: ${axes[state.third].values[panel]}`;
        const box = make('article', { class: 'panel' }, make('h3', {}, title));
        if (state.map) box.append(map(panel, [Math.min(...finite), Math.max(...finite)], title));
        else {
          const { spec, legend } = lines(panel);
          const plot = make('div', { class: 'plot' });
          const chips = make('div', { class: 'legend' }, ...legend.map((s, k) => {
            const chip = make('button', { type: 'button', class: 'chip', 'aria-pressed': 'true' }, PinwheelCharts.swatch(s.style), make('span', {}, s.label));
            chip.addEventListener('click', () => {
              const on = chip.getAttribute('aria-pressed') !== 'true';
              chip.setAttribute('aria-pressed', String(on));
              plot.handle.show(k, on);
            });
            return chip;
          }));
          box.append(chips, plot);
          requestAnimationFrame(() => {
            if (!plot.isConnected) return;
            plot.handle = PinwheelCharts.chart(plot, spec);
            handles.push(plot.handle);
          });
        }
        return box;
      }));
    }
    draw();
    onRedraw(() => handles.forEach((handle) => handle.redraw()));
  }

  document.querySelectorAll('.grid').forEach(grid);
})();
