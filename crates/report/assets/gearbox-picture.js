// The picture of a gearbox. What stands still is a bitmap, what only moves is a path made once and drawn
// turned, and what is alike is one path: a frame is a few dozen fills. It reads nothing of the page.
'use strict';
const PinwheelPicture = (() => {
  const { TAU } = PinwheelGearbox;
  /** Pixels by which a chord may miss the profile, of a gear that is looked at and of one that is drawn once. */
  const MISS = [0.1, 0.35];
  /** Colours of force from none to a full arrow. */
  const SHADES = 40;
  const NAMES = ['ink', 'ink-soft', 'rule', 'sheet', 'sunk', 'accent', 'steel', 'steel-edge', 'housing', 'force-high', 'force-middle'];

  /** The page's colours and font, as a canvas takes them. */
  function palette(host) {
    const probe = document.createElement('i');
    probe.hidden = true;
    host.append(probe);
    const resolve = (text) => {
      probe.style.color = text;
      return getComputedStyle(probe).color;
    };
    const found = Object.fromEntries(NAMES.map((name) => [name, resolve(`var(--${name})`)]));
    found.wheel = [0, 1, 2, 3].map((k) => resolve(`var(--wheel-${k})`));
    found.edge = [0, 1, 2, 3].map((k) => resolve(`var(--wheel-${k}-edge)`));
    const mix = (a, b, share) => resolve(`color-mix(in oklch, var(--force-${b}) ${Math.round(100 * share)}%, var(--force-${a}))`);
    const half = SHADES / 2;
    found.force = Array.from({ length: SHADES + 1 }, (_, k) => (k <= half ? mix('low', 'middle', k / half) : mix('middle', 'high', k / half - 1)));
    found.font = `600 13px ${getComputedStyle(host).fontFamily}`;
    probe.remove();
    return found;
  }

  /** Draws `box` on `canvas`; `options` says what. */
  function picture(canvas, box, options) {
    const context = canvas.getContext('2d', { alpha: false });
    const { gear, radius, state } = box;
    const { full } = box.view;
    const rim = radius + gear.d + gear.q * 1.45;
    const reach = Math.max(0.3 * radius, 2.6 * gear.q);
    const half = rim + 0.42 * reach;
    const cam = Math.max(gear.e * 1.6, Math.min(0.62 * (gear.rw - gear.rh), 0.3 * radius));
    const mark = { at: 0.5 * (cam + gear.rw - gear.rh), r: Math.max(0.7, 0.02 * radius) };
    const shades = Array.from({ length: SHADES + 1 }, () => []);
    const shade = (force) => Math.min(SHADES, Math.round((SHADES * force) / full));
    let [width, size, scale] = [0, 0, 0];
    let still = null; // housing and ring pins
    let paths = [];   // discs in their own frames

    function circle(pen, x, y, r) {
      pen.moveTo(x + r, y);
      pen.arc(x, y, r, 0, TAU);
    }
    function fill(pen, colour) {
      pen.fillStyle = colour;
      pen.fill();
    }
    function stroke(pen, colour, thickness) {
      pen.strokeStyle = colour;
      pen.lineWidth = thickness;
      pen.stroke();
    }
    const upright = (pen) => pen.setTransform(scale, 0, 0, -scale, size / 2, size / 2);
    // Plain pins, all of a kind in three strokes of the pen.
    function plain(pen, sleeves, colours) {
      pen.beginPath();
      for (const { x, y, r } of sleeves) circle(pen, x, y, r);
      fill(pen, colours.steel);
      stroke(pen, colours['steel-edge'], 0.5);
      pen.beginPath();
      for (const { x, y, r } of sleeves) circle(pen, x, y, 0.16 * r);
      fill(pen, colours['steel-edge']);
    }

    /** To be drawn `wide` CSS pixels wide with `ratio` of the screen's pixels for each; `once`: coarser, see `ground`. */
    function resize(wide, ratio, once) {
      width = wide;
      size = Math.max(1, Math.round(wide * ratio));
      scale = size / (2 * half);
      still = null;
      if (canvas.width !== size) { canvas.width = size; canvas.height = size; }
      const profile = box.profile(MISS[Number(once)] / scale);
      paths = state.bodies.map((body) => {
        const path = new Path2D();
        profile.forEach(([x, y], k) => (k === 0 ? path.moveTo(x, y) : path.lineTo(x, y)));
        path.closePath();
        for (const [x, y, r] of body.holes) circle(path, x, y, r);
        circle(path, 0, 0, cam);
        return path;
      });
    }
    function backdrop(pen, colours) {
      fillAll(pen, colours.sheet);
      upright(pen);
      pen.beginPath();
      pen.arc(0, 0, rim, 0, TAU);
      pen.arc(0, 0, radius + gear.d + gear.q * 0.25, 0, TAU, true);
      fill(pen, colours.housing);
      pen.beginPath();
      circle(pen, 0, 0, rim);
      stroke(pen, colours.rule, 0.5);
      if (!gear.ring) plain(pen, state.external, colours);
    }
    /** The parts that do not move, kept for the next frame; `once`: the gear has none. */
    function ground(colours, once) {
      context.setTransform(1, 0, 0, 1, 0, 0);
      if (still === null && once) { backdrop(context, colours); return; }
      if (still === null) {
        const canvas2 = new OffscreenCanvas(size, size);
        backdrop(canvas2.getContext('2d', { alpha: false }), colours);
        still = canvas2.transferToImageBitmap();
      }
      context.drawImage(still, 0, 0);
    }
    function fillAll(pen, colour) {
      pen.fillStyle = colour;
      pen.fillRect(0, 0, size, size);
    }

    /** The centre of a disc whose offset from its eccentric is drawn so many times larger; 0: that of its eccentric. */
    function centre(i, times) {
      const { x, y, off } = state.bodies[i];
      return [x + (times - 1) * off[0], y + (times - 1) * off[1]];
    }
    function wheel(i, colours) {
      const { theta } = state.bodies[i];
      const [x, y] = centre(i, box.view.offset);
      const [c, s] = [scale * Math.cos(theta), scale * Math.sin(theta)];
      const opacity = i === 0 ? 0.86 : 0.95;
      context.setTransform(c, -s, -s, -c, size / 2 + scale * x, size / 2 - scale * y);
      context.globalAlpha = opacity;
      context.fillStyle = colours.wheel[i % 4];
      context.fill(paths[i], 'evenodd');
      context.globalAlpha = Math.min(1, opacity + 0.1);
      context.strokeStyle = colours.edge[i % 4];
      context.lineWidth = 0.55;
      context.stroke(paths[i]);
      // A mark that shows how slowly the disc turns.
      context.beginPath();
      circle(context, mark.at, 0, mark.r);
      fill(context, colours.edge[i % 4]);
      context.globalAlpha = 1;
    }
    // Eccentric cams on one shaft, with a hand.
    function cranks(colours) {
      for (let i = gear.wheels - 1; i >= 0; i -= 1) {
        if (!options.wheels[i]) continue;
        for (const { x, y } of state.internal) {
          context.beginPath();
          circle(context, x + state.bodies[i].x, y + state.bodies[i].y, gear.rh - 0.4);
          context.globalAlpha = i === 0 ? 0.9 : 1;
          fill(context, colours.steel);
          context.globalAlpha = 1;
          stroke(context, colours.edge[i % 4], 0.5);
        }
      }
      plain(context, state.internal, colours);
      hand(gear.sun, colours);
    }
    function input(colours) {
      if (gear.sun) { cranks(colours); return; }
      for (let i = gear.wheels - 1; i >= 0; i -= 1) {
        if (!options.wheels[i]) continue;
        context.beginPath();
        const [x, y] = centre(i, 0);
        circle(context, x, y, cam - 0.4);
        context.globalAlpha = i === 0 ? 0.9 : 1;
        fill(context, colours.steel);
        context.globalAlpha = 1;
        stroke(context, colours.edge[i % 4], 0.5);
      }
      hand(0.55 * cam, colours);
    }
    // The input's shaft, or its sun.
    function hand(r, colours) {
      context.beginPath();
      circle(context, 0, 0, r);
      fill(context, colours.sheet);
      stroke(context, colours['steel-edge'], 0.6);
      context.beginPath();
      context.moveTo(0, 0);
      context.lineTo(r * Math.cos(state.phi), r * Math.sin(state.phi));
      stroke(context, colours.ink, 1.1);
      context.beginPath();
      circle(context, 0, 0, 0.8);
      fill(context, colours.ink);
    }
    // Pins take the colour of their load.
    function load(colours) {
      for (const sleeve of state.sleeves) {
        const force = Math.hypot(sleeve.fx, sleeve.fy);
        if (force === 0) continue;
        context.beginPath();
        context.arc(sleeve.x, sleeve.y, sleeve.r - 0.25, 0, TAU);
        context.globalAlpha = Math.min(0.62, (0.62 * force) / full);
        fill(context, colours.force[shade(force)]);
      }
      context.globalAlpha = 1;
    }
    // An arrow as one outline, `more` thicker all round.
    function arrow({ sleeve: { x, y }, force, fx, fy }, more) {
      const length = Math.min(force / full, 1.35) * reach;
      const [ux, uy] = [fx / force, fy / force];
      const head = Math.min(0.42 * length, 0.05 * radius);
      const thick = 0.5 * (0.35 * head + 0.35) + more;
      const wide = 0.48 * head + 1.4 * more;
      const [neck, tip] = [length - head - more, length + 1.9 * more];
      const point = (along, across) => context.lineTo(x + along * ux - across * uy, y + along * uy + across * ux);
      const angle = Math.atan2(uy, ux);
      context.moveTo(x - thick * uy, y + thick * ux);
      context.arc(x, y, thick, angle + TAU / 4, angle + (3 * TAU) / 4);
      point(neck + 0.2 * head, -thick);
      point(neck, -wide);
      point(tip, 0);
      point(neck, wide);
      point(neck + 0.2 * head, thick);
      context.closePath();
    }
    function arrows(colours) {
      for (const list of shades) list.length = 0;
      context.beginPath();
      state.bodies.forEach((body, i) => {
        if (!options.wheels[i]) return;
        for (let k = 0; k < body.count; k += 1) {
          const push = body.forces[k];
          if (push.force * reach < 0.4 * full) continue;
          shades[shade(push.force)].push(push);
          arrow(push, 0.55);
        }
      });
      fill(context, colours.sheet);
      shades.forEach((list, k) => {
        if (list.length === 0) return;
        context.beginPath();
        for (const push of list) arrow(push, 0);
        fill(context, colours.force[k]);
      });
    }

    /** The state as it is now, with a label at the pin `hovered`; see `ground`. */
    function draw(colours, hovered, once) {
      ground(colours, once);
      upright(context);
      if (gear.ring) plain(context, state.external, colours);
      // The last disc behind.
      for (let i = gear.wheels - 1; i >= 0; i -= 1) if (options.wheels[i]) wheel(i, colours);
      upright(context);
      input(colours);
      plain(context, state.internal, colours);
      if (options.forces) {
        load(colours);
        arrows(colours);
      }
      if (hovered) label(hovered, colours);
    }
    function label(sleeve, colours) {
      context.beginPath();
      circle(context, sleeve.x, sleeve.y, sleeve.r);
      stroke(context, colours.ink, 1);
      const lines = [`${sleeve.kind} ${sleeve.number}: ${Math.hypot(sleeve.fx, sleeve.fy).toFixed(1)} N`];
      if (sleeve.errors.some((error) => Math.abs(error) >= 0.05)) {
        const [out, across, more] = sleeve.errors.map((error) => `${error < -0.05 ? '\u2212' : '+'}${Math.abs(error).toFixed(1)}`);
        lines.push(`radial ${out}, tangential ${across}, radius ${more} \u00b5m`);
      }
      const pixel = size / width;
      context.setTransform(pixel, 0, 0, pixel, 0, 0);
      context.font = colours.font;
      const wide = Math.max(...lines.map((line) => context.measureText(line).width)) + 16;
      const high = 7 + 18 * lines.length;
      const [middle, top] = [width / 2 + (sleeve.x * scale) / pixel, width / 2 - ((sleeve.y + sleeve.r) * scale) / pixel];
      const [x, y] = [Math.min(width - wide - 4, Math.max(4, middle - wide / 2)), Math.max(4, top - high - 7)];
      context.beginPath();
      context.roundRect(x, y, wide, high, 6);
      fill(context, colours.ink);
      context.fillStyle = colours.sheet;
      context.textBaseline = 'middle';
      lines.forEach((line, k) => context.fillText(line, x + 8, y + 13 + 18 * k));
    }
    /** The pin under a point of the canvas, CSS pixels from its corner. */
    function under([left, top]) {
      const mm = (2 * half) / width;
      const [x, y] = [(left - width / 2) * mm, (width / 2 - top) * mm];
      let [best, found] = [1.6, null];
      for (const sleeve of state.sleeves) {
        const distance = Math.hypot(sleeve.x - x, sleeve.y - y) / sleeve.r;
        if (distance < best) [best, found] = [distance, sleeve];
      }
      return found;
    }
    /** Colours have changed. */
    const repaint = () => { still = null; };
    return { draw, under, resize, repaint };
  }
  return { palette, picture };
})();
