// Charts from a declarative description, drawn by uPlot. Knows nothing of gears or of this page.
//
// PinwheelCharts.chart(host, spec) -> handle
// spec = {
//   x: { values, label, log, ticks, name },  values: numbers; log: logarithmic axis; ticks: the only places with a number;
//                                           name(index): what stands above the values at the cursor
//   y: { label, log, floor, zero, span, include },
//                                           floor: smallest value a log axis need show; span: smallest height of a linear one;
//                                           include: [low, high] that are always in sight
//   series: [{ label, values, style, visible, points, markers, marks, thin, band, more }],
//                                           style: number of colour and dash; points: dots, no line; marks: small ones;
//                                           markers: dots on the line; thin: a thin dashed line;
//                                           band: half width of a band about the values, a number each;
//                                           more(index): what stands behind the value at the cursor
//   height, group, describe,                group: charts that share crosshair and zoom
//   bands: [{ style, low, high }],          strips across the whole chart
//   onZoom(from, to)
// }
// handle = { update(part of a spec), show(k, on), range(from, to), redraw(), destroy() }
'use strict';
const PinwheelCharts = (() => {
  // Told apart by dash as well as by colour (see report.css).
  const DASHES = [[], [10, 4], [3, 3], [12, 3, 3, 3], [6, 2], [2, 5], [14, 3, 2, 3, 2, 3], [1, 2]];
  const COLOURS = 16;
  // Past the last dash and the last colour they begin again, with others.
  const dashOf = (style) => DASHES[(style + 3 * Math.floor(style / 8) + 3 * Math.floor(style / COLOURS)) % DASHES.length];
  // Values shown at the cursor at most.
  const MOST = 14;
  // Largest distance of a curve's sample from the cursor at which its value is shown, pixels.
  const REACH = 14;
  const groups = new Map();
  // The chart of each group under the pointer: it alone shows values.
  const pointed = new Map();

  // Custom properties may hold light-dark() or color-mix(): let the browser resolve them.
  const probe = document.createElement('i');
  probe.hidden = true;
  document.body.append(probe);
  let known = new Map();
  function colour(name) {
    if (!known.has(name)) {
      probe.style.color = `var(${name})`;
      known.set(name, getComputedStyle(probe).color);
    }
    return known.get(name);
  }
  const lineColour = (style) => colour(`--line-${style % COLOURS}`);

  const ink = () => ({ page: colour, font: getComputedStyle(document.body).fontFamily, curve: ({ style, thin }) => [lineColour(style), thin ? [4, 4] : dashOf(style)] });

  function swatch(style) {
    const dash = dashOf(style).join(' ');
    const ns = 'http://www.w3.org/2000/svg';
    const svg = document.createElementNS(ns, 'svg');
    svg.setAttribute('viewBox', '0 0 28 8');
    svg.setAttribute('width', '28');
    svg.setAttribute('height', '8');
    svg.setAttribute('aria-hidden', 'true');
    const line = document.createElementNS(ns, 'path');
    line.setAttribute('d', 'M1 4H27');
    line.setAttribute('stroke', `var(--line-${style % COLOURS})`);
    line.setAttribute('stroke-width', '2.5');
    if (dash) line.setAttribute('stroke-dasharray', dash);
    svg.append(line);
    return svg;
  }

  const SUPERSCRIPT = { '-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹' };
  function number(value, digits) {
    if (value === null || value === undefined || !Number.isFinite(value)) return '–';
    if (value === 0) return '0';
    const size = Math.abs(value);
    if (size >= 1e-3 && size < 1e5) return value.toPrecision(digits).replace('-', '−');
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    return `${mantissa.replace('-', '−')}·10${[...String(Number(exponent))].map((c) => SUPERSCRIPT[c]).join('')}`;
  }
  // Axis numbers: no more decimals than the spacing needs; powers of ten when very small or large.
  function ticks(values) {
    const some = values.filter((v) => v !== null && v !== undefined);
    if (some.length === 0) return values.map(() => '');
    const largest = Math.max(...some.map(Math.abs));
    const spacing = some.length > 1 ? Math.abs(some[1] - some[0]) : largest || 1;
    if (largest !== 0 && (largest < 1e-3 || largest >= 1e5)) {
      const digits = Math.min(6, Math.max(1, Math.floor(Math.log10(largest)) - Math.floor(Math.log10(spacing)) + 1));
      return values.map((v) => (v === null || v === undefined ? '' : v === 0 ? '0' : number(v, digits)));
    }
    let decimals = Math.min(9, Math.max(0, -Math.floor(Math.log10(spacing) + 1e-9)));
    const whole = (digits) => Math.abs(spacing * 10 ** digits - Math.round(spacing * 10 ** digits)) < 1e-6;
    if (!whole(decimals) && whole(decimals + 1)) decimals += 1; // 0.0025, 0.005, 0.0075
    return values.map((v) => (v === null || v === undefined ? '' : v.toFixed(decimals).replace('-', '−')));
  }
  // On a log axis whole decades have a line and a number, not all where there are many; 1, 2 and 5 where there are few.
  const decades = (most) => (plot, axis, low, high) => {
    const [from, to] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
    const places = [];
    if (to - from < 2) {
      for (let power = from - 1; power <= to; power += 1) for (const part of [1, 2, 5]) places.push(part * 10 ** power);
      return places.filter((v) => v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9));
    }
    const every = Math.max(1, Math.ceil((to - from + 1) / Math.max(2, Math.floor(most(plot)))));
    for (let power = Math.ceil(from / every) * every; power <= to; power += every) places.push(10 ** power);
    return places;
  };
  // All as powers of ten as soon as one would be hard to read as a number.
  const powers = (values) => {
    const parts = values.map((v) => v.toExponential(0).split('e').map(Number));
    const plain = parts.every(([, exponent]) => exponent >= -3 && exponent < 4);
    return parts.map(([mantissa, exponent], k) => (plain ? String(Number(values[k].toPrecision(1))) : power(mantissa, exponent)));
  };
  function power(mantissa, exponent) {
    if (exponent === 0) return String(mantissa);
    return `${mantissa === 1 ? '' : `${mantissa}·`}10${[...String(exponent)].map((c) => SUPERSCRIPT[c]).join('')}`;
  }

  function yRange(state) {
    return (plot, low, high) => {
      const { spec } = state;
      if (spec.y.log) {
        if (!(high > 0)) return [1e-12, 1];
        const from = Math.max(low > 0 ? low : 0, spec.y.floor || 0) || high / 10;
        const bottom = 10 ** Math.floor(Math.log10(Math.min(from, high)));
        const top = 10 ** Math.ceil(Math.log10(high) + 1e-9);
        return [bottom, Math.max(top, bottom * 10)];
      }
      if (low === null || high === null || low === undefined) return [-1, 1];
      if (spec.y.zero) { low = Math.min(low, 0); high = Math.max(high, 0); }
      for (const { band, values } of spec.series) {
        if (band) values.forEach((v, k) => { if (v !== null && band[k] !== null) { low = Math.min(low, v - band[k]); high = Math.max(high, v + band[k]); } });
      }
      for (const strip of spec.bands || []) { low = Math.min(low, strip.low); high = Math.max(high, strip.high); }
      if (spec.y.include) { low = Math.min(low, spec.y.include[0]); high = Math.max(high, spec.y.include[1]); }
      const short = (spec.y.span || 0) - (high - low);
      if (short > 0) { low -= short / 2; high += short / 2; }
      const breadth = high - low || Math.abs(high) * 0.01 || 1;
      return [low - 0.06 * breadth, high + 0.06 * breadth];
    };
  }

  // Places for numbers that do not run into each other.
  function thinned(places, width, log) {
    const at = (v) => (log ? Math.log10(v) : v);
    const span = at(places[places.length - 1]) - at(places[0]) || 1;
    const kept = [];
    for (const v of places) if (kept.length === 0 || ((at(v) - at(kept[kept.length - 1])) / span) * width > 64) kept.push(v);
    return kept;
  }

  // On paper a chart is as wide as its column, and lower.
  const height = (spec) => (document.documentElement.matches('.printing') ? 0.7 : 1) * spec.height;

  function options(host, state) {
    const { spec } = state;
    const font = getComputedStyle(document.body).fontFamily;
    const axis = {
      stroke: () => colour('--ink-soft'),
      grid: { stroke: () => colour('--rule'), width: 1 },
      ticks: { stroke: () => colour('--rule'), width: 1, size: 5 },
      font: `12px ${font}`,
      labelFont: `12px ${font}`,
      labelSize: 22,
      labelGap: 2,
    };
    const measure = document.createElement('canvas').getContext('2d');
    measure.font = axis.font;
    return {
      width: Math.max(host.clientWidth, 120),
      height: height(spec),
      legend: { show: false },
      padding: [12, 26, 0, 0],
      scales: {
        x: { time: false, distr: spec.x.log ? 3 : 1 },
        y: { distr: spec.y.log ? 3 : 1, range: yRange(state) },
      },
      cursor: {
        sync: spec.group ? { key: spec.group, setSeries: false } : undefined,
        drag: { x: true, y: false, dist: 6, setScale: true },
        points: { size: 7, width: 0 },
      },
      axes: [
        { ...axis, label: spec.x.label, size: 34, values: (u, v) => (spec.x.log && !spec.x.ticks ? powers(v) : ticks(v)), ...(spec.x.ticks ? { splits: () => thinned(spec.x.ticks, host.clientWidth, spec.x.log), filter: (u, v) => v } : spec.x.log ? { splits: decades((u) => u.width / 70), filter: (u, v) => v } : {}) },
        {
          ...axis,
          label: spec.y.label,
          values: (u, v) => (spec.y.log ? powers(v) : ticks(v)),
          ...(spec.y.log ? { splits: decades((u) => (u.height - 70) / 20), filter: (u, v) => v } : {}),
          // One width for most charts, so that those above each other line up.
          size: (u, texts) => 14 + Math.ceil(Math.max(40, ...(texts || []).map((t) => measure.measureText(t).width))),
        },
      ],
      series: [{}].concat(spec.series.map((series) => ({
        label: series.label,
        show: series.visible !== false,
        stroke: () => lineColour(series.style),
        width: series.points || series.marks ? 0 : series.thin ? 1 : 1.6,
        dash: series.thin ? [4, 4] : dashOf(series.style),
        points: series.points || series.markers || series.marks ? { show: true, size: series.points ? 9 : series.marks ? 3.5 : 7, ...(series.marks ? { width: 0 } : {}), fill: () => lineColour(series.style) } : { show: false },
      }))),
      hooks: {
        drawClear: [(u) => strips(u, state)],
        setCursor: [(u) => tip(u, state)],
        setScale: [(u, key) => {
          if (key === 'x' && !state.told) follow(state, u.scales.x.min, u.scales.x.max);
        }],
      },
    };
  }

  // Bands lie under the lines: of a series about its values, or across the whole chart.
  function strips(u, state) {
    const { ctx } = u;
    const fill = (style, edge) => {
      ctx.save();
      ctx.beginPath();
      ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
      ctx.clip();
      ctx.beginPath();
      edge();
      ctx.closePath();
      ctx.globalAlpha = 0.2;
      ctx.fillStyle = lineColour(style);
      ctx.fill();
      ctx.restore();
    };
    const y = (v) => u.valToPos(v, 'y', true);
    for (const { style, low, high } of state.spec.bands || []) fill(style, () => ctx.rect(u.bbox.left, y(high), u.bbox.width, y(low) - y(high)));
    const xs = state.spec.x.values;
    state.spec.series.forEach((series) => {
      if (!series.band || series.visible === false) return;
      const some = xs.map((x, k) => [x, series.values[k], series.band[k]]).filter(([, v, b]) => Number.isFinite(v) && Number.isFinite(b) && !(state.spec.y.log && v <= b));
      const side = (sign) => ([x, v, b]) => ctx.lineTo(u.valToPos(x, 'x', true), y(v + sign * b));
      fill(series.style, () => { some.forEach(side(1)); some.reverse().forEach(side(-1)); });
    });
  }

  // The sample of a series nearest to the cursor: its own one there, or one that is within reach.
  function near(u, values, index) {
    const x = u.data[0];
    const left = u.valToPos(x[index], 'x');
    const close = (k) => Math.abs(u.valToPos(x[k], 'x') - left) <= REACH;
    for (let away = 0, open = true; open; away += 1) {
      open = false;
      for (const k of [index - away, index + away]) {
        if (k < 0 || k >= x.length || !close(k)) continue;
        if (values[k] !== null && values[k] !== undefined) return k;
        open = true;
      }
    }
    return null;
  }

  // Every visible value at the cursor, in the order in which the lines lie there.
  function tip(u, state) {
    const { box, spec } = state;
    const index = u.cursor.left >= 0 ? u.cursor.idx : null;
    const other = spec.group && pointed.get(spec.group) !== state;
    if (other || index === null || index === undefined) { box.hidden = true; return; }
    const rows = [];
    spec.series.forEach((series, k) => {
      if (series.visible === false || !u.series[k + 1].show) return;
      const at = near(u, series.values, index);
      if (at !== null) rows.push({ series, at, value: series.values[at] });
    });
    if (rows.length > MOST) {
      const level = u.posToVal(u.cursor.top, 'y');
      rows.sort((a, b) => Math.abs(a.value - level) - Math.abs(b.value - level));
      rows.length = MOST;
    }
    rows.sort((a, b) => b.value - a.value);
    const cell = (name, text) => { const e = document.createElement('span'); e.className = name; e.textContent = text; return e; };
    const name = spec.x.name ? spec.x.name(index) : `${number(u.data[0][index], 5)}`;
    box.replaceChildren(cell('at', name), ...rows.flatMap(({ series, at, value }) => [
      swatch(series.style), cell('who', series.label), cell('value', number(value, 5)), cell('more', series.more ? series.more(at) : ''),
    ]));
    box.hidden = false;
    // Beside the cursor, on the side where there is room.
    const [wide, high] = [box.offsetWidth, box.offsetHeight];
    const { clientWidth: width, clientHeight: height } = u.over;
    const right = u.cursor.left + 18 + wide <= width + 20;
    box.style.left = `${u.over.offsetLeft + (right ? u.cursor.left + 18 : Math.max(-u.over.offsetLeft, u.cursor.left - wide - 18))}px`;
    box.style.top = `${u.over.offsetTop + Math.max(0, Math.min(u.cursor.top - high / 2, Math.max(0, height - high)))}px`;
    state.text = `${name}: ${rows.map(({ series, value }) => `${series.label} ${number(value, 5)}`).join(', ')}`;
  }

  // Charts of a group show the same stretch, whichever of them was zoomed.
  function follow(leader, from, to) {
    if (from === null || from === undefined || !leader.spec.group) return;
    for (const other of groups.get(leader.spec.group) || []) {
      if (other === leader) continue;
      const scale = other.plot.scales.x;
      if (scale.min === from && scale.max === to) continue;
      other.told = true;
      other.plot.batch(() => other.plot.setScale('x', { min: from, max: to }));
      // uPlot applies scales in a microtask; later ones are the user's again.
      queueMicrotask(() => queueMicrotask(() => { other.told = false; }));
    }
    if (leader.spec.onZoom) leader.spec.onZoom(from, to);
  }

  function keys(host, state) {
    host.addEventListener('keydown', (event) => {
      pointed.set(state.spec.group, state);
      const { plot } = state;
      const { min, max } = plot.scales.x;
      const breadth = max - min;
      const current = plot.cursor.idx ?? plot.valToIdx((min + max) / 2);
      const step = Math.max(1, Math.round((plot.valToIdx(max) - plot.valToIdx(min)) / (event.shiftKey ? 20 : 200)));
      const cursor = (index) => {
        const bounded = Math.min(plot.valToIdx(max), Math.max(plot.valToIdx(min), index));
        plot.setCursor({ left: plot.valToPos(plot.data[0][bounded], 'x'), top: plot.over.clientHeight / 2 }, true, true);
        state.said.textContent = state.text;
      };
      const actions = {
        ArrowLeft: () => cursor(current - step),
        ArrowRight: () => cursor(current + step),
        '+': () => state.handle.range(min + breadth / 4, max - breadth / 4),
        '-': () => state.handle.range(min - breadth / 2, max + breadth / 2),
        0: () => state.handle.range(null, null),
        Escape: () => plot.setCursor({ left: -10, top: -10 }, true, true),
      };
      const action = actions[event.key === '=' ? '+' : event.key];
      if (action) { action(); event.preventDefault(); }
    });
  }

  // One finger reads values; the page still scrolls up and down.
  function touch(state) {
    const { over } = state.plot;
    over.style.touchAction = 'pan-y';
    // Before the plotting library sees it, and so before values are said.
    for (const kind of ['pointerenter', 'pointerdown', 'pointermove', 'mousemove']) over.addEventListener(kind, () => pointed.set(state.spec.group, state), { capture: true });
    const move = (event) => {
      if (event.pointerType !== 'touch') return;
      const box = over.getBoundingClientRect();
      state.plot.setCursor({ left: event.clientX - box.left, top: event.clientY - box.top });
    };
    over.addEventListener('pointerdown', move);
    over.addEventListener('pointermove', move);
  }

  function chart(host, first) {
    const state = { spec: { height: 240, ...first }, told: false };
    const data = () => [state.spec.x.values].concat(state.spec.series.map((s) => s.values));
    function build() {
      const kept = state.plot && { ...state.plot.scales.x };
      if (state.plot) state.plot.destroy();
      state.told = true;
      state.plot = new uPlot(options(host, state), data(), host);
      state.plot.root.querySelector('.u-wrap').append(state.box);
      state.box.hidden = true;
      if (kept && kept.min !== undefined && kept.min !== null) state.plot.setScale('x', { min: kept.min, max: kept.max });
      queueMicrotask(() => queueMicrotask(() => { state.told = false; }));
      touch(state);
    }
    state.box = document.createElement('div');
    state.box.className = 'tip';
    // Read aloud when keys move the cursor, not when a mouse does.
    state.said = document.createElement('span');
    state.said.className = 'unseen';
    state.said.setAttribute('aria-live', 'polite');
    host.after(state.said);
    host.before(PinwheelExport.menu(state, ink()));
    host.tabIndex = 0;
    host.setAttribute('role', 'img');
    if (state.spec.describe) host.setAttribute('aria-label', state.spec.describe);
    build();
    keys(host, state);
    const observer = new ResizeObserver(() => {
      const width = Math.max(host.clientWidth, 120);
      if (width !== state.plot.width) state.plot.setSize({ width, height: height(state.spec) });
    });
    observer.observe(host);
    if (state.spec.group) {
      if (!groups.has(state.spec.group)) groups.set(state.spec.group, new Set());
      groups.get(state.spec.group).add(state);
    }
    state.handle = {
      /** New values or axes; the stretch shown stays. */
      update(part) {
        const log = state.spec.y.log;
        state.spec = { ...state.spec, ...part };
        if (part.describe) host.setAttribute('aria-label', part.describe);
        if (part.series === undefined && part.y === undefined && part.x === undefined) return;
        if (Boolean(log) !== Boolean(state.spec.y.log) || (part.y && part.y.label !== state.plot.axes[1].label)
          || part.x !== undefined || state.spec.series.length + 1 !== state.plot.series.length) {
          build();
          return;
        }
        const { min, max } = state.plot.scales.x;
        state.told = true;
        state.plot.batch(() => {
          state.plot.setData(data(), false);
          state.plot.setScale('x', { min, max });
        });
        queueMicrotask(() => queueMicrotask(() => { state.told = false; }));
      },
      /** Shows or hides one series. */
      show(index, on) {
        state.spec.series[index].visible = on;
        state.plot.setSeries(index + 1, { show: on });
      },
      /** Shows the stretch from..to; null for everything. */
      range(from, to) {
        const x = state.spec.x.values;
        const first = x[0];
        const last = x[x.length - 1];
        state.plot.setScale('x', { min: from === null ? first : Math.max(first, from), max: to === null ? last : Math.min(last, to) });
      },
      /** The stretch shown. */
      shown() { return [state.plot.scales.x.min, state.plot.scales.x.max]; },
      /** After a change of colours. */
      redraw() { known = new Map(); build(); },
      destroy() {
        observer.disconnect();
        if (state.spec.group) groups.get(state.spec.group).delete(state);
        state.plot.destroy();
        state.said.remove();
      },
    };
    return state.handle;
  }

  return { chart, swatch, number };
})();
