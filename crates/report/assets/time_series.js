// Time series of several runs, one quantity at a time.
'use strict';
(() => {
  const { $, make, onRedraw } = PinwheelPage;
  const data = JSON.parse($('chart-data').textContent);
  const { engines, windows, quantities } = data;
  const spaced = ({ from, step, count, at }) => at || Array.from({ length: count }, (_, k) => from + k * step);
  const time = spaced(data.time);
  const [begin, end] = [time[0], time[time.length - 1]];
  engines.forEach((engine) => { engine.places = spaced(engine.places); });

  // One channel of every engine on the samples that are kept: values of the first that has it, the others' differences to it.
  // Unpacked when first shown.
  const unpacked = new Map();
  async function channel(quantity, index) {
    const key = `${quantity.name} ${index}`;
    if (!unpacked.has(key)) {
      const { packed, engines: having } = quantity.channels[index];
      const read = PinwheelPacked.reader(await PinwheelPacked.unpack(packed));
      const kept = read.places();
      const count = kept.length || time.length;
      const where = kept.length ? new Map(kept.map((place, k) => [place, k])) : { get: (place) => place };
      const columns = engines.map(() => null);
      for (const e of having) {
        const column = new Float64Array(count).fill(NaN);
        const places = engines[e].places.map((place) => where.get(place)).filter((k) => k !== undefined);
        read.column().forEach((value, k) => { column[places[k]] = value; });
        columns[e] = column;
      }
      const first = columns[having[0]];
      columns[having[0]] = first.map((v) => (Number.isFinite(v) ? 0 : NaN));
      unpacked.set(key, { x: kept.length ? kept.map((place) => time[place]) : time, first, differences: columns });
    }
    return unpacked.get(key);
  }
  // Values that are not finite, or after the end of a run that broke off, are gaps.
  const gapped = (length, value) => Array.from({ length }, (_, k) => { const v = value(k); return Number.isFinite(v) ? v : null; });
  const signed = (from, e, base, k) => (from.differences[e] && from.differences[base] ? from.differences[e][k] - from.differences[base][k] : NaN);
  // A log axis need not show every zero crossing: two decades below the smallest median will do.
  const floor = (columns) => {
    const medians = columns.map((c) => c.filter((v) => v > 0).sort((a, b) => a - b)).filter((c) => c.length > 0).map((c) => c[c.length >> 1]);
    return medians.length ? Math.min(...medians) / 100 : 0;
  };

  const [shown, which, base] = data.first;
  const state = { quantity: shown, channel: which, base, log: engines[base].track !== 'measured', visible: engines.map(() => true) };
  // Curves of engines with contacts of their own are drawn first, under the others; marks lie on top.
  const rank = (e) => (engines[e].marks ? 2 : engines[e].track === 'own-contact' ? 0 : 1);
  const order = engines.map((_, e) => e).sort((a, b) => rank(a) - rank(b) || a - b);

  const [top, bottom, under] = [make('div', { class: 'plot' }), make('div', { class: 'plot' }), make('p', { class: 'plot-title' })];
  const over = make('h3', {});
  // One run differs from nothing.
  const others = engines.length > 1;
  $('chart').append(over, top, ...(others ? [under, bottom] : []));
  for (const control of ['base', 'scales', 'legend']) ($(control).closest('.control') || $(control)).hidden = !others;
  let [upper, lower, zoomed] = [null, null, () => {}];

  async function draw() {
    const asked = { ...state };
    const quantity = quantities[asked.quantity];
    const from = await channel(quantity, asked.channel);
    if (asked.quantity !== state.quantity || asked.channel !== state.channel) return;
    const unit = quantity.unit ? ` (${quantity.unit})` : '';
    const name = quantity.channels.length > 1 ? `${quantity.label} no. ${quantity.channels[asked.channel].label}` : quantity.label;
    const count = from.x.length;
    const lines = (values, more) => order.map((e) => ({ label: engines[e].name, style: engines[e].style, visible: state.visible[e], marks: engines[e].marks, values: gapped(count, values(e)), more: more(e) }));
    const delta = (e) => (k) => { const d = e === state.base ? NaN : signed(from, e, state.base, k); return Number.isFinite(d) ? `Δ\u202f${PinwheelCharts.number(d, 2)}` : ''; };
    const values = lines((e) => (k) => (from.differences[e] ? from.first[k] + from.differences[e][k] : NaN), delta);
    const apart = lines((e) => (k) => {
      const d = e === state.base ? NaN : signed(from, e, state.base, k);
      return state.log ? (d === 0 ? NaN : Math.abs(d)) : d;
    }, () => () => '');
    // The budget of a comparison with measured data, about what it is measured from.
    const budgets = (quantity.bands || []).filter(([a, b]) => !state.log && (a === state.base || b === state.base));
    const bands = budgets.map(([a, b, half]) => ({ style: engines[a === state.base ? b : a].style, low: -half, high: half }));
    over.textContent = name;
    under.textContent = `Difference to ${engines[state.base].name}${budgets.length ? ': the residual, and its budget of uncertainty as a strip (about 95 %)' : ''}`;
    const x = { values: from.x, label: 'Time (s)', name: (k) => `t = ${Number(from.x[k].toFixed(6))} s` };
    const y = { label: `${state.log ? '|difference|' : 'Difference'}${unit}`, log: state.log, zero: !state.log, floor: state.log ? floor(apart.map((s) => s.values)) : 0 };
    const describe = `${name} over time: ${engines.map((e) => e.name).join(', ')}`;
    const first = { x, y: { label: `${quantity.label}${unit}` }, series: values, describe };
    const second = { x, y, series: apart, bands, describe: `Differences to ${engines[state.base].name}: ${describe}` };
    if (upper === null) {
      upper = PinwheelCharts.chart(top, { ...first, height: 320, group: 'time', onZoom: (a, b) => zoomed(a, b) });
      if (others) lower = PinwheelCharts.chart(bottom, { ...second, height: 220, group: 'time' });
      onRedraw(() => { upper.redraw(); lower?.redraw(); });
      zoomed(begin, end);
      // The first view is the steady state.
      const steady = windows.find((w) => w.kind === 'steady');
      if (steady) upper.range(steady.from, steady.to);
    } else {
      upper.update(first);
      lower?.update(second);
    }
    document.body.dataset.drawn = name;
  }

  // ---- What can be chosen -----------------------------------------------------------------------
  const press = (buttons, on) => buttons.forEach((b) => b.setAttribute('aria-pressed', String(on(b))));
  const options = (select, labels, chosen) => select.replaceChildren(...labels.map((label, k) => make('option', { value: k, selected: k === chosen }, label)));
  const [quantitySelect, channelSelect, baseSelect] = [$('quantity'), $('channel'), $('base')];
  function channels() {
    const { channels: list } = quantities[state.quantity];
    options(channelSelect, list.map((c) => `no. ${c.label}`), state.channel);
    channelSelect.hidden = list.length < 2;
  }
  options(quantitySelect, quantities.map((q) => q.label), state.quantity);
  options(baseSelect, engines.map((e) => e.name), state.base);
  channels();
  quantitySelect.addEventListener('change', () => { state.quantity = Number(quantitySelect.value); state.channel = 0; channels(); draw(); });
  channelSelect.addEventListener('change', () => { state.channel = Number(channelSelect.value); draw(); });
  baseSelect.addEventListener('change', () => { state.base = Number(baseSelect.value); draw(); });
  const scales = [...document.querySelectorAll('[data-scale]')];
  const scale = () => press(scales, (b) => (b.dataset.scale === 'log') === state.log);
  scales.forEach((button) => button.addEventListener('click', () => { state.log = button.dataset.scale === 'log'; scale(); draw(); }));
  scale();
  const offered = [{ kind: 'all', from: null, to: null }, ...windows];
  const windowButtons = offered.map((w) => make('button', { type: 'button', 'aria-pressed': 'false' }, w.kind));
  windowButtons.forEach((button, k) => button.addEventListener('click', () => upper.range(offered[k].from, offered[k].to)));
  $('windows').append(...windowButtons);
  zoomed = (from, to) => {
    const near = (a, b) => Math.abs(a - b) <= 1e-6 * (end - begin);
    press(windowButtons, (b) => {
      const w = offered[windowButtons.indexOf(b)];
      return near(from, w.from ?? begin) && near(to, w.to ?? end);
    });
  };
  document.querySelectorAll('[data-zoom]').forEach((button) => button.addEventListener('click', () => {
    const [from, to] = upper.shown();
    const breadth = to - from;
    const [a, b] = { in: [0.25, -0.25], out: [-0.5, 0.5], left: [-0.5, -0.5], right: [0.5, 0.5] }[button.dataset.zoom];
    let [low, high] = [from + a * breadth, to + b * breadth];
    if (button.dataset.zoom === 'left' && low < begin) [low, high] = [begin, begin + breadth];
    if (button.dataset.zoom === 'right' && high > end) [low, high] = [end - breadth, end];
    upper.range(low, high);
  }));
  const see = (e, on) => {
    state.visible[e] = on;
    chips[e].setAttribute('aria-pressed', String(on));
    for (const chart of [upper, lower]) chart?.show(order.indexOf(e), on);
    press(groups, (b) => engines.some((engine, k) => engine.track === b.dataset.track && state.visible[k]));
  };
  const chips = engines.map((engine, e) => {
    const chip = make('button', { type: 'button', class: 'chip', 'aria-pressed': 'true' }, PinwheelCharts.swatch(engine.style), make('span', {}, engine.name), make('small', {}, engine.marks ? 'recorded' : engine.track === 'measured' ? 'measured' : ''));
    chip.addEventListener('click', () => see(e, !state.visible[e]));
    return chip;
  });
  $('legend').append(...chips);
  // Groups by what engines share; one group needs no button.
  const tracks = [['native', 'Native'], ['shared-law', 'Shared law'], ['own-contact', 'Own contact'], ['measured', 'Measured']].filter(([track]) => engines.some((engine) => engine.track === track));
  const groups = tracks.map(([track, label]) => make('button', { type: 'button', 'aria-pressed': 'true', 'data-track': track }, label));
  groups.forEach((button) => button.addEventListener('click', () => {
    const on = button.getAttribute('aria-pressed') !== 'true';
    engines.forEach((engine, e) => { if (engine.track === button.dataset.track) see(e, on); });
  }));
  if (groups.length > 1) $('groups').append(...groups);
  else $('groups').parentElement.hidden = true;
  for (const element of [$('chart-controls'), document.querySelector('.chart-help')]) element.hidden = false;
  document.querySelectorAll('.swatch').forEach((mark) => mark.append(PinwheelCharts.swatch(Number(mark.dataset.style))));
  draw();
})();
