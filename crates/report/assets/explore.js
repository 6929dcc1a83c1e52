// A scene under a hand: sliders of two states, each asked of the program that serves this page.
//
// One question is under way at a time, and the newest values are asked next: what a hand passed over is never computed.
// The states stand in the address, so that a page that is loaded again shows them again.
'use strict';
document.addEventListener('DOMContentLoaded', () => {
  const { $, make, onRedraw } = PinwheelPage;
  const { first, sliders } = JSON.parse($('explore-data').textContent);
  const LAW = 'contact.law';
  const law = $('law');
  const NAMES = ['a', 'b'];
  const begun = () => ({ ...Object.fromEntries(sliders.map((s) => [s.key, s.value])), [LAW]: law.value });
  const own = begun();
  const states = { a: begun(), b: begun() };
  const found = { a: first, b: first };
  const blocked = { a: '', b: '' };
  let now = 'b';
  let moved = sliders[0].key;
  /** Times from a hand's move to the drawn answer, ms. */
  const latencies = (window.pinwheelLatencies = []);

  async function ask(path, body) {
    const answer = await fetch(path, body === undefined ? {} : { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body) });
    if (!answer.ok) throw new Error(await answer.text());
    return answer.json();
  }
  const say = (text) => { $('said').textContent = text; };
  const gone = (error) => say(`The program does not answer: ${error.message}. Start it again; this address keeps both states.`);
  // What is as the scene has it is not sent: the file's own digits count.
  const values = (state) => Object.entries(state).filter(([key, value]) => value !== own[key]).map(([key, value]) => {
    const slider = sliders.find((s) => s.key === key);
    return [key, slider ? String(Number((value / slider.factor).toPrecision(12))) : value];
  });

  // ---- Sliders
  const inputs = new Map();
  for (const slider of sliders) {
    const step = Number(((slider.to - slider.from) / 200).toPrecision(2));
    const id = slider.key.replaceAll('.', '-');
    const input = make('input', { type: 'range', id, min: slider.from, max: slider.to, step: 'any', value: slider.value });
    const shown = make('output', { for: id });
    const reason = make('p', { class: 'reason', role: 'alert' });
    const told = (value) => {
      shown.textContent = `${PinwheelCharts.number(value, 4)} ${slider.unit}`;
      input.setAttribute('aria-valuetext', shown.textContent);
    };
    input.addEventListener('input', () => {
      const raw = Number(input.value);
      const value = Math.abs(raw - own[slider.key]) < step / 2 ? own[slider.key] : Number((Math.round(raw / step) * step).toPrecision(6));
      told(value);
      change(slider.key, value);
    });
    $('sliders').append(make('div', { class: 'slider' }, make('label', { for: id }, slider.label), shown, input, reason));
    inputs.set(slider.key, { set: (value) => { input.value = value; told(value); }, reason });
  }
  inputs.set(LAW, { set: (value) => { law.value = value; }, reason: $('reason-law') });
  law.addEventListener('change', () => change(LAW, law.value));

  function change(key, value) {
    states[now][key] = value;
    moved = key;
    due[now] = performance.now();
    remember();
    pump();
  }
  function remember() {
    history.replaceState(null, '', `#${encodeURIComponent(JSON.stringify({ now, a: values(states.a), b: values(states.b) }))}`);
  }
  function recall() {
    try {
      const kept = JSON.parse(decodeURIComponent(location.hash.slice(1)));
      for (const name of NAMES) {
        for (const [key, value] of kept[name]) {
          const slider = sliders.find((s) => s.key === key);
          if (slider) states[name][key] = Number((Number(value) * slider.factor).toPrecision(12));
          else if (key === LAW) states[name][key] = value;
        }
      }
      if (NAMES.includes(kept.now)) now = kept.now;
      for (const name of NAMES) due[name] = performance.now();
    } catch { /* an address without states */ }
  }

  // ---- Answers
  const due = { a: null, b: null };
  let busy = false;
  async function pump() {
    if (busy) return;
    const name = [now, ...NAMES].find((one) => due[one] !== null);
    if (name === undefined) return;
    busy = true;
    document.body.dataset.busy = '';
    const since = due[name];
    due[name] = null;
    try {
      const answer = await ask('run', values(states[name]));
      blocked[name] = answer.reason || '';
      if (!answer.reason) {
        found[name] = answer;
        await host.replace(NAMES.indexOf(name), answer.view);
        figures();
        series();
      }
      reasons();
      latencies.push(performance.now() - since);
    } catch (error) { gone(error); }
    busy = false;
    delete document.body.dataset.busy;
    document.body.dataset.answered = String(Number(document.body.dataset.answered || 0) + 1);
    pump();
  }
  // A reason stands where the hand is.
  function reasons() {
    for (const [key, { reason }] of inputs) reason.textContent = key === moved ? blocked[now] : '';
    document.querySelector('.seen').classList.toggle('stale', Boolean(blocked[now]));
  }
  function figures() {
    const number = (value) => (value === null ? '–' : PinwheelCharts.number(value, 4));
    $('figures').replaceChildren(...found.a.figures.map(([what, a, unit], k) => {
      const b = found.b.figures[k]?.[1] ?? null;
      const change = a && b !== null ? `${b >= a ? '+' : '−'}${PinwheelCharts.number(Math.abs(100 * (b / a - 1)), 3)} %` : '';
      const cells = [number(a), number(b), change].map((text) => make('td', { class: 'num' }, text));
      return make('tr', {}, make('th', { scope: 'row' }, `${what} (${unit})`), ...cells);
    }));
  }
  const charts = new Map();
  function series() {
    for (const label of Object.keys(first.series)) {
      const lines = NAMES.map((name, k) => ({ label: name.toUpperCase(), style: k === 0 ? 0 : 6, values: found[name].series[label] || [], visible: true }));
      const spec = { x: { values: first.time, label: 'Time (s)', name: (k) => `t = ${PinwheelCharts.number(first.time[k], 4)} s` }, y: { label }, series: lines, describe: `${label} of both states over a turn` };
      if (charts.has(label)) charts.get(label).update(spec);
      else {
        const plot = make('div', { class: 'plot' });
        $('series').append(make('article', { class: 'panel' }, make('h3', {}, label), plot));
        charts.set(label, PinwheelCharts.chart(plot, { ...spec, height: 180, group: 'explore' }));
      }
    }
  }

  // ---- What else can be done
  const buttons = [...document.querySelectorAll('[data-state]')];
  function turn(name) {
    now = name;
    buttons.forEach((b) => b.setAttribute('aria-pressed', String(b.dataset.state === now)));
    for (const [key, { set }] of inputs) set(states[now][key]);
    reasons();
    remember();
  }
  buttons.forEach((b) => b.addEventListener('click', () => turn(b.dataset.state)));
  $('same').addEventListener('click', () => {
    const other = now === 'a' ? 'b' : 'a';
    states[other] = { ...states[now] };
    due[other] = performance.now();
    remember();
    pump();
  });
  $('save').addEventListener('click', () => ask('save', values(states[now])).then(({ file, reason }) => say(file ? `State ${now.toUpperCase()} is in ${file}` : reason)).catch(gone));
  $('compare').addEventListener('click', () => ask('compare', values(states[now])).then(({ reason }) => say(reason || 'Compares')).catch(gone));
  let stamp = null;
  async function watch() {
    try {
      const told = await ask('status');
      if (stamp !== null && told.stamp !== stamp) {
        say('The scene was saved anew: both states follow.');
        NAMES.forEach((name) => { due[name] = performance.now(); });
        pump();
      }
      stamp = told.stamp;
      if (told.page) {
        const link = make('a', { href: told.page, target: '_blank' }, 'see the comparison');
        if (!$('said').querySelector('a')) $('said').replaceChildren('Compared: ', link, ` (${told.place})`);
      } else if (told.compares) say(told.compares);
    } catch (error) { gone(error); }
    setTimeout(watch, 1000);
  }

  const host = document.querySelector('.gearboxes');
  const ready = () => (host.dataset.ready === undefined ? setTimeout(ready, 10) : begin());
  function begin() {
    recall();
    turn(now);
    figures();
    series();
    onRedraw(() => charts.forEach((one) => one.redraw()));
    document.body.dataset.explore = '';
    pump();
    watch();
  }
  ready();
});
