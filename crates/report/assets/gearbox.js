// A gearbox at any sample of its courses: where its parts are and what pushes them. Lengths in mm.
//
// A view holds the gear's dimensions; its channels are angles (less the ideal mesh's) and
// the force of every pair of disc and pin. Where a force acts and in which direction is found here
// on the same curve the solver uses: a pin is pushed along the epitrochoid's normal at the point
// closest to its centre.
'use strict';
const PinwheelGearbox = (() => {
  const TAU = 2 * Math.PI;

  // Values between samples lie on the straight line between them.
  const between = (values, at) => {
    const k = Math.min(values.length - 1, Math.max(0, Math.floor(at)));
    const next = Math.min(values.length - 1, k + 1);
    return values[k] + (at - k) * (values[next] - values[k]);
  };

  function curve({ e, zk, m, own }) {
    const r = (e * zk) / m;
    return (a) => {
      const [c, s, ck, sk] = [Math.cos(a), Math.sin(a), Math.cos(zk * a), Math.sin(zk * a)];
      const [gx, gy] = [r * c + e * zk * ck, r * s + e * zk * sk]; // C' turned by -90 degrees
      const speed = Math.hypot(gx, gy);
      const here = { x: r * c + e * ck, y: r * s + e * sk, nx: gx / speed, ny: gy / speed, speed, ax: -r * c - e * zk * zk * ck, ay: -r * s - e * zk * zk * sk };
      if (!own) return here;
      // An offset inwards along the normal, by values at equal steps over a lobe.
      const per = own.length / TAU;
      const place = ((zk - 1) * a * per) % own.length;
      const k = Math.floor(place < 0 ? place + own.length : place) % own.length;
      const [low, high] = [own[k], own[(k + 1) % own.length]];
      const w = low + (high - low) * (place - Math.floor(place));
      const tilt = ((high - low) * per * (zk - 1)) / speed;
      const { nx, ny } = here;
      const size = Math.hypot(1, tilt);
      return { ...here, x: here.x - w * nx, y: here.y - w * ny, nx: (nx - tilt * ny) / size, ny: (ny + tilt * nx) / size };
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

  /** A gearbox of a view and its unpacked channels. `move(sample)` changes `state` in place: nothing is allocated per frame. */
  function gearbox(view, channels) {
    const { gear } = view;
    const zs = gear.zk - 1;
    const radius = gear.r;
    const at = curve(gear);
    const [input, output, error] = channels;
    const wheels = channels.slice(3, 3 + gear.wheels);
    const pair = (i, n) => channels[3 + gear.wheels + i * (gear.zk + gear.zi) + n];
    const offsets = channels.slice(3 + gear.wheels * (1 + gear.zk + gear.zi));

    // The profile as few points: chords of a lobe stay within `tolerance` of it, the other lobes are turned copies.
    function profile(tolerance) {
      const fine = Array.from({ length: 241 }, (_, k) => {
        const p = at((TAU / zs) * (k / 240));
        const [x, y] = [p.x - gear.edge * p.nx, p.y - gear.edge * p.ny];
        // Flanks are turned towards the middle of their lobes: this one's, and the next one's beyond the pit.
        const turn = k < 120 ? -gear.turn : gear.turn;
        return [x - turn * y, y + turn * x];
      });
      const within = (from, to) => {
        const [[x, y], [x2, y2]] = [fine[from], fine[to]];
        const length = Math.hypot(x2 - x, y2 - y) || 1;
        for (let k = from + 1; k < to; k += 1) {
          if (Math.abs((x2 - x) * (fine[k][1] - y) - (y2 - y) * (fine[k][0] - x)) > tolerance * length) return false;
        }
        return true;
      };
      const lobe = [];
      for (let from = 0; from < 240;) {
        lobe.push(fine[from]);
        let to = from + 1;
        while (to < 240 && within(from, to + 1)) to += 1;
        from = to;
      }
      return Array.from({ length: zs }, (_, n) => {
        const [c, s] = [Math.cos((TAU * n) / zs), Math.sin((TAU * n) / zs)];
        return lobe.map(([x, y]) => [c * x - s * y, s * x + c * y]);
      }).flat();
    }

    // A part in the frame of what holds it, and its errors in micrometres: outwards, counter-clockwise, of its radius.
    function part(kind, number, [px, py, r], [count, circle, nominal]) {
      const beta = (TAU * number) / count;
      const [c, s] = [Math.cos(beta), Math.sin(beta)];
      const errors = [px * c + py * s - circle, py * c - px * s, r - nominal].map((mm) => 1e3 * mm);
      return { kind, number, beta, px, py, x: px, y: py, r, errors, fx: 0, fy: 0 };
    }
    const external = gear.external.map((place, k) => part('external', k, place, [gear.zk, radius + gear.d, gear.q]));
    const internal = gear.internal.map((place, k) => part('internal', k, place, [gear.zi, gear.rw, gear.ri]));
    const sleeves = [...external, ...internal];
    const bodies = gear.bodies.map(({ e, phase, holes }) => {
      const forces = sleeves.map((sleeve) => ({ sleeve, force: 0, fx: 0, fy: 0 }));
      return { e, phase, holes, x: 0, y: 0, theta: 0, off: [0, 0], forces, count: 0, loaded: 0 };
    });
    const state = { t: 0, phi: 0, psi: 0, external, internal, sleeves, bodies, input: 0, output: 0 };

    function move(s) {
      const t = view.from + view.step * s;
      const leg = view.motions.findLast((motion) => motion.from_s <= t);
      const since = t - leg.from_s;
      const phi = leg.angle + since * (leg.rate + 0.5 * since * leg.acceleration);
      // Cranks of an RV gear turn at another angle than the input.
      const turned = gear.per * phi;
      const ideal = -turned / zs;
      const psi = (gear.ring ? -ideal : ideal) + between(error, s);
      // Angles of carrier and ring; one of them is held.
      const [carrier, ring] = gear.ring ? [0, psi] : [psi, 0];
      Object.assign(state, { t, phi, psi, input: between(input, s), output: between(output, s) });
      for (const [held, angle] of [[internal, carrier], [external, ring]]) {
        const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
        for (const sleeve of held) {
          sleeve.x = cos * sleeve.px - sin * sleeve.py;
          sleeve.y = sin * sleeve.px + cos * sleeve.py;
        }
      }
      for (const sleeve of sleeves) { sleeve.fx = 0; sleeve.fy = 0; }
      bodies.forEach((body, i) => {
        // The disc's centre: its eccentric's, and what its bearing gives way by.
        for (const k of view.offset > 0 ? [0, 1] : []) body.off[k] = between(offsets[2 * i + k], s);
        const x = body.e * Math.cos(turned + ring + body.phase) + body.off[0];
        const y = body.e * Math.sin(turned + ring + body.phase) + body.off[1];
        const theta = (Math.PI - turned - body.phase) / zs + (gear.ring ? -ideal : 0) + between(wheels[i], s);
        const [c, sn] = [Math.cos(theta), Math.sin(theta)];
        Object.assign(body, { x, y, theta, count: 0, loaded: 0 });
        sleeves.forEach((sleeve, n) => {
          const force = between(pair(i, n), s);
          if (force <= view.least) return;
          const [px, py] = [c * (sleeve.x - x) + sn * (sleeve.y - y), c * (sleeve.y - y) - sn * (sleeve.x - x)];
          let [nx, ny] = [0, 0];
          if (n < gear.zk) {
            ({ nx, ny } = foot(at, px, py, sleeve.beta + ring - theta));
            body.loaded += 1;
          } else if (gear.sun) {
            // The magnitude of a crank bearing's force is known, its direction is not: it gets a colour and no arrow.
            sleeve.fx += force;
            return;
          } else {
            const [hx, hy] = body.holes[sleeve.number];
            const length = Math.hypot(px - hx, py - hy) || 1;
            [nx, ny] = [(hx - px) / length, (hy - py) / length];
          }
          const push = body.forces[body.count];
          body.count += 1;
          push.sleeve = sleeve;
          push.force = force;
          push.fx = force * (c * nx - sn * ny);
          push.fy = force * (sn * nx + c * ny);
          sleeve.fx += push.fx;
          sleeve.fy += push.fy;
        });
      });
    }

    // Largest force of a pair of each kind, sample by sample, for the time line.
    const envelope = (from, count) => {
      const values = new Float32Array(view.count);
      for (let n = from; n < from + count; n += 1) {
        for (let i = 0; i < gear.wheels; i += 1) {
          const forces = pair(i, n);
          for (let k = 0; k < view.count; k += 1) if (forces[k] > values[k]) values[k] = forces[k];
        }
      }
      return values;
    };
    return { view, gear, radius, profile, state, move, external: envelope(0, gear.zk), internal: envelope(gear.zk, gear.zi) };
  }
  return { gearbox, TAU };
})();
