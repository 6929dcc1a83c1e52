// What the comparison's page does beyond every page: charts of courses, the matrices' inspector.
'use strict';
(() => {
  const { $, make, onRedraw } = PinwheelPage;

  // ---- The matrices' inspector: the quantities of the chosen pair in the chosen window ---------
  document.querySelectorAll('section.track').forEach((section) => {
    const inspector = section.querySelector('.inspector');
    if (!inspector) return;
    let pinned = null;
    const show = (link) => {
      const details = document.getElementById(link.hash.slice(1));
      if (!details) return;
      const table = details.querySelector('table').cloneNode(true);
      table.querySelectorAll('tbody tr').forEach((row) => {
        if (row.dataset.window !== link.dataset.window) row.remove();
      });
      const title = make('p', { class: 'inspector-title' });
      title.append(make('b', {}, details.querySelector('summary').textContent.trim()), `, ${link.dataset.window}`);
      inspector.replaceChildren(title, make('div', { class: 'scroll', tabindex: '0' }, table));
      inspector.hidden = false;
      section.querySelectorAll('.matrix td.chosen').forEach((cell) => cell.classList.remove('chosen'));
      link.parentElement.classList.add('chosen');
    };
    section.querySelectorAll('.matrix a').forEach((link) => {
      link.addEventListener('click', (event) => { event.preventDefault(); pinned = link; show(link); });
      link.addEventListener('mouseenter', () => { if (!pinned) show(link); });
      link.addEventListener('focus', () => { if (!pinned) show(link); });
    });
    // Begin with the pair that is worst off, so that the space is never empty.
    const worst = section.querySelector('.matrix td.exceeded a')
      || [...section.querySelectorAll('.matrix td.heat')].sort((a, b) => b.style.getPropertyValue('--heat') - a.style.getPropertyValue('--heat'))[0]?.querySelector('a');
    if (worst) show(worst);
  });
  // A link to a pair from elsewhere opens its details.
  const openTarget = () => {
    const target = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (target && target.tagName === 'DETAILS') target.open = true;
  };
  window.addEventListener('hashchange', openTarget);
  openTarget();

  const source = $('chart-data');
  if (source) drawCourses(JSON.parse(source.textContent));

  // ---- Courses --------------------------------------------------------------------------------
  function drawCourses(data) {
    const { engines, windows } = data;
    const time = data.time.values
      || Array.from({ length: data.time.count }, (_, k) => data.time.start + k * data.time.step);

    // One channel of every engine: base64 of little-endian floats, the first engine's values and
    // the others' differences to it. Decoded when first shown.
    function decode(text) {
      const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
      const view = new DataView(bytes.buffer);
      return Float64Array.from({ length: bytes.length / 4 }, (_, k) => view.getFloat32(4 * k, true));
    }
    const decoded = new Map();
    function channel(quantity, index) {
      const key = `${quantity.name} ${index}`;
      if (!decoded.has(key)) {
        const { base, others } = quantity.channels[index];
        const first = decode(base);
        decoded.set(key, { first, differences: [new Float64Array(first.length), ...others.map((o) => (o === null ? null : decode(o)))] });
      }
      return decoded.get(key);
    }
    // What is not finite, or past the end of a run that broke off, is a gap.
    const column = (length, value) => Array.from({ length }, (_, k) => {
      const v = value(k);
      return Number.isFinite(v) ? v : null;
    });
    const values = (from, e) => {
      const { first, differences } = from;
      const d = differences[e];
      return column(time.length, (k) => (d && k < d.length ? first[k] + d[k] : NaN));
    };
    const differences = (from, e, base, log) => {
      const d = from.differences[e];
      const b = from.differences[base];
      return column(time.length, (k) => {
        if (!d || !b || k >= d.length || k >= b.length) return NaN;
        const v = d[k] - b[k];
        return log ? (v === 0 ? NaN : Math.abs(v)) : v;
      });
    };
    // A log axis need not show every zero crossing: two decades below the smallest median will do.
    const floor = (columns) => {
      const medians = columns.map((c) => c.filter((v) => v > 0).sort((a, b) => a - b)).filter((c) => c.length > 0).map((c) => c[c.length >> 1]);
      return medians.length ? Math.min(...medians) / 100 : 0;
    };

    const state = { base: 0, log: true, visible: engines.map(() => true) };
    // What differs most by nature is drawn first, under the others.
    const order = engines.map((_, e) => e).sort((a, b) => (engines[b].track === 'own-contact') - (engines[a].track === 'own-contact') || a - b);
    const panels = [];

    function panel(quantity) {
      const unit = quantity.unit ? ` (${quantity.unit})` : '';
      const several = quantity.channels.length > 1;
      let chosen = 0;
      const title = make('h3', {}, quantity.label);
      const head = make('div', { class: 'panel-head' }, title);
      let select = null;
      if (several) {
        select = make('select', { 'aria-label': `${quantity.label}: which one` });
        quantity.channels.forEach((c, k) => select.append(make('option', { value: k }, `no. ${c.label}`)));
        head.append(select);
      }
      // The track inside a name is said by the chips above already.
      const brief = (engine) => engine.name.replace(`-${engine.track}-`, '-');
      const readout = make('div', { class: 'readout', 'aria-live': 'off' });
      const instant = make('span', { class: 'instant' }, '');
      const cells = engines.map((engine) => {
        const value = make('b', {}, '');
        const difference = make('em', {}, '');
        const item = make('span', { class: 'reading' }, PinwheelCharts.swatch(engine.style), make('span', { class: 'who', title: engine.name }, brief(engine)), value, difference);
        readout.append(item);
        return { item, value, difference };
      });
      head.append(instant);
      const top = make('div', { class: 'plot' });
      const bottom = make('div', { class: 'plot' });
      const under = make('p', { class: 'plot-title' });
      const box = make('article', { class: 'panel' }, head, readout, top, under, bottom);
      $('charts').append(box);

      let upper;
      let lower;
      let current;
      function series() {
        current = channel(quantity, chosen);
        const drawn = (of) => order.map((e) => ({ label: engines[e].name, style: engines[e].style, visible: state.visible[e], sparse: engines[e].sparse, values: of(e) }));
        return [drawn((e) => values(current, e)), drawn((e) => differences(current, e, state.base, state.log))];
      }
      const name = () => (several ? `${quantity.label} no. ${quantity.channels[chosen].label}` : quantity.label);
      const axis = (apart) => ({ label: `${state.log ? '|difference|' : 'Difference'}${unit}`, log: state.log, zero: !state.log, floor: state.log ? floor(apart.map((s) => s.values)) : 0 });
      function read(index) {
        instant.textContent = index === null ? '' : `t = ${time[index].toFixed(5).replace(/0+$/, '').replace(/\.$/, '')} s`;
        cells.forEach((cell, e) => {
          const v = index === null ? null : upper.value(e, index);
          const d = index === null || e === state.base ? null : signed(e, index);
          cell.value.textContent = v === null ? '' : PinwheelCharts.number(v, 5);
          cell.difference.textContent = d === null ? '' : `Δ\u202f${PinwheelCharts.number(d, 2)}`;
        });
      }
      const signed = (e, k) => {
        const d = current.differences[e];
        const b = current.differences[state.base];
        return d && b && k < d.length && k < b.length ? d[k] - b[k] : null;
      };
      const describe = () => `${name()} over time, ${engines.length} engines`;
      const [over, apart] = series();
      const shared = { x: { values: time, label: 'Time (s)' }, group: 'time' };
      under.textContent = `Difference to ${engines[state.base].name}`;
      upper = PinwheelCharts.chart(top, { ...shared, height: 250, y: { label: `${quantity.label}${unit}` }, series: over, describe: describe(), onCursor: (k) => read(k), onZoom: zoomed });
      lower = PinwheelCharts.chart(bottom, { ...shared, height: 185, y: axis(apart), series: apart, describe: `Differences of ${describe()}` });
      upper.value = (e, k) => { const d = current.differences[e]; return d && k < d.length ? current.first[k] + d[k] : null; };
      function refresh() {
        const [o, a] = series();
        under.textContent = `Difference to ${engines[state.base].name}`;
        upper.update({ series: o, describe: describe() });
        lower.update({ series: a, y: axis(a), describe: `Differences of ${describe()}` });
      }
      if (select) select.addEventListener('change', () => { chosen = Number(select.value); refresh(); });
      panels.push({ refresh, upper, lower, cells });
      onRedraw(() => { upper.redraw(); lower.redraw(); });
    }

    // Buttons.
    const press = (buttons, on) => buttons.forEach((b) => b.setAttribute('aria-pressed', String(on(b))));
    const offered = [{ kind: 'all', from: null, to: null }, ...windows];
    const windowButtons = offered.map((w) => make('button', { type: 'button', 'aria-pressed': 'false' }, w.kind));
    windowButtons.forEach((button, k) => button.addEventListener('click', () => panels[0].upper.range(offered[k].from, offered[k].to)));
    $('windows').append(...windowButtons);
    function zoomed(from, to) {
      const near = (a, b) => Math.abs(a - b) <= 1e-6 * (time[time.length - 1] - time[0]);
      press(windowButtons, (b) => {
        const w = offered[windowButtons.indexOf(b)];
        return near(from, w.from ?? time[0]) && near(to, w.to ?? time[time.length - 1]);
      });
    }
    document.querySelectorAll('[data-zoom]').forEach((button) => button.addEventListener('click', () => {
      const [from, to] = panels[0].upper.shown();
      const breadth = to - from;
      const [a, b] = { in: [0.25, -0.25], out: [-0.5, 0.5], left: [-0.5, -0.5], right: [0.5, 0.5] }[button.dataset.zoom];
      let [low, high] = [from + a * breadth, to + b * breadth];
      const [first, last] = [time[0], time[time.length - 1]];
      if (button.dataset.zoom === 'left' && low < first) [low, high] = [first, first + breadth];
      if (button.dataset.zoom === 'right' && high > last) [low, high] = [last - breadth, last];
      panels[0].upper.range(low, high);
    }));
    const base = $('base');
    engines.forEach((engine, e) => base.append(make('option', { value: e }, engine.name)));
    base.addEventListener('change', () => { state.base = Number(base.value); panels.forEach((p) => p.refresh()); });
    const scales = [...document.querySelectorAll('[data-scale]')];
    scales.forEach((button) => button.addEventListener('click', () => {
      state.log = button.dataset.scale === 'log';
      press(scales, (b) => b === button);
      panels.forEach((p) => p.refresh());
    }));
    const chips = engines.map((engine, e) => {
      const chip = make('button', { type: 'button', class: 'chip', 'aria-pressed': 'true' }, PinwheelCharts.swatch(engine.style), make('span', {}, engine.name), make('small', {}, engine.track));
      chip.addEventListener('click', () => {
        state.visible[e] = !state.visible[e];
        chip.setAttribute('aria-pressed', String(state.visible[e]));
        panels.forEach((p) => { p.upper.show(order.indexOf(e), state.visible[e]); p.lower.show(order.indexOf(e), state.visible[e]); p.cells[e].item.hidden = !state.visible[e]; });
      });
      return chip;
    });
    $('engine-chips').append(...chips);

    for (const shown of [$('chart-controls'), $('engine-chips'), document.querySelector('.chart-help')]) shown.hidden = false;
    data.quantities.forEach(panel);
    zoomed(time[0], time[time.length - 1]);
    document.querySelectorAll('.swatch').forEach((mark) => mark.append(PinwheelCharts.swatch(Number(mark.dataset.style))));
  }
})();
