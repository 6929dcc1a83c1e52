// The gearbox in motion, drawn from the courses' own samples.
//
// A block holds one JSON document: for every view the gear's dimensions and, packed as 16-bit
// numbers, angles (less the ideal mesh's) and the force of every pair of wheel and sleeve. Where a
// force acts and in which direction is found here on the same curve the solver uses: a sleeve is
// pushed along the epitrochoid's normal at the point closest to its centre.
'use strict';
document.addEventListener('DOMContentLoaded', () => {
  const { make, onRedraw } = PinwheelPage;
  const TAU = 2 * Math.PI;
  const still = matchMedia('(prefers-reduced-motion: reduce)');

  // ---- Data -----------------------------------------------------------------------------------
  function unpack(view) {
    const bytes = Uint8Array.from(atob(view.samples), (c) => c.charCodeAt(0));
    const words = new DataView(bytes.buffer);
    return view.channels.map(({ offset, step }, n) => {
      const values = new Float32Array(view.count);
      for (let k = 0; k < view.count; k += 1) values[k] = offset + step * words.getUint16(2 * (n * view.count + k), true);
      return values;
    });
  }

  // Values between samples lie on the straight line between them.
  const between = (values, at) => {
    const k = Math.min(values.length - 1, Math.max(0, Math.floor(at)));
    const next = Math.min(values.length - 1, k + 1);
    return values[k] + (at - k) * (values[next] - values[k]);
  };

  // ---- Geometry (lengths in mm) ---------------------------------------------------------------
  function curve({ e, zk, m }) {
    const r = (e * zk) / m;
    return (a) => {
      const [c, s, ck, sk] = [Math.cos(a), Math.sin(a), Math.cos(zk * a), Math.sin(zk * a)];
      const [gx, gy] = [r * c + e * zk * ck, r * s + e * zk * sk]; // C' turned by -90 degrees
      const speed = Math.hypot(gx, gy);
      return { x: r * c + e * ck, y: r * s + e * sk, nx: gx / speed, ny: gy / speed, speed, ax: -r * c - e * zk * zk * ck, ay: -r * s - e * zk * zk * sk };
    };
  }
  // Closest point of the curve to (x, y): Newton on (C - P) . C' = 0 from the ideal mesh's.
  function foot(at, x, y, start) {
    let a = start;
    let here = at(a);
    for (let k = 0; k < 6; k += 1) {
      const [tx, ty] = [-here.ny * here.speed, here.nx * here.speed];
      const [dx, dy] = [here.x - x, here.y - y];
      const slope = here.speed * here.speed + dx * here.ax + dy * here.ay;
      const step = (dx * tx + dy * ty) / (slope > 0 ? slope : here.speed * here.speed);
      a -= Math.max(-0.05, Math.min(0.05, step));
      here = at(a);
      if (Math.abs(step) < 1e-9) break;
    }
    return here;
  }

  function gearbox(view) {
    const { gear } = view;
    const zs = gear.zk - 1;
    const radius = (gear.e * gear.zk) / gear.m;
    const at = curve(gear);
    const channels = unpack(view);
    const [input, output, error] = channels;
    const wheels = channels.slice(3, 3 + gear.wheels);
    const pair = (i, n) => channels[3 + gear.wheels + i * (gear.zk + gear.zi) + n];
    const outline = new Path2D();
    const points = gear.zk * 60;
    for (let k = 0; k <= points; k += 1) {
      const p = at((TAU * k) / points);
      const [x, y] = [p.x - gear.q * p.nx, p.y - gear.q * p.ny];
      if (k === 0) outline.moveTo(x, y); else outline.lineTo(x, y);
    }
    outline.closePath();
    /** Everything at the sample number `s` (may lie between samples). */
    function state(s) {
      const t = view.from + view.step * s;
      const phi = view.speed * t;
      const psi = -phi / zs + between(error, s);
      const external = Array.from({ length: gear.zk }, (_, j) => {
        const beta = (TAU * j) / gear.zk;
        return { kind: 'external', number: j, beta, x: (radius + gear.d) * Math.cos(beta), y: (radius + gear.d) * Math.sin(beta), r: gear.q, fx: 0, fy: 0 };
      });
      const internal = Array.from({ length: gear.zi }, (_, k) => {
        const beta = psi + (TAU * k) / gear.zi;
        return { kind: 'internal', number: k, x: gear.rw * Math.cos(beta), y: gear.rw * Math.sin(beta), r: gear.ri, fx: 0, fy: 0 };
      });
      const bodies = Array.from({ length: gear.wheels }, (_, i) => {
        const phase = (TAU * i) / gear.wheels;
        const theta = (Math.PI - phi - phase) / zs + between(wheels[i], s);
        const [x, y] = [gear.e * Math.cos(phi + phase), gear.e * Math.sin(phi + phase)];
        const [c, sn] = [Math.cos(theta), Math.sin(theta)];
        const holes = internal.map((_, k) => {
          const beta = (TAU * k) / gear.zi - (Math.PI - phase) / zs;
          return [gear.rw * Math.cos(beta), gear.rw * Math.sin(beta)];
        });
        const forces = [];
        const push = (sleeve, force, nx, ny) => {
          const [fx, fy] = [force * (c * nx - sn * ny), force * (sn * nx + c * ny)];
          sleeve.fx += fx;
          sleeve.fy += fy;
          forces.push({ sleeve, force, fx, fy });
        };
        const local = (p) => [c * (p.x - x) + sn * (p.y - y), c * (p.y - y) - sn * (p.x - x)];
        for (const sleeve of external) {
          const force = between(pair(i, sleeve.number), s);
          if (force <= view.least) continue;
          const [px, py] = local(sleeve);
          const f = foot(at, px, py, sleeve.beta - theta);
          push(sleeve, force, f.nx, f.ny);
        }
        for (const sleeve of internal) {
          const force = between(pair(i, gear.zk + sleeve.number), s);
          if (force <= view.least) continue;
          const [px, py] = local(sleeve);
          const [dx, dy] = [px - holes[sleeve.number][0], py - holes[sleeve.number][1]];
          const length = Math.hypot(dx, dy) || 1;
          push(sleeve, force, -dx / length, -dy / length);
        }
        return { x, y, theta, holes, forces };
      });
      return { t, phi, psi, external, internal, bodies, input: between(input, s), output: between(output, s) };
    }
    // Largest force on a sleeve of each kind, sample by sample, for the time line: the pairs' sum bounds it.
    const envelope = (from, count) => {
      const values = new Float32Array(view.count);
      for (let k = 0; k < view.count; k += 1) {
        for (let n = from; n < from + count; n += 1) {
          let sum = 0;
          for (let i = 0; i < gear.wheels; i += 1) sum = Math.max(sum, pair(i, n)[k]);
          if (sum > values[k]) values[k] = sum;
        }
      }
      return values;
    };
    return { view, gear, radius, outline, state, external: envelope(0, gear.zk), internal: envelope(gear.zk, gear.zi) };
  }

  // ---- Colours --------------------------------------------------------------------------------
  function palette(host) {
    const probe = make('i', { hidden: true });
    host.append(probe);
    const resolve = (text) => {
      probe.style.color = text;
      return getComputedStyle(probe).color;
    };
    const names = ['ink', 'ink-soft', 'rule', 'sheet', 'sunk', 'accent', 'steel', 'steel-edge', 'housing', 'force-high', 'force-middle'];
    const found = Object.fromEntries(names.map((name) => [name, resolve(`var(--${name})`)]));
    found.wheel = [0, 1, 2, 3].map((k) => resolve(`var(--wheel-${k})`));
    found.edge = [0, 1, 2, 3].map((k) => resolve(`var(--wheel-${k}-edge)`));
    const mix = (a, b, share) => resolve(`color-mix(in oklch, var(--force-${b}) ${Math.round(100 * share)}%, var(--force-${a}))`);
    found.force = Array.from({ length: 41 }, (_, k) => (k <= 20 ? mix('low', 'middle', k / 20) : mix('middle', 'high', (k - 20) / 20)));
    probe.remove();
    return found;
  }

  // ---- One view -------------------------------------------------------------------------------
  function drawing(canvas, box, options) {
    const context = canvas.getContext('2d');
    const { gear, radius } = box;
    const rim = radius + gear.d + gear.q * 1.45;
    const reach = Math.max(0.3 * radius, 2.6 * gear.q);
    const half = rim + 0.42 * reach;
    function resize() {
      const ratio = Math.min(window.devicePixelRatio || 1, 2);
      const size = Math.max(1, Math.round(canvas.clientWidth * ratio));
      if (canvas.width !== size) { canvas.width = size; canvas.height = size; }
      return size;
    }
    const circle = (x, y, r) => { context.beginPath(); context.arc(x, y, r, 0, TAU); };
    function arrow(x, y, fx, fy, colours, full) {
      const force = Math.hypot(fx, fy);
      const share = Math.min(force / full, 1.35);
      const length = share * reach;
      if (length < 0.4) return;
      const [ux, uy] = [fx / force, fy / force];
      const head = Math.min(0.42 * length, 0.05 * radius);
      const width = 0.35 * head + 0.35;
      const [ex, ey] = [x + ux * length, y + uy * length];
      const shaft = () => {
        context.beginPath();
        context.moveTo(x, y);
        context.lineTo(ex - ux * head * 0.8, ey - uy * head * 0.8);
      };
      const tip = () => {
        context.beginPath();
        context.moveTo(ex, ey);
        context.lineTo(ex - ux * head - uy * head * 0.48, ey - uy * head + ux * head * 0.48);
        context.lineTo(ex - ux * head + uy * head * 0.48, ey - uy * head - ux * head * 0.48);
        context.closePath();
      };
      const colour = colours.force[Math.min(40, Math.round((40 * force) / full))];
      context.lineCap = 'round';
      context.lineJoin = 'round';
      context.strokeStyle = colours.sheet;
      context.lineWidth = width + 1.1;
      shaft(); context.stroke();
      tip(); context.lineWidth = 1.1; context.stroke();
      context.strokeStyle = colour;
      context.fillStyle = colour;
      context.lineWidth = width;
      shaft(); context.stroke();
      tip(); context.fill();
    }
    function wheel(body, i, colours, opacity) {
      const path = new Path2D();
      const turn = new DOMMatrix([Math.cos(body.theta), Math.sin(body.theta), -Math.sin(body.theta), Math.cos(body.theta), body.x, body.y]);
      path.addPath(box.outline, turn);
      for (const [hx, hy] of body.holes) {
        const p = turn.transformPoint(new DOMPoint(hx, hy));
        path.moveTo(p.x + gear.rh, p.y);
        path.arc(p.x, p.y, gear.rh, 0, TAU);
      }
      const cam = camRadius();
      path.moveTo(body.x + cam, body.y);
      path.arc(body.x, body.y, cam, 0, TAU);
      context.globalAlpha = opacity;
      context.fillStyle = colours.wheel[i % 4];
      context.fill(path, 'evenodd');
      context.globalAlpha = Math.min(1, opacity + 0.1);
      context.strokeStyle = colours.edge[i % 4];
      context.lineWidth = 0.55;
      context.stroke(path);
      // A mark that shows how slowly the wheel turns.
      const mark = turn.transformPoint(new DOMPoint(0.5 * (cam + gear.rw - gear.rh), 0));
      circle(mark.x, mark.y, Math.max(0.7, 0.02 * radius));
      context.fillStyle = colours.edge[i % 4];
      context.fill();
      context.globalAlpha = 1;
    }
    const camRadius = () => Math.max(gear.e * 1.6, Math.min(0.62 * (gear.rw - gear.rh), 0.3 * radius));
    function draw(state, colours, hovered) {
      const size = resize();
      const scale = size / (2 * half);
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.clearRect(0, 0, size, size);
      context.setTransform(scale, 0, 0, -scale, size / 2, size / 2);
      // Housing.
      context.beginPath();
      context.arc(0, 0, rim, 0, TAU);
      context.arc(0, 0, radius + gear.d + gear.q * 0.25, 0, TAU, true);
      context.fillStyle = colours.housing;
      context.fill();
      circle(0, 0, rim);
      context.strokeStyle = colours.rule;
      context.lineWidth = 0.5;
      context.stroke();
      // Wheels, the last behind.
      for (let i = gear.wheels - 1; i >= 0; i -= 1) if (options.wheels[i]) wheel(state.bodies[i], i, colours, i === 0 ? 0.86 : 0.95);
      // Input: eccentric cams on one shaft.
      const cam = camRadius();
      for (let i = gear.wheels - 1; i >= 0; i -= 1) {
        if (!options.wheels[i]) continue;
        const body = state.bodies[i];
        circle(body.x, body.y, cam - 0.4);
        context.fillStyle = colours.steel;
        context.globalAlpha = i === 0 ? 0.9 : 1;
        context.fill();
        context.globalAlpha = 1;
        context.strokeStyle = colours.edge[i % 4];
        context.lineWidth = 0.5;
        context.stroke();
      }
      circle(0, 0, 0.55 * cam);
      context.fillStyle = colours.sheet;
      context.fill();
      context.strokeStyle = colours['steel-edge'];
      context.lineWidth = 0.6;
      context.stroke();
      context.beginPath();
      context.moveTo(0, 0);
      context.lineTo(0.55 * cam * Math.cos(state.phi), 0.55 * cam * Math.sin(state.phi));
      context.strokeStyle = colours.ink;
      context.lineWidth = 1.1;
      context.lineCap = 'round';
      context.stroke();
      circle(0, 0, 0.8);
      context.fillStyle = colours.ink;
      context.fill();
      // Sleeves, shaded by load.
      for (const sleeve of [...state.external, ...state.internal]) {
        circle(sleeve.x, sleeve.y, sleeve.r);
        context.fillStyle = colours.steel;
        context.fill();
        const force = Math.hypot(sleeve.fx, sleeve.fy);
        if (options.forces && force > 0) {
          context.globalAlpha = Math.min(0.62, (0.62 * force) / box.view.full);
          context.fillStyle = colours.force[Math.min(40, Math.round((40 * force) / box.view.full))];
          context.fill();
          context.globalAlpha = 1;
        }
        context.strokeStyle = sleeve === hovered ? colours.ink : colours['steel-edge'];
        context.lineWidth = sleeve === hovered ? 1 : 0.5;
        context.stroke();
        circle(sleeve.x, sleeve.y, 0.16 * sleeve.r);
        context.fillStyle = colours['steel-edge'];
        context.fill();
      }
      if (options.forces) {
        state.bodies.forEach((body, i) => {
          if (!options.wheels[i]) return;
          for (const f of body.forces) arrow(f.sleeve.x, f.sleeve.y, f.fx, f.fy, colours, box.view.full);
        });
      }
      if (hovered) label(hovered, colours, scale, size);
    }
    function label(sleeve, colours, scale, size) {
      const text = `${sleeve.kind} ${sleeve.number}: ${Math.hypot(sleeve.fx, sleeve.fy).toFixed(1)} N`;
      const pixel = size / canvas.clientWidth;
      context.setTransform(pixel, 0, 0, pixel, 0, 0);
      context.font = `600 13px ${getComputedStyle(document.body).fontFamily}`;
      const width = context.measureText(text).width + 16;
      const css = size / pixel;
      const x = Math.min(css - width - 4, Math.max(4, css / 2 + (sleeve.x * scale) / pixel - width / 2));
      const y = Math.max(4, css / 2 - ((sleeve.y + sleeve.r) * scale) / pixel - 32);
      context.beginPath();
      context.roundRect(x, y, width, 25, 6);
      context.fillStyle = colours.ink;
      context.fill();
      context.fillStyle = colours.sheet;
      context.textBaseline = 'middle';
      context.fillText(text, x + 8, y + 13);
    }
    /** The sleeve under a point of the canvas. */
    function under(event, state) {
      const box2 = canvas.getBoundingClientRect();
      const scale = box2.width / (2 * half);
      const x = (event.clientX - box2.left - box2.width / 2) / scale;
      const y = -(event.clientY - box2.top - box2.height / 2) / scale;
      const near = [...state.external, ...state.internal].map((s) => [Math.hypot(s.x - x, s.y - y) / s.r, s]).sort((a, b) => a[0] - b[0])[0];
      return near && near[0] < 1.6 ? near[1] : null;
    }
    return { draw, under };
  }

  // ---- A block: views with one clock ----------------------------------------------------------
  function block(host) {
    const data = JSON.parse(host.querySelector('script').textContent);
    const boxes = data.views.map(gearbox);
    const first = boxes[0];
    const last = first.view.count - 1;
    const options = { forces: true, wheels: Array(4).fill(true) };
    for (let i = 4; i < first.gear.wheels; i += 1) options.wheels[i] = true;
    let colours = palette(host);
    const views = boxes.map((box, n) => {
      const figure = host.querySelectorAll('.gearbox-view')[n];
      const canvas = figure.querySelector('canvas');
      const view = { box, canvas, cells: [...figure.querySelectorAll('dd')], pointer: null, ...drawing(canvas, box, options) };
      canvas.addEventListener('pointermove', (event) => { view.pointer = event; paint(); });
      canvas.addEventListener('pointerleave', () => { view.pointer = null; paint(); });
      return view;
    });
    const play = host.querySelector('.play');
    const slider = host.querySelector('input[type=range]');
    const speed = host.querySelector('select');
    const shown = host.querySelector('.at');
    const line = host.querySelector('.gearbox-time canvas');
    const clock = { at: data.begin, playing: false, visible: false, stamp: null };
    slider.max = String(last);
    const fixed = (v, digits) => v.toFixed(digits).replace('-', '−');

    function paint() {
      const t = first.view.from + first.view.step * clock.at;
      shown.textContent = `t = ${fixed(t, 4)} s`;
      slider.value = String(Math.round(clock.at));
      slider.setAttribute('aria-valuetext', `${t.toFixed(4)} seconds`);
      for (const view of views) {
        const state = view.box.state(clock.at);
        view.draw(state, colours, view.pointer ? view.under(view.pointer, state) : null);
        const peak = (list) => Math.max(...list.map((s) => Math.hypot(s.fx, s.fy)));
        const texts = [
          `${fixed(((state.phi * 360) / TAU) % 360, 1)}°`, `${fixed((state.psi * 360) / TAU, 2)}°`,
          `${fixed(state.input, 3)} N m`, `${fixed(state.output, 2)} N m`,
          `${fixed(peak(state.external), 1)} N`, `${fixed(peak(state.internal), 1)} N`,
          state.bodies.map((b) => b.forces.filter((f) => f.sleeve.kind === 'external').length).join(' + '),
        ];
        view.cells.forEach((cell, k) => { if (cell.textContent !== texts[k]) cell.textContent = texts[k]; });
      }
      timeline();
    }

    // The time line: largest external and internal force of the first view, and where we are.
    let strip = null;
    function timeline() {
      const ratio = Math.min(window.devicePixelRatio || 1, 2);
      const [w, h] = [Math.max(1, Math.round(line.clientWidth * ratio)), Math.round(line.clientHeight * ratio)];
      const context = line.getContext('2d');
      if (!strip || strip.width !== w || strip.height !== h) {
        line.width = w;
        line.height = h;
        strip = new OffscreenCanvas(w, h);
        const pen = strip.getContext('2d');
        const top = 1.25 * first.view.full;
        boxes.forEach((box, n) => {
          for (const [values, colour] of [[box.internal, colours['force-middle']], [box.external, colours.accent]]) {
            pen.beginPath();
            for (let x = 0; x < w; x += 1) {
              // The largest sample of the pixel.
              const [from, to] = [Math.floor((x / w) * last), Math.ceil(((x + 1) / w) * last)];
              let value = 0;
              for (let k = from; k <= Math.min(to, last); k += 1) value = Math.max(value, values[k]);
              const y = h - 3 - Math.min(1, value / top) * (h - 8);
              if (x === 0) pen.moveTo(x, y); else pen.lineTo(x, y);
            }
            pen.strokeStyle = colour;
            pen.globalAlpha = n === 0 ? 1 : 0.45;
            pen.lineWidth = 1.4 * ratio;
            pen.stroke();
          }
        });
      }
      context.clearRect(0, 0, w, h);
      context.drawImage(strip, 0, 0);
      const x = (clock.at / last) * w;
      context.fillStyle = colours.ink;
      context.fillRect(Math.min(w - 2 * ratio, Math.max(0, x - ratio)), 0, 2 * ratio, h);
    }

    function frame(stamp) {
      if (!clock.playing || !clock.visible) { clock.stamp = null; return; }
      if (clock.stamp !== null) {
        // After a pause of the page the gearbox goes on, and does not jump.
        const passed = Math.min(0.1, (stamp - clock.stamp) / 1000);
        clock.at += (passed * Number(speed.value)) / first.view.step;
        if (clock.at >= last) clock.at = data.begin + ((clock.at - last) % Math.max(1, last - data.begin));
        paint();
      }
      clock.stamp = stamp;
      requestAnimationFrame(frame);
    }
    function run(on) {
      const started = on && !clock.playing;
      clock.playing = on;
      play.textContent = on ? '❚❚ Pause' : '▶ Play';
      play.setAttribute('aria-pressed', String(on));
      if (started && clock.visible && clock.stamp === null) requestAnimationFrame(frame);
    }
    const go = (at) => { clock.at = Math.min(last, Math.max(0, at)); paint(); };
    play.addEventListener('click', () => run(!clock.playing));
    slider.addEventListener('input', () => { run(false); go(Number(slider.value)); });
    const scrub = (event) => go(((event.clientX - line.getBoundingClientRect().left) / line.clientWidth) * last);
    line.addEventListener('pointerdown', (event) => { run(false); line.setPointerCapture(event.pointerId); scrub(event); });
    line.addEventListener('pointermove', (event) => { if (line.hasPointerCapture(event.pointerId)) scrub(event); });
    for (const { canvas } of views) {
      canvas.addEventListener('keydown', (event) => {
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
    onRedraw(() => { colours = palette(host); strip = null; paint(); });
    const resized = new ResizeObserver(() => { strip = null; paint(); });
    views.forEach((view) => resized.observe(view.canvas));
    // Nothing is drawn that nobody sees.
    new IntersectionObserver((entries) => {
      clock.visible = entries.some((entry) => entry.isIntersecting);
      if (clock.visible && clock.playing && clock.stamp === null) requestAnimationFrame(frame);
    }).observe(host);
    host.querySelector('.gearbox-controls').hidden = false;
    host.querySelector('.gearbox-time').hidden = false;
    paint();
    // For those who asked for less motion it waits for them.
    run(!still.matches);
    still.addEventListener('change', () => { if (still.matches) run(false); });
    host.dataset.ready = '';
  }

  document.querySelectorAll('.gearboxes').forEach(block);
});
