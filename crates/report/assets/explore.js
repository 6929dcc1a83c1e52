// A scene under a hand: sliders of two states, each asked of the program that serves this page.
//
// One run is under way at a time, and the newest values are asked next: what a hand passed over is never computed. Balances
// come with it, or are asked for when the hand rests; until they are there their figures are said to be computed, and none is
// shown.
// The states stand in the address and in the browser's store, so that nothing is lost by loading again or by the program's end.
'use strict';
document.addEventListener('DOMContentLoaded', () => {
  const { $, make, save, onRedraw } = PinwheelPage;
  const { first, sliders, rigid } = JSON.parse($('explore-data').textContent);
  const LAW = 'contact.law';
  const law = $('law');
  const NAMES = ['a', 'b'];
  const begun = () => ({ ...Object.fromEntries(sliders.map((s) => [s.key, s.value])), [LAW]: law.value });
  const own = begun();
  const states = { a: begun(), b: begun() };
  /** The state shown of each gear, and the values requested for it; `figures` is null while figures are computed, `ran`, `banded`
   * and `sampled` are false while motion, bands and the sample of tolerances are. */
  const fresh = (asked) => ({ asked, figures: null, ran: false, banded: false, sampled: false });
  const found = { a: { ...first, ...fresh([]), ran: true }, b: { ...first, ...fresh([]), ran: true } };
  const blocked = { a: '', b: '' };
  const moved = { a: sliders[0].key, b: sliders[0].key };
  let now = 'b';
  const STORE = `pinwheel explore ${document.title}`;
  /** Idle time before the states are saved, ms. */
  const REST = 200;
  const TAB = Math.random().toString(36).slice(2);
  /** Times from a hand's move to the drawn answer, ms. */
  const latencies = (window.pinwheelLatencies = []);

  // A POST request carries a key that other servers on this machine do not see, as cookies are for all of them. A page in a
  // frame has none.
  const key = () => { try { return localStorage.getItem('pinwheel key') || ''; } catch { return ''; } };
  async function ask(path, body, signal) {
    const headers = { 'Content-Type': 'application/json', 'X-Pinwheel-Key': key() };
    const answer = await fetch(path, body === undefined ? {} : { method: 'POST', signal, headers, body: JSON.stringify(body) });
    if (!answer.ok) throw new Error(await answer.text());
    return answer.json();
  }
  const say = (text) => { $('said').textContent = text; };
  const gone = (error) => say(`The program does not answer: ${error.message}. Start it again; both states are kept.`);
  // Values that equal the scene's are not sent, so that the file's own digits count.
  const values = (state) => Object.entries(state).filter(([key, value]) => value !== own[key]).map(([key, value]) => {
    const slider = sliders.find((s) => s.key === key);
    return [key, slider && value !== rigid ? String(Number((value / slider.factor).toPrecision(12))) : value];
  });

  // ---- Sliders
  const inputs = new Map();
  for (const slider of sliders) {
    const step = slider.whole ? 1 : Number(((slider.to - slider.from) / 200).toPrecision(2));
    const id = slider.key.replaceAll('.', '-');
    const input = make('input', { type: 'range', id, min: slider.from, max: slider.to, step: 'any' });
    const typed = make('input', { type: 'text', inputmode: 'decimal', autocomplete: 'off', 'aria-label': `${slider.label} (${slider.unit || 'number'})` });
    const reason = make('p', { class: 'reason', role: 'alert' });
    const short = (value) => (Math.abs(value) < 1e6 ? String(value) : Number(value.toPrecision(4)).toExponential().replace('+', ''));
    const told = (value) => {
      typed.value = value === rigid ? rigid : short(Number(value.toPrecision(5)));
      input.setAttribute('aria-valuetext', `${typed.value} ${slider.unit}`);
    };
    // Position of the thumb for a value, and the value for a position.
    const place = (value) => (value === rigid ? slider.to : slider.decades ? Math.log10(value) : value);
    const at = (raw) => {
      if (Math.abs(raw - place(own[slider.key])) < step / 2) return own[slider.key];
      if (!slider.decades) return Number((Math.round(raw / step) * step).toPrecision(6));
      return raw > slider.to - step / 2 ? rigid : Number((10 ** raw).toPrecision(2));
    };
    input.addEventListener('input', () => {
      const value = at(Number(input.value));
      told(value);
      change(slider.key, value);
    });
    const set = (value) => { input.value = place(value); told(value); };
    // A typed number may lie beyond the slider's ends.
    typed.addEventListener('change', () => {
      const text = typed.value.trim().replace(',', '.').replace('−', '-');
      const value = slider.decades && text === rigid ? rigid : Number(text);
      if (text === '' || Number.isNaN(value)) {
        moved[now] = slider.key;
        blocked[now] = `“${typed.value}” is no number`;
        reasons();
      } else {
        set(value);
        change(slider.key, value);
      }
    });
    $('sliders').append(make('div', { class: 'slider' }, make('label', { for: id }, slider.label), typed, make('span', {}, slider.unit), input, reason));
    inputs.set(slider.key, { set, reason });
  }
  inputs.set(LAW, { set: (value) => { law.value = value; }, reason: $('reason-law') });
  law.addEventListener('change', () => change(LAW, law.value));

  function change(key, value) {
    states[now][key] = value;
    moved[now] = key;
    due[now] = performance.now();
    remember(true);
    pump();
  }
  // A hand that moves is not written down at every step of it: the browser takes longer for that than for all figures.
  let resting = 0;
  let anew = false;
  /** Number of the step that is shown, and of the last one: Back and Forward of the browser undo and redo a rest of the hand. */
  let [step, last] = [history.state ?? 0, history.state ?? 0];
  function remember(isStep = false) {
    anew ||= isStep;
    clearTimeout(resting);
    resting = setTimeout(keep, REST);
  }
  window.addEventListener('pagehide', () => { if (resting) keep(); });
  const packed = () => JSON.stringify({ now, moved, a: values(states.a), b: values(states.b) });
  function keep() {
    clearTimeout(resting);
    resting = 0;
    const kept = packed();
    if (anew) last = step += 1;
    history[anew ? 'pushState' : 'replaceState'](step, '', `#${encodeURIComponent(kept)}`);
    anew = false;
    steps();
    try { localStorage.setItem(STORE, kept); } catch { /* a browser that stores nothing */ }
  }
  function steps() {
    $('undo').disabled = step === 0;
    $('redo').disabled = step === last;
  }
  const undo = () => { if (resting) keep(); if (step > 0) history.back(); };
  const redo = () => { if (step < last) history.forward(); };
  $('undo').addEventListener('click', undo);
  $('redo').addEventListener('click', redo);
  document.addEventListener('keydown', (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    const action = key === 'y' || (key === 'z' && event.shiftKey) ? redo : key === 'z' ? undo : null;
    if (action) { event.preventDefault(); action(); }
  });
  window.addEventListener('popstate', ({ state }) => {
    // A link within the page is none.
    if (state === null && !location.hash.startsWith('#%7B')) return;
    step = state ?? step;
    for (const name of NAMES) Object.assign(states[name], own);
    recall();
    turn(now);
    steps();
    pump();
  });
  function recall() {
    try {
      const kept = JSON.parse(location.hash ? decodeURIComponent(location.hash.slice(1)) : localStorage.getItem(STORE));
      for (const name of NAMES) {
        for (const [key, value] of kept[name]) {
          const slider = sliders.find((s) => s.key === key);
          if (slider) states[name][key] = value === rigid ? rigid : Number((Number(value) * slider.factor).toPrecision(12));
          else if (key === LAW) states[name][key] = value;
        }
        if (inputs.has(kept.moved[name])) moved[name] = kept.moved[name];
      }
      if (NAMES.includes(kept.now)) now = kept.now;
      for (const name of NAMES) if (JSON.stringify(values(states[name])) !== JSON.stringify(found[name].asked)) due[name] = performance.now();
    } catch { /* no states were kept */ }
  }

  // ---- Answers
  const due = { a: null, b: null };
  let asking = false;
  let drawing = Promise.resolve();
  /** Asks for the newest state; the next one is asked while this one is drawn. */
  async function pump() {
    if (asking) return;
    const name = [now, ...NAMES].find((one) => due[one] !== null);
    if (name === undefined) {
      const open = (of) => Object.values(found).find((state) => !state[of]);
      if (balancing !== null || moving) return;
      for (const [of, what] of [['figures', 'balances'], ['ran', 'motion'], ['banded', 'bands'], ['sampled', 'sample']]) {
        if (open(of)) return balance(open(of), what);
      }
      return;
    }
    asking = true;
    hold();
    document.body.dataset.busy = '';
    const since = due[name];
    due[name] = null;
    balancing?.abort();
    const state = fresh(values(states[name]));
    let failed = false;
    try {
      const answer = await ask(`run?tab=${TAB}`, state.asked);
      await drawing;
      // One that fails holds up no later one.
      drawing = draw(name, state, answer).catch(gone).then(() => {
        latencies.push(performance.now() - since);
        if (!asking) delete document.body.dataset.busy;
        document.body.dataset.answered = String(Number(document.body.dataset.answered || 0) + 1);
      });
    } catch (error) {
      gone(error);
      delete document.body.dataset.busy;
      failed = true;
    }
    asking = false;
    if (!failed) pump();
  }
  async function draw(name, state, answer) {
    blocked[name] = answer.reason || '';
    reasons();
    if (answer.reason) return;
    const { balanced, ...run } = answer;
    // A late motion follows; until then the last one stays.
    const { time, series } = found[name];
    found[name] = Object.assign(state, { time, series });
    if (balanced) tell(state, balanced);
    if (run.view) await show(state, run);
    figures();
  }
  async function show(state, run) {
    Object.assign(state, run, { ran: true });
    await host.replace(NAMES.findIndex((name) => found[name] === state), run.view);
    curves();
  }
  /** Figures of a state that the program found, or why there are none. */
  function tell(state, told) {
    [state.figures, state.why] = [told.figures || [], told.reason || told.why];
    state.banded = state.sampled = Boolean(told.reason);
  }
  let moving = 0;
  /** While a hand moves the gear stands still between two states, and no bands are asked for: what answers it and draws the
   * answer needs the processor. */
  function hold() {
    host.hold(true);
    clearTimeout(moving);
    moving = setTimeout(() => {
      moving = 0;
      host.hold(false);
      pump();
    }, REST);
  }
  let balancing = null;
  /** Asks the figures of what is shown, or them with bands and limits, or the sample of its tolerances; newer questions end it, and what was ended is asked again when a
   * hand rests. */
  async function balance(state, what) {
    const own = new AbortController();
    balancing = own;
    let more = true;
    try {
      const told = await ask(`${what}?tab=${TAB}`, state.asked, own.signal);
      if (told && what === 'motion') {
        state.ran = true;
        if (told.reason) say(told.reason);
        else if (NAMES.some((name) => found[name] === state)) await show(state, told);
      } else if (told && what === 'sample') {
        state.figures.push(...told.figures);
        state.sampled = true;
      } else if (told) {
        tell(state, told);
        state.banded ||= what === 'bands';
      }
    } catch (error) {
      more = own.signal.aborted;
      if (!more) gone(error);
    }
    if (balancing === own) balancing = null;
    if (NAMES.some((name) => found[name] === state)) figures();
    if (more) pump();
  }
  // A reason stands where the hand is.
  function reasons() {
    const why = blocked[now] && `${blocked[now]} (shown: the last state that can be)`;
    for (const [key, { reason }] of inputs) reason.textContent = key === moved[now] ? why : '';
    document.querySelector('.explore').classList.toggle('stale', Boolean(blocked[now]));
  }
  function figures() {
    const all = NAMES.map((name) => found[name].figures);
    const number = (of, what) => {
      if (of === null) return ['computing'];
      const [, , , shown, bounds] = of.find((one) => one[0] === what) || [0, 0, 0, '–'];
      return [shown, bounds ? make('small', {}, bounds) : ''];
    };
    const rows = new Map(all.flatMap((one) => one || []).map(([what, , unit]) => [what, unit]));
    $('figures').replaceChildren(...[...rows].map(([what, unit]) => {
      const [a, b] = all.map((one) => one?.find((row) => row[0] === what));
      const change = a?.[1] && typeof b?.[1] === 'number' ? difference([a[1], a[5]], [b[1], b[5]]) : '';
      const cells = [...all.map((one) => number(one, what)), [change]].map((parts) => make('td', { class: 'num' }, ...parts));
      return make('tr', {}, make('th', { scope: 'row' }, unit ? `${what} (${unit})` : what), ...cells);
    }));
    const whys = NAMES.filter((name) => found[name].why).map((name) => `${name.toUpperCase()}: ${found[name].why}`);
    const is = (of) => NAMES.every((name) => found[name][of]);
    const open = !is('sampled');
    const under = !is('banded') ? 'Bands by contact law and limits are computed.' : open ? 'The tolerances are sampled.' : whys.join(' ');
    const late = is('ran') ? under : 'The motion is computed; the last one is shown.';
    $('why').textContent = all.includes(null) ? 'Balances are computed.' : late;
    document.body.toggleAttribute('data-computing', open);
  }
  // A share where it is one, a multiple where it is many, with no digit beyond what numbers leave open.
  function difference([a, aOff], [b, bOff]) {
    const ratio = b / a;
    if (!(ratio > 0) || !Number.isFinite(ratio)) return '';
    if (ratio === 1) return 'equal';
    const off = ratio * (aOff / Math.abs(a) + bOff / Math.abs(b));
    const place = (value) => Math.floor(Math.log10(value));
    const said = (value, open) => {
      const digits = Math.min(3, Math.max(1, place(value) - place(open) + 1));
      return PinwheelCharts.number(Number(value.toPrecision(digits)), Math.max(digits, place(value) + 1));
    };
    if (ratio > 2.5) return `${said(ratio, off)} times`;
    const share = Math.abs(ratio - 1);
    if (share <= off) return `less than ${said(100 * off, 100 * off)} %`;
    return `${ratio > 1 ? '+' : '−'}${said(100 * share, 100 * off)} %`;
  }
  const charts = new Map();
  // Marks of both states' curves, beside their names.
  const STYLES = [0, 6];
  NAMES.forEach((name, k) => $(`of-${name}`).prepend(PinwheelCharts.swatch(STYLES[k]), ' '));
  function curves() {
    for (const label of Object.keys(first.series)) {
      const lines = NAMES.map((name, k) => ({ label: name.toUpperCase(), style: STYLES[k], values: found[name].series[label] || [], visible: true }));
      // Axes stay: with others a chart is made anew, which takes many times as long.
      if (charts.has(label)) charts.get(label).update({ series: lines });
      else {
        const plot = make('div', { class: 'plot' });
        $('series').append(make('article', { class: 'panel' }, make('h2', { class: 'small' }, label), plot));
        const x = { values: first.time, label: 'Time (s)', name: (k) => `t = ${PinwheelCharts.number(first.time[k], 4)} s` };
        const y = { label: label.match(/\(([^)]*)\)/)?.[1] || label };
        charts.set(label, PinwheelCharts.chart(plot, { x, y, series: lines, describe: `${label} of both states over a turn`, height: 180, group: 'explore' }));
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
  $('anew').addEventListener('click', () => {
    Object.assign(states[now], own);
    due[now] = performance.now();
    turn(now);
    remember(true);
    pump();
  });
  $('same').addEventListener('click', () => {
    const other = now === 'a' ? 'b' : 'a';
    states[other] = { ...states[now] };
    due[other] = performance.now();
    remember(true);
    pump();
  });
  $('save').addEventListener('click', () => ask('save', values(states[now])).then(({ file, reason }) => say(file ? `State ${now.toUpperCase()} is in ${file}; next: pinwheel design ${file}` : reason)).catch(gone));
  $('file').addEventListener('click', () => ask('file', values(states[now])).then(({ name, text, reason }) => {
    if (reason) say(reason);
    else save(new Blob([text], { type: 'application/toml' }), name);
  }).catch(gone));
  // The address that let this browser in lets in others of the same user.
  $('link').addEventListener('click', () => {
    const stored = location.pathname === '/' && localStorage.getItem('pinwheel address');
    const link = `${stored || location.href.split('#')[0]}#${encodeURIComponent(packed())}`;
    navigator.clipboard.writeText(link).then(() => say('The link is copied: it shows both states in any browser of yours while the program runs'), () => say(link));
  });
  $('compare').addEventListener('click', () => ask('compare', values(states[now])).then(({ reason }) => say(reason || 'Compares')).catch(gone));
  let stamp = null;
  async function watch() {
    try {
      const told = await ask('status');
      if (stamp !== null && told.stamp !== stamp) {
        const all = await Promise.all(NAMES.map((name) => ask('run', values(states[name]))));
        const why = all.find((one) => one.reason);
        // Sliders begin where the file is now.
        if (!why) return location.reload();
        say(`The file was saved, but gives no gear: ${why.reason}`);
      }
      stamp = told.stamp;
      if (told.page) {
        const link = make('a', { href: told.page, target: '_blank' }, 'see the comparison');
        if (!$('said').querySelector('a')) $('said').replaceChildren('Compared: ', link, ` (${told.place})`);
      } else if (told.compares) say(told.compares);
    } catch (error) { gone(error); }
    return setTimeout(watch, 500);
  }

  const host = document.querySelector('.gearboxes');
  const ready = () => (host.dataset.ready === undefined ? setTimeout(ready, 10) : begin());
  function begin() {
    recall();
    turn(now);
    keep();
    figures();
    curves();
    onRedraw(() => charts.forEach((one) => one.redraw()));
    document.body.dataset.explore = '';
    pump();
    watch();
  }
  ready();
});
