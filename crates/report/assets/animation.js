// The gearbox in motion: views with one clock, played, scrubbed and stepped.
//
// A frame moves the gearbox and draws it; it asks the page for no size and no style. Figures beside the
// picture change ten times a second: no eye reads more, and every change of text lays the page out anew.
// While it plays nothing is drawn that nobody sees, and if nothing is seen no frame is asked for. Where
// frames come late all the same, sharpness is given up before smoothness.
'use strict';
document.addEventListener('DOMContentLoaded', () => {
  const { onRedraw } = PinwheelPage;
  const { gearbox, TAU } = PinwheelGearbox;
  const { palette, picture } = PinwheelPicture;
  const calm = matchMedia('(prefers-reduced-motion: reduce)');
  /** Milliseconds between changes of text. */
  const TEXT = 100;
  /** Frames further apart than this on average, ms, are late. */
  const LATE = 25;
  const fixed = (v, digits) => v.toFixed(digits).replace('-', '−');

  // ---- The time line: largest forces of all views, and where we are ----------------------------
  function timeline(line, boxes) {
    const pen = line.getContext('2d');
    const last = boxes[0].view.count - 1;
    const most = (values) => values.reduce((a, b) => Math.max(a, b), 0);
    let [w, h, ratio] = [0, 0, 1];
    const curves = new OffscreenCanvas(1, 1);
    let [ink, knob, marked] = ['', '', null];
    function draw(colours, wide, high) {
      ratio = Math.min(window.devicePixelRatio || 1, 2);
      [w, h] = [Math.max(1, Math.round(wide * ratio)), Math.max(1, Math.round(high * ratio))];
      [ink, knob] = [colours.ink, colours.accent];
      for (const canvas of [line, curves]) if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
      pen.clearRect(0, 0, w, h);
      const top = 1.04 * Math.max(...boxes.flatMap((box) => [most(box.external), most(box.internal)]), 1e-9);
      const y = (value) => h - 8 * ratio - (value / top) * (h - 12 * ratio);
      boxes.forEach((box, n) => {
        for (const [values, colour] of [[box.internal, colours['force-middle']], [box.external, colours.accent]]) {
          pen.beginPath();
          if (last <= 2 * w) values.forEach((value, k) => pen.lineTo((k / last) * w, y(value)));
          // More samples than pixels: the least and the largest of each.
          else {
            for (let x = 0; x < w; x += 1) {
              const part = values.subarray(Math.floor((x / w) * last), Math.ceil(((x + 1) / w) * last) + 1);
              pen.lineTo(x, y(part.reduce((a, b) => Math.min(a, b))));
              pen.lineTo(x, y(most(part)));
            }
          }
          pen.strokeStyle = colour;
          pen.globalAlpha = n === 0 ? 1 : 0.45;
          pen.lineWidth = 1.4 * ratio;
          pen.lineJoin = 'round';
          pen.stroke();
        }
      });
      pen.globalAlpha = 1;
      const kept = curves.getContext('2d');
      kept.clearRect(0, 0, w, h);
      kept.drawImage(line, 0, 0);
      marked = null;
    }
    /** Moves the mark: what it covered comes back, and nothing else is drawn. */
    function mark(at) {
      if (w === 0) return;
      const r = 6 * ratio;
      const x = Math.min(w - r, Math.max(r, (at / last) * w));
      if (marked !== null && Math.abs(x - marked) < 0.25) return;
      if (marked !== null) {
        const [left, wide] = [Math.floor(marked - r - 1), Math.ceil(2 * r + 3)];
        pen.clearRect(left, 0, wide, h);
        pen.drawImage(curves, left, 0, wide, h, left, 0, wide, h);
      }
      marked = x;
      pen.fillStyle = ink;
      pen.fillRect(x - ratio, 0, 2 * ratio, h - r);
      pen.fillStyle = knob;
      pen.beginPath();
      pen.arc(x, h - r, r, 0, TAU);
      pen.fill();
    }
    return { draw, mark };
  }

  // ---- A block: views with one clock ----------------------------------------------------------
  async function block(host) {
    const data = JSON.parse(host.querySelector('script').textContent);
    const boxed = async (view) => {
      const read = PinwheelPacked.reader(await PinwheelPacked.unpack(view.samples));
      return gearbox(view, Array.from({ length: view.channels }, () => Float32Array.from(read.column())));
    };
    const boxes = await Promise.all(data.views.map(boxed));
    const first = boxes[0];
    const last = first.view.count - 1;
    const options = { forces: true, wheels: Array(first.gear.wheels).fill(true) };
    let colours = palette(host);
    const figures = host.querySelectorAll('.gearbox-view');
    const views = boxes.map((box, n) => {
      const canvas = figures[n].querySelector('canvas');
      return { box, canvas, cells: [...figures[n].querySelectorAll('dd')], pointer: null, width: 0, seen: false, ...picture(canvas, box, options) };
    });
    const play = host.querySelector('.play');
    const slider = host.querySelector('input[type=range]');
    const speed = host.querySelector('select');
    const shown = host.querySelector('.at');
    const line = host.querySelector('.gearbox-time canvas');
    const strip = timeline(line, boxes);
    let lined = [0, 0];
    const clock = { at: data.begin, playing: false, frame: 0, stamp: null, told: -Infinity, interval: 0, coarse: false, held: false };
    slider.max = String(last);

    // ---- Drawing
    function paint(which = views) {
      for (const view of which) {
        if (view.width === 0) continue;
        view.box.move(clock.at);
        view.draw(colours, view.pointer ? view.under(view.pointer) : null, clock.held);
      }
      strip.mark(clock.at);
    }
    function tell() {
      const t = first.view.from + first.view.step * clock.at;
      const say = (element, text) => { if (element.textContent !== text) element.textContent = text; };
      say(shown, `t = ${fixed(t, 4)} s`);
      slider.value = String(Math.round(clock.at));
      slider.setAttribute('aria-valuetext', `${t.toFixed(4)} seconds`);
      const peak = (sleeves) => sleeves.reduce((most, s) => Math.max(most, Math.hypot(s.fx, s.fy)), 0);
      for (const { box, cells } of views) {
        box.move(clock.at);
        const { state } = box;
        const texts = [
          `${fixed(((state.phi * 360) / TAU) % 360, 1)}°`, `${fixed((state.psi * 360) / TAU, 2)}°`,
          `${fixed(state.input, 3)} N m`, `${fixed(state.output, 2)} N m`,
          `${fixed(peak(state.external), 1)} N`, `${fixed(peak(state.internal), 1)} N`,
          state.bodies.map((body) => body.loaded).join(' + '),
          `${state.bodies.map(({ off }) => (1e3 * Math.hypot(...off)).toFixed(1)).join(', ')} µm`,
        ];
        cells.forEach((cell, k) => say(cell, texts[k]));
        // Distance of discs from their eccentrics, and the factor by which the drawing enlarges it.
        const label = cells.at(-1).previousSibling;
        say(label, `Offset, × ${box.view.offset}`);
        label.hidden = cells.at(-1).hidden = box.view.offset === 0;
      }
    }
    const show = () => { tell(); paint(); };
    const ratio = () => (clock.coarse && clock.playing ? 1 : Math.min(window.devicePixelRatio || 1, 2));
    const resize = (view) => { if (view.width > 0) view.resize(view.width, ratio(), clock.held); };

    // ---- The clock
    const wanted = () => clock.playing && !clock.held && !document.hidden && views.some((view) => view.seen);
    /** Asks for a frame if one is wanted, and for no second one. */
    function schedule() {
      if (!wanted()) {
        cancelAnimationFrame(clock.frame);
        clock.frame = 0;
        clock.stamp = null;
      } else if (clock.frame === 0) clock.frame = requestAnimationFrame(frame);
    }
    function advance(passed) {
      // After a pause of the page the gearbox goes on, and does not jump.
      clock.at += (Math.min(100, passed) * Number(speed.value)) / 1000 / first.view.step;
      if (clock.at >= last) clock.at = data.begin + ((clock.at - last) % Math.max(1, last - data.begin));
    }
    function frame(stamp) {
      clock.frame = 0;
      if (clock.stamp !== null) {
        const passed = Math.max(0, stamp - clock.stamp);
        sharpen(passed);
        advance(passed);
        if (stamp - clock.told >= TEXT) { clock.told = stamp; tell(); }
        paint(views.filter((view) => view.seen));
      }
      clock.stamp = stamp;
      schedule();
    }
    /** Held it stands still, but for new gearboxes: what computes those needs the processor. */
    host.hold = (on) => {
      const rests = clock.held && !on;
      clock.held = on;
      if (rests) {
        views.forEach(resize);
        show();
      }
      schedule();
    };
    function sharpen(passed) {
      clock.interval += 0.04 * (Math.min(100, passed) - clock.interval);
      if (clock.interval <= LATE || clock.coarse) return;
      clock.coarse = true;
      if (window.devicePixelRatio > 1) views.forEach(resize);
    }
    function run(on) {
      if (clock.playing === on) return;
      clock.playing = on;
      play.textContent = on ? '❚❚ Pause' : '▶ Play';
      play.setAttribute('aria-pressed', String(on));
      if (clock.coarse && window.devicePixelRatio > 1) views.forEach(resize);
      schedule();
      if (!on) show();
    }
    const go = (at) => { clock.at = Math.min(last, Math.max(0, at)); show(); };

    // ---- What people do
    play.addEventListener('click', () => run(!clock.playing));
    slider.addEventListener('input', () => { const at = Number(slider.value); run(false); go(at); });
    for (const view of views) {
      const point = (at) => { view.pointer = at; if (clock.frame === 0) paint(); };
      view.canvas.addEventListener('pointermove', (event) => point([event.offsetX, event.offsetY]));
      view.canvas.addEventListener('pointerleave', () => point(null));
      view.canvas.addEventListener('keydown', (event) => {
        const turn = TAU / Math.abs(first.view.speed) / first.view.step;
        const step = event.shiftKey ? turn / 16 : turn / 360;
        const actions = { ' ': () => run(!clock.playing), ArrowRight: () => { run(false); go(clock.at + step); }, ArrowLeft: () => { run(false); go(clock.at - step); }, Home: () => go(0), End: () => go(last) };
        if (actions[event.key]) { actions[event.key](); event.preventDefault(); }
      });
    }
    host.querySelectorAll('.gearbox-chips button').forEach((chip) => chip.addEventListener('click', () => {
      const on = chip.getAttribute('aria-pressed') !== 'true';
      chip.setAttribute('aria-pressed', String(on));
      if (chip.dataset.wheel === undefined) options.forces = on; else options.wheels[Number(chip.dataset.wheel)] = on;
      paint();
    }));

    // ---- What the page does
    host.querySelector('.gearbox-controls').hidden = false;
    host.querySelector('.gearbox-time').hidden = false;
    onRedraw(() => {
      colours = palette(host);
      views.forEach((view) => view.repaint());
      strip.draw(colours, ...lined);
      paint();
    });
    // Sizes come from here, so that no frame has to ask for them.
    const resized = new ResizeObserver((entries) => {
      for (const { target, contentRect } of entries) {
        const view = views.find(({ canvas }) => canvas === target);
        if (view) {
          view.width = contentRect.width;
          resize(view);
        } else {
          lined = [contentRect.width, contentRect.height];
          strip.draw(colours, ...lined);
        }
      }
      paint();
    });
    [line, ...views.map((view) => view.canvas)].forEach((canvas) => resized.observe(canvas));
    const seen = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) views.find(({ canvas }) => canvas === target).seen = isIntersecting;
      schedule();
    });
    views.forEach((view) => seen.observe(view.canvas));
    document.addEventListener('visibilitychange', schedule);
    tell();
    // For those who asked for less motion it waits for them.
    run(!calm.matches);
    calm.addEventListener('change', () => { if (calm.matches) run(false); });
    /** Another gearbox, of as many samples, in the place of one. */
    host.replace = async (n, other) => {
      const box = await boxed(other);
      boxes[n] = box;
      while (options.wheels.length < box.gear.wheels) options.wheels.push(true);
      Object.assign(views[n], { box, ...picture(views[n].canvas, box, options) });
      resize(views[n]);
      views[n].repaint();
      strip.draw(colours, ...lined);
      if (!clock.held) tell();
      paint([views[n]]);
    };
    host.dataset.ready = '';
  }

  document.querySelectorAll('.gearboxes').forEach(block);
});
