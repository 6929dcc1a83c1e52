//! Contacts of a gear whose bodies have the poses that their joints prescribe, from angles, rates and the positions of floating
//! discs.
//!
//! With phi, psi, theta the angles of input, output and disc, f the phase of the disc's eccentric, b the distance of pin
//! centres outside of C (the backlash, less a radial modification), a0 the parameter of the foot of a pin in direction beta in
//! the ideal mesh, and E = e^{i zs a0}, the pin's centre has the offset q from C(a0), in directions turned by a0 (see
//! [`local_feet`](pinwheel_contact::Epitrochoid::local_feet)):
//!
//! ```text
//! q = b + k E,   k = -e (1 + e^{i (phi + f + zs theta)}),   E = e^{-i zs theta} / beta
//! ```
//! k is 0 at the ideal mesh. Rates and moments follow from levers alone, with n pointing from the pin's centre P to the disc, z
//! = P + c from the origin, c the eccentric:
//!
//! ```text
//! d(delta)/dt = ln.(theta', psi', phi'),    ln = (-P x n, z x n (output pins), -c x n),    moments = -F ln
//! external, T and g those of the foot:   P x n = -e zs sin(zs a)/sqrt(g),   c x n = -(R + b) Im T/sqrt(g) - P x n
//! internal, h the hole's centre, s the pin's place on the output:
//!   n = o/|o|,  o = s e^{i psi} - h e^{i theta} - c,   P x n = h e^{i theta} x n,   c x n = z x n - P x n
//! ```
//!
//! A floating disc has its centre for c in k, `k = -e - c e^{i zs theta}`, and its own velocity v in the closing speed instead
//! of the input's: -v.n for -c x n phi'.
//!
//! **Candidate pins.** P is certainly outside where `H |q|^2 < q.(1 + m E)` (`local_feet`), in units of R. Both sides are the
//! first harmonic of the position along the ring, as |E| = 1:
//!
//! ```text
//! X + Re((Y + i Z) E) > 0,   X = b + m Re k - H (b^2 + |k|^2),   Y + i Z = k + m b - 2 H b k
//! ```
//! The pins that are not certainly outside are therefore neighbours. They are processed a register at a time, and two
//! registers, of any discs, in parallel.

mod internal;

use std::mem::take;

use pinwheel_contact::{Complex, ComplexLanes, Lanes, Mask, PinLaw, Real};
use pinwheel_mbs::{self as mbs, BodyState, ContactEnergy, Wrench};
use pulp::Simd;

use super::columns::{Column, PADDING};
use super::shapes::Shapes;
use crate::Layout;
use crate::contacts::pin_friction::PinFriction;
use crate::geometry::Geometry;
use crate::scene::Scene;

/// Bound of rounding in the test of points outside, in units of R.
const ROUNDING: f64 = 1e-14;

/// Number of pins at the ends of a window: the one before it, its first, its last, the one after.
const ENDS: usize = 4;
/// Signs of the end pins: 1 if certainly outside, -1 if not, for all lanes of a register.
const SIGNS: [f64; PADDING / 2] = [1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0];

/// Constants of the field, and memory for its variables.
#[derive(Debug, Clone)]
pub(super) struct JointSpace {
    layout: Layout,
    /// True if discs have no joint.
    pub(super) floats: bool,
    /// Eccentric e e^{if} of every disc, m.
    eccentrics: Vec<Complex>,
    eccentricity: f64,
    backlash: f64,
    radius: f64,
    lobes: f64,
    shortening: f64,
    /// Bound H of the test for points outside.
    repulsion: f64,
    /// Friction of sleeves on ring and on output pins.
    pins: [Option<PinFriction>; 2],
    /// Radii of ring and output pins, m.
    sleeve_radii: [f64; 2],
    /// Inverse directions 1/beta of the ring pins, with the first ones repeated after the last.
    directions: Column,
    /// Positions of the output pins on the output, m.
    points: Column,
    angles: Vec<f64>,
    units: Column,
    wheels: Vec<Wheel>,
    /// Segments of ring and of output pins, two side by side. Those of ring pins stay valid until another pin comes near, so
    /// that the evaluation need not wait for the test.
    segments: [Vec<[Segment; 2]>; 2],
    /// Directions of the pins at the [`ENDS`] of the windows, a register for each disc, and true if every disc has ends.
    ends: Column,
    is_bounded: bool,
    /// Forces on the pins, N, ground frame; those on ring pins in the frame of their directions. 0 between evaluations.
    forces: [Column; 2],
}

/// Disc at the present angles.
#[derive(Debug, Clone, Copy, Default)]
struct Wheel {
    /// Centre c, m.
    centre: Complex,
    /// Rotation e^{i theta}.
    turn: Complex,
    /// Offset factor k, in units of R.
    mesh: Complex,
    /// Phase e^{-i zs theta}.
    phase: Complex,
    /// Coefficients X and Y + i Z.
    off: f64,
    swing: Complex,
    rate: f64,
    force: Complex,
    moment: f64,
}

/// Neighbouring pins at a disc, at most a register.
#[derive(Debug, Clone, Copy)]
struct Segment {
    wheel: usize,
    from: usize,
    /// Number of pins, in the type of a mask.
    count: f64,
}

/// Sums over all contacts, lane by lane.
struct Evaluation<S: Simd> {
    /// True if energy is requested.
    asked: bool,
    /// True if loads on pins are requested.
    on_sleeves: bool,
    /// Moments on input (with `LOADS`) and output.
    on_input: Lanes<S>,
    on_output: Lanes<S>,
    /// Friction couple of the output pins.
    on_pins: Lanes<S>,
    /// Stored energy, if requested.
    stored: Lanes<S>,
    dissipated: Lanes<S>,
    rubbed: Lanes<S>,
}

/// Numbers of a register's lanes.
const NUMBERS: [f64; PADDING] = [
    0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0,
];

#[inline(always)]
fn present<S: Simd>(simd: S, [a, b]: [Segment; 2]) -> Mask<S> {
    let numbers = Lanes::load_pair(simd, [&NUMBERS, &NUMBERS]);
    numbers.less(Lanes::splat_pair(simd, [a.count, b.count]))
}

/// Returns `x + Re(swing E)`, above 0 for a pin certainly outside.
#[inline(always)]
fn gap<S: Simd>(direction: ComplexLanes<S>, swing: ComplexLanes<S>, x: Lanes<S>) -> Lanes<S> {
    let imaginary = direction.im.mul_add(-swing.im, x);
    direction.re.mul_add(swing.re, imaginary)
}

/// Appends the registers of `count` pins from `from` on, the first beside a last one without a partner.
#[inline(always)]
fn split<S: Simd>(
    segments: &mut Vec<[Segment; 2]>,
    wheel: usize,
    from: usize,
    count: usize,
    around: usize,
) {
    for done in (0..count).step_by(S::F64_LANES) {
        let from = from + done;
        let segment = Segment {
            wheel,
            from: if from < around { from } else { from - around },
            count: (count - done).min(S::F64_LANES) as f64,
        };
        let none = Segment {
            count: 0.0,
            ..segment
        };
        match segments.last_mut() {
            Some([_, beside]) if beside.count == 0.0 => *beside = segment,
            _ => segments.push([segment, none]),
        }
    }
}

/// Adds the repeated values after `count`, one register of them, to the first ones.
#[inline(always)]
fn fold(values: &mut [f64], count: usize) {
    let (first, again) = values.split_at_mut(count);
    let Some(again) = again.first_chunk_mut::<{ PADDING / 2 }>() else {
        return;
    };
    let more = take(again);
    // A known length, because a loop would not be vectorised.
    if let Some(first) = first.first_chunk_mut::<{ PADDING / 2 }>() {
        for j in 0..more.len() {
            first[j] += more[j];
        }
    } else {
        for j in 0..count {
            first[j] += more[j];
        }
    }
}

/// Adds the reactions of two segments of pins to their discs.
#[inline(always)]
fn react<S: Simd>(wheels: &mut [Wheel], pair: [Segment; 2], push: ComplexLanes<S>) {
    let (x, y) = (push.re.sums(), push.im.sums());
    for (k, segment) in pair.iter().enumerate() {
        let wheel = &mut wheels[segment.wheel];
        wheel.force = wheel.force - Complex::new(x[k], y[k]);
    }
}

impl Column {
    #[inline(always)]
    fn load_pair<S: Simd>(&self, simd: S, [a, b]: [Segment; 2]) -> ComplexLanes<S> {
        ComplexLanes::new(
            Lanes::load_pair(simd, [&self.x[a.from..], &self.x[b.from..]]),
            Lanes::load_pair(simd, [&self.y[a.from..], &self.y[b.from..]]),
        )
    }

    #[inline(always)]
    fn add_pair<S: Simd>(&mut self, pair: [Segment; 2], value: ComplexLanes<S>) {
        for (k, segment) in pair.iter().enumerate() {
            value.re.add_register(k, &mut self.x[segment.from..]);
            value.im.add_register(k, &mut self.y[segment.from..]);
        }
    }

    #[inline(always)]
    fn at(&self, k: usize) -> Complex {
        Complex::new(self.x[k], self.y[k])
    }

    /// Returns x and y of `count` values from `from` on.
    #[inline(always)]
    fn part(&self, from: usize, count: usize) -> [&[f64]; 2] {
        [&self.x[from..][..count], &self.y[from..][..count]]
    }
}

impl JointSpace {
    pub(super) fn new(scene: &Scene, geometry: &Geometry) -> Self {
        let gear = &scene.gear;
        let layout = Layout::of(gear);
        let (zk, zi) = (layout.external_sleeves, layout.internal_sleeves);
        let directions = &geometry.external_directions;
        let around = (0..zk + PADDING).map(|k| directions[k % zk].conj());
        let angles = vec![0.0; (2 + 2 * layout.wheels).next_multiple_of(PADDING)];
        let nothing = |n: usize| Column::padded((0..n).map(|_| Complex::default()));
        let directions = Column::padded(around);
        Self {
            layout,
            floats: scene.bearings.eccentric.is_some(),
            eccentrics: geometry
                .wheel_phases
                .iter()
                .map(|&f| Complex::unit(f).scale(gear.eccentricity_m))
                .collect(),
            eccentricity: gear.eccentricity_m,
            // Distance of pin centres outside of C, including a radial modification.
            backlash: gear.pitch_radius_m() + gear.backlash_m - geometry.curve.pitch_radius(),
            radius: geometry.curve.pitch_radius(),
            lobes: f64::from(geometry.curve.lobes()),
            shortening: gear.generating_shortening(),
            repulsion: geometry.curve.repulsion(),
            pins: PinFriction::of(scene),
            sleeve_radii: [gear.external_sleeve_radius_m, gear.internal_sleeve_radius_m],
            points: Column::padded(geometry.internal_points.iter().map(|&p| p.into())),
            units: nothing(angles.len()),
            angles,
            wheels: vec![Wheel::default(); layout.wheels],
            ends: nothing(layout.wheels * PADDING / 2),
            is_bounded: false,
            segments: [zk, zi].map(|sleeves| Vec::with_capacity(layout.wheels * (sleeves + 1))),
            forces: [nothing(directions.x.len()), nothing(zi)],
            directions,
        }
    }

    /// Evaluates the forces at the angles and rates of `bodies`; only floating discs' positions are read. Returns the moments
    /// on discs and output, with `LOADS` also the input's and all bodies' loads. Contacts are frictionless. Floating discs need
    /// `LOADS`.
    #[inline(always)]
    pub(super) fn run<S: Simd, const LOADS: bool>(
        &mut self,
        simd: S,
        law: &PinLaw,
        shapes: &Shapes,
        bodies: &[BodyState],
        request: &mut mbs::Evaluation<'_>,
    ) {
        let output = self.place::<S, LOADS>(simd, bodies);
        let nothing = Lanes::splat(simd, 0.0);
        let mut sums = Evaluation {
            asked: LOADS && request.energy.is_some(),
            on_sleeves: !self.floats || !request.floating_alone,
            on_input: nothing,
            on_output: nothing,
            on_pins: nothing,
            stored: nothing,
            dissipated: nothing,
            rubbed: nothing,
        };
        self.external::<S, LOADS>(simd, &law.on(law.ring_n_m), shapes, bodies, &mut sums);
        self.internal::<S, LOADS>(simd, law, shapes, bodies, output, &mut sums);
        if LOADS && let Some(loads) = &mut request.loads {
            if sums.on_sleeves {
                self.scatter(loads);
            }
            self.scatter_wheels(loads);
            if self.pins[1].is_some() {
                loads[Layout::OUTPUT].moment += sums.on_pins.sum();
            }
        }
        if sums.asked {
            request.energy = Some(ContactEnergy {
                stored_j: sums.stored.sum(),
                damping_w: sums.dissipated.sum(),
                sleeve_friction_w: sums.rubbed.sum(),
                ..ContactEnergy::default()
            });
        }
        if let Some(moments) = &mut request.moments {
            moments[Layout::INPUT] += sums.on_input.sum();
            moments[Layout::OUTPUT] += sums.on_output.sum();
            let on_wheels = &mut moments[self.layout.wheel_bodies()];
            for (total, wheel) in on_wheels.iter_mut().zip(&self.wheels) {
                *total += wheel.moment;
            }
        }
    }

    /// Sets the discs from the angles of the bodies; returns e^{i psi}.
    #[inline(always)]
    fn place<S: Simd, const LOADS: bool>(&mut self, simd: S, bodies: &[BodyState]) -> Complex {
        let n = self.wheels.len();
        let hubs = &bodies[self.layout.wheel_bodies()][..n];
        self.angles[0] = bodies[Layout::INPUT].angle;
        self.angles[1] = bodies[Layout::OUTPUT].angle;
        let (turns, multiples) = self.angles[2..2 + 2 * n].split_at_mut(n);
        for k in 0..n {
            turns[k] = hubs[k].angle;
            multiples[k] = self.lobes * hubs[k].angle;
        }
        for from in (0..2 + 2 * n).step_by(S::F64_LANES) {
            let unit = ComplexLanes::units(Lanes::load_first(simd, &self.angles[from..]));
            unit.re.store_first(&mut self.units.x[from..]);
            unit.im.store_first(&mut self.units.y[from..]);
        }
        let (units, input) = (&self.units, self.units.at(0));
        let (turns, multiples) = (units.part(2, n), units.part(2 + n, n));
        let eccentrics = &self.eccentrics[..n];
        let (h, m, b) = (self.repulsion, self.shortening, self.backlash / self.radius);
        let wheels = &mut self.wheels[..n];
        for k in 0..n {
            let centre = if LOADS && self.floats {
                Complex::new(hubs[k].x, hubs[k].y)
            } else {
                eccentrics[k] * input
            };
            let multiple = Complex::new(multiples[0][k], multiples[1][k]);
            let off = centre * multiple + Complex::new(self.eccentricity, 0.0);
            let (mesh, phase) = (off.scale(-1.0 / self.radius), multiple.conj());
            wheels[k] = Wheel {
                centre,
                turn: Complex::new(turns[0][k], turns[1][k]),
                mesh,
                phase,
                off: b + m * mesh.re - h * (b * b + mesh.norm2()) - ROUNDING,
                swing: (mesh.scale(1.0 - 2.0 * h * b) + Complex::new(m * b, 0.0)) * phase,
                rate: hubs[k].rate,
                ..Wheel::default()
            };
        }
        units.at(1)
    }

    /// Lists the ring pins that are not certainly outside.
    #[inline(always)]
    fn list_external<S: Simd>(&mut self, simd: S) {
        let count = self.layout.external_sleeves;
        if self.stays(simd) {
            return;
        }
        let mut segments = take(&mut self.segments[0]);
        segments.clear();
        self.is_bounded = S::F64_LANES >= ENDS;
        for (number, wheel) in self.wheels.iter().enumerate() {
            // First and last near pin: the pin before the first and the one after the last are outside.
            let (mut any, mut first, mut last) = (false, None, 0);
            for from in (0..count).step_by(Lanes::<S>::COUNT) {
                let before = if from == 0 { count } else { from } - 1;
                let present = Mask::first(simd, count - from);
                let inside = present.without(self.outside(simd, wheel, from));
                any |= inside.any();
                let begins = inside.and(self.outside(simd, wheel, before)).first_set();
                let ends = inside.and(self.outside(simd, wheel, from + 1)).first_set();
                if begins < Lanes::<S>::COUNT {
                    first = Some(from + begins);
                }
                if ends < Lanes::<S>::COUNT {
                    last = from + ends;
                }
            }
            let Some(first) = first else {
                self.is_bounded = false;
                let near = if any { count } else { 0 };
                split::<S>(&mut segments, number, 0, near, count);
                continue;
            };
            let near = (last + count - first) % count + 1;
            split::<S>(&mut segments, number, first, near, count);
            for k in 0..PADDING / 2 {
                let end = [first + count - 1, first, last, last + 1][k % ENDS];
                let (to, end) = (number * PADDING / 2 + k, self.directions.at(end % count));
                (self.ends.x[to], self.ends.y[to]) = (end.re, end.im);
            }
        }
        self.segments[0] = segments;
    }

    /// Returns the mask of the ring pins from `from` on that are certainly outside of a disc.
    #[inline(always)]
    fn outside<S: Simd>(&self, simd: S, wheel: &Wheel, from: usize) -> Mask<S> {
        let directions = self.directions.load(simd, from);
        let swing = ComplexLanes::splat(simd, wheel.swing);
        let gap = gap(directions, swing, Lanes::splat(simd, wheel.off));
        Lanes::splat(simd, 0.0).less(gap)
    }

    /// True if the listed pins are still the near ones: the first and the last are near, and the pins beside them are not. Near
    /// pins are neighbours, so these four decide for all.
    #[inline(always)]
    fn stays<S: Simd>(&self, simd: S) -> bool {
        if !self.is_bounded {
            return false;
        }
        let signs = Lanes::load_pair(simd, [&SIGNS, &SIGNS]);
        for from in (0..self.wheels.len()).step_by(2) {
            let beside = (from + 1).min(self.wheels.len() - 1);
            let (one, two) = (&self.wheels[from], &self.wheels[beside]);
            let (first, second) = (from * PADDING / 2, beside * PADDING / 2);
            let (x, y) = (&self.ends.x, &self.ends.y);
            let ends = ComplexLanes::new(
                Lanes::load_pair(simd, [&x[first..], &x[second..]]),
                Lanes::load_pair(simd, [&y[first..], &y[second..]]),
            );
            let swing = ComplexLanes::splat_pair(simd, [one.swing, two.swing]);
            let gap = gap(ends, swing, Lanes::splat_pair(simd, [one.off, two.off]));
            // At exactly 0 the list is renewed.
            if (gap * signs).less(gap.like(f64::MIN_POSITIVE)).any() {
                return false;
            }
        }
        true
    }

    /// Returns the velocities of the centres of a pair's discs, m/s.
    #[inline(always)]
    fn velocities<S: Simd>(
        &self,
        simd: S,
        bodies: &[BodyState],
        pair: [Segment; 2],
    ) -> ComplexLanes<S> {
        let first = self.layout.wheel_bodies().start;
        let [one, two] = [
            &bodies[first + pair[0].wheel],
            &bodies[first + pair[1].wheel],
        ];
        ComplexLanes::new(
            Lanes::splat_pair(simd, [one.vx, two.vx]),
            Lanes::splat_pair(simd, [one.vy, two.vy]),
        )
    }

    #[inline(always)]
    fn external<S: Simd, const LOADS: bool>(
        &mut self,
        simd: S,
        law: &PinLaw,
        shapes: &Shapes,
        bodies: &[BodyState],
        sums: &mut Evaluation<S>,
    ) {
        self.list_external(simd);
        let c = |x: f64| Lanes::splat(simd, x);
        let (b, r) = (self.backlash, self.radius);
        let zk = self.lobes + 1.0;
        for &pair in &self.segments[0] {
            let (one, two) = (&self.wheels[pair[0].wheel], &self.wheels[pair[1].wheel]);
            let direction = self.directions.load_pair(simd, pair);
            let phase = ComplexLanes::splat_pair(simd, [one.phase, two.phase]) * direction;
            let mut offset = ComplexLanes::splat_pair(simd, [one.mesh, two.mesh]) * phase;
            offset.re = offset.re + c(b / r);
            let foot = shapes.curve.local_feet(offset, phase, present(simd, pair));
            let (inside, depth) = shapes.pressed(&foot);
            if !inside.any() {
                continue;
            }
            let stiffness = shapes.profile_stiffness(foot.curvature);
            let wheel_lever = foot.sin * foot.inverse * c(-r * self.lobes / zk);
            let input_lever = foot.outward.im * foot.inverse * c(-(r + b)) - wheel_lever;
            let wheel_rate = Lanes::splat_pair(simd, [one.rate, two.rate]);
            // Direction -n.
            let away = foot.outward.scale(foot.inverse).times_conj(direction);
            let closing = if LOADS && self.floats {
                self.velocities(simd, bodies, pair).dot(away) - wheel_lever * wheel_rate
            } else {
                -(wheel_lever * wheel_rate) - input_lever * c(bodies[Layout::INPUT].rate)
            };
            let force = if sums.asked {
                let observed = law.observed(stiffness, depth, closing);
                sums.add_energy(observed, closing, inside)
            } else {
                law.force(stiffness, depth, closing)
            };
            let pressure = force.only(inside);
            let mut moment = (wheel_lever * force).only(inside);
            let mut beside = None;
            let along = law.along(stiffness, depth);
            if along.is_some() || self.pins[0].is_some() {
                // -P.n = (C.T + r.T)/sqrt(g), and -c.n = (R + b) Re T/sqrt(g) less that.
                let m2 = c(self.shortening * self.shortening);
                let reach = (foot.cos + m2).mul_add(c(r / zk), (foot.cos + c(1.0)) * c(r));
                let level = reach * foot.inverse - foot.depth;
                let centre = foot.outward.re * foot.inverse * c(r + b) - level;
                let mut tangential = c(0.0);
                if let Some(along) = along {
                    let derivatives = shapes.stiffness_slopes(&foot, stiffness);
                    tangential = -(derivatives.along * along).only(inside);
                    moment = moment + tangential * level.only(inside);
                }
                if let Some(pins) = &self.pins[0] {
                    let radius = c(self.sleeve_radii[0]) - depth;
                    // (W - c).n.
                    let lever = radius - level;
                    let carried = if LOADS && self.floats {
                        -self.velocities(simd, bodies, pair).dot(away.turned())
                    } else {
                        -(centre * c(bodies[Layout::INPUT].rate))
                    };
                    let passing = -(lever * wheel_rate) - carried;
                    let drag = pins
                        .along_lanes(simd, [force, radius, passing])
                        .only(inside);
                    moment = moment - drag * lever.only(inside);
                    if sums.asked {
                        sums.rubbed = sums.rubbed - drag * passing.only(inside);
                    }
                    tangential = tangential + drag;
                }
                if LOADS && !self.floats {
                    sums.on_input = sums.on_input + tangential * centre.only(inside);
                }
                beside = Some(tangential);
            }
            if LOADS && !self.floats {
                sums.on_input = sums.on_input + (input_lever * force).only(inside);
            }
            let moment = moment.sums();
            self.wheels[pair[0].wheel].moment += moment[0];
            self.wheels[pair[1].wheel].moment += moment[1];
            if LOADS {
                // n = -T/sqrt(g), t = R90 n.
                let normal = foot.outward.scale(foot.inverse).only(inside);
                let mut push = normal.scale(pressure);
                if let Some(along) = beside {
                    push = push - normal.turned().scale(along);
                }
                let push = push.times_conj(direction);
                if sums.on_sleeves {
                    self.forces[0].add_pair(pair, push);
                }
                react(&mut self.wheels, pair, push);
            }
        }
    }

    /// Adds the forces of the pins to the bodies and resets them to 0.
    #[inline(always)]
    fn scatter(&mut self, loads: &mut [Wrench]) {
        let layout = &self.layout;
        let kinds = [layout.external_bodies(), layout.internal_bodies()];
        // No zipped iterators: the compiler may leave them outside of the function with the vector instructions.
        for (kind, bodies) in kinds.iter().enumerate() {
            let (forces, count) = (&mut self.forces[kind], bodies.len());
            if kind == 0 {
                fold(&mut forces.x, count);
                fold(&mut forces.y, count);
            }
            let (x, y) = (&mut forces.x[..count], &mut forces.y[..count]);
            let loads = &mut loads[bodies.clone()][..count];
            for j in 0..count {
                let (fx, fy) = (take(&mut x[j]), take(&mut y[j]));
                loads[j] = Wrench {
                    fx,
                    fy,
                    moment: 0.0,
                };
            }
        }
    }

    /// Writes the forces and moments of the discs to the loads of the bodies.
    #[inline(always)]
    fn scatter_wheels(&self, loads: &mut [Wrench]) {
        for (k, load) in loads[self.layout.wheel_bodies()].iter_mut().enumerate() {
            let wheel = &self.wheels[k];
            (load.fx, load.fy, load.moment) = (wheel.force.re, wheel.force.im, wheel.moment);
        }
    }
}

impl<S: Simd> Evaluation<S> {
    /// Adds the energy that the contacts inside store and dissipate, `observed` by their law; returns the force.
    #[inline(always)]
    fn add_energy(
        &mut self,
        [force, elastic, stored]: [Lanes<S>; 3],
        closing: Lanes<S>,
        inside: Mask<S>,
    ) -> Lanes<S> {
        self.stored = self.stored + stored.only(inside);
        self.dissipated = self.dissipated + ((force - elastic) * closing).only(inside);
        force
    }
}
