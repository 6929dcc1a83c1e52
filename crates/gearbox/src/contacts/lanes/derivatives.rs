//! Derivatives of the contacts' moments with respect to angles, rates and time: the exact derivative of
//! [`loads`](super::loads).
//!
//! In the disc's frame, with z the pin's centre P, c the disc's centre about the origin, n and t = R90 n at the contact,
//! rho = q - delta (W - P = rho n), theta, psi, sigma and phi the angles of disc, output, pin and input:
//!
//! ```text
//! P moves by     d(delta) n + d(tau) t,    d(delta) = sum ln dq,  d(tau) = sum lt dq
//!   ln = (-P x n, (P + c) x n, -c x n),    lt = (-P.n, (P + c).n, -c.n)      for theta, psi (internal only), phi
//! n turns by     b d(tau) t,               b = -kappa/(1 - kappa delta), or 1/|P - hole|
//! v_n = P'.n,    v_t = P'.t + rho (sigma' - theta')
//! dF = F_K K' d(tau) + F_delta d(delta) + F_v dv_n,    dT = -mu (g dF + F g' dv_t),    g = clamp(v_t/v_s, -1, 1)
//! A = -K' Y,    dA = -(K'' Y + K'^2 Y_K) d(tau) - K' (Y_delta - b Y) d(delta)    of laws with a force along the profile, Y = dU/dK
//! moments:  theta: -F ln + T (-W.n) + A lt,   psi: -F ln + T lt,   sigma: T rho
//! ```
//! The position x, y of a floating disc moves a contact instead of the input, with u one of the ground's axes:
//!
//! ```text
//! ln = -u.n,  lt = -u.t;    force on the disc:  F n - (T + A) t
//! ```
//! The moments are differentiated by the product rule. The derivatives of the normal law are differences of the law, accurate
//! to 1e-9, so that a law need not provide any. At kinks of friction or law the slope of one side applies.

use pinwheel_contact::{ComplexLanes, Lanes, PinLaw, Real, RegularisedCoulomb};
use pinwheel_mbs::{self as mbs, BodyState, Variable};
use pulp::Simd;

use super::pair_loop::{Group, Sink, Wheel};
use crate::Layout;

/// Difference steps of the law to either side: relative to stiffness and to penetration, and of the closing speed (m/s).
const STIFFNESS_SHARE: f64 = 1e-4;
const PENETRATION_SHARE: f64 = 1e-5;
const CLOSING: f64 = 1e-6;

/// Adds the derivatives of the moments about the pins to a Jacobian.
pub(super) struct Derivatives<'a, 'b> {
    law: PinLaw,
    friction: [RegularisedCoulomb; 2],
    derivatives: &'a mut mbs::Derivatives<'b>,
    input_rate: f64,
    output_rate: f64,
    layout: Layout,
    /// True if the positions of the discs are free.
    floats: bool,
}

/// Columns of the motions that move a contact besides the pin's own angle: those of disc, output and input, or the position of
/// a floating disc.
const WHEEL: usize = 0;
const CARRIER: usize = 1;
const INPUT: usize = 2;
const PLACE: usize = 2;

impl<'a, 'b> Derivatives<'a, 'b> {
    pub(super) fn new(
        law: PinLaw,
        friction: [RegularisedCoulomb; 2],
        layout: Layout,
        bodies: &[BodyState],
        derivatives: &'a mut mbs::Derivatives<'b>,
    ) -> Self {
        let first = layout.wheel_bodies().start;
        Self {
            law,
            friction,
            floats: derivatives.coordinates.place(first).is_some(),
            derivatives,
            input_rate: bodies[Layout::INPUT].rate,
            output_rate: bodies[Layout::OUTPUT].rate,
            layout,
        }
    }
}

/// Forces of a contact and their derivatives; 0 without contact.
struct Pressure<S: Simd> {
    force: Lanes<S>,
    by_depth: Lanes<S>,
    by_closing: Lanes<S>,
    /// Derivative by the motion along the profile.
    by_path: Lanes<S>,
    centre: Option<Centre<S>>,
}

/// Force of some laws on the pins' centres along t, and its derivatives by the motion along t and by the depth.
struct Centre<S: Simd> {
    force: Lanes<S>,
    by_path: Lanes<S>,
    by_depth: Lanes<S>,
}

/// Evaluates the law at a stiffness, a depth and a rate. The function is not inlined: it is large, and inlined for each
/// difference it would dominate the code of all kernels.
struct At<'a, S: Simd> {
    law: &'a PinLaw,
    contact: [Lanes<S>; 3],
    /// True on the profile. Holes, of one stiffness each, need no force along them.
    on_profile: bool,
}

impl<S: Simd> pulp::WithSimd for At<'_, S> {
    /// Normal force, and the force along the profile.
    type Output = (Lanes<S>, Option<Lanes<S>>);

    #[inline(always)]
    fn with_simd<T: Simd>(self, _simd: T) -> Self::Output {
        let [stiffness, depth, closing] = self.contact;
        let force = self.law.force(stiffness, depth, closing);
        match self.on_profile {
            true => (force, self.law.along(stiffness, depth)),
            false => (force, None),
        }
    }
}

impl<S: Simd> Pressure<S> {
    #[inline(always)]
    fn new(simd: S, law: &PinLaw, group: &Group<'_, S>, closing: Lanes<S>) -> Self {
        let (touching, mask) = (&group.touching, group.touching.mask);
        let (stiffness, depth) = (touching.stiffness, touching.penetration);
        let (c, law) = (|x: f64| depth.like(x), &group.law(law));
        let at = |stiffness, depth, closing| {
            simd.vectorize(At {
                law,
                contact: [stiffness, depth, closing],
                on_profile: group.external,
            })
        };
        let here = at(stiffness, depth, closing);
        let (more, less) = (c(1.0 + PENETRATION_SHARE), c(1.0 - PENETRATION_SHARE));
        let deeper = at(stiffness, depth * more, closing);
        let flatter = at(stiffness, depth * less, closing);
        let over_depth = (depth * c(2.0 * PENETRATION_SHARE)).recip();
        let faster = at(stiffness, depth, closing + c(CLOSING)).0;
        let slower = at(stiffness, depth, closing - c(CLOSING)).0;
        let mut all = Self {
            force: here.0.only(mask),
            by_depth: ((deeper.0 - flatter.0) * over_depth).only(mask),
            by_closing: ((faster - slower) * c(0.5 / CLOSING)).only(mask),
            by_path: c(0.0),
            centre: None,
        };
        // All holes of a disc have equal stiffness.
        let Some(foot) = touching.foot.as_ref() else {
            return all;
        };
        let derivatives = group.shapes.stiffness_slopes(foot, stiffness);
        let stiffer = at(stiffness * c(1.0 + STIFFNESS_SHARE), depth, closing);
        let softer = at(stiffness * c(1.0 - STIFFNESS_SHARE), depth, closing);
        let over_stiffness = (stiffness * c(2.0 * STIFFNESS_SHARE)).recip();
        all.by_path = (derivatives.along * (stiffer.0 - softer.0) * over_stiffness).only(mask);
        if let (Some(along), Some(deeper), Some(flatter), Some(stiffer), Some(softer)) =
            (here.1, deeper.1, flatter.1, stiffer.1, softer.1)
        {
            let by_stiffness = (stiffer - softer) * over_stiffness;
            let bend =
                derivatives.bend * along + derivatives.along * derivatives.along * by_stiffness;
            // K' itself grows with the depth, by -b of it, because the path of the centre shrinks relative to the foot's.
            let rise = (deeper - flatter) * over_depth;
            let by_depth = derivatives.along * (touching.turning * along - rise);
            all.centre = Some(Centre {
                force: -(derivatives.along * along).only(mask),
                by_path: -bend.only(mask),
                by_depth: by_depth.only(mask),
            });
        }
        all
    }
}

/// Derivatives of the three moments of a contact: on disc, output and pin.
type Moments<S> = [Lanes<S>; 3];

/// Derivatives of the force on a floating disc, along n and along t.
type Force<S> = [Lanes<S>; 2];

impl Derivatives<'_, '_> {
    fn rubs<S: Simd>(&self, group: &Group<'_, S>) -> bool {
        self.friction[group.side()].coefficient > 0.0
    }

    /// Returns the coordinate number of a disc's angle.
    fn hub(&self, wheel: usize) -> Option<usize> {
        let body = self.layout.wheel_bodies().start + wheel;
        self.derivatives.coordinates.angle(body)
    }

    /// Returns the coordinate number of a disc's x, or with `axis` 1 of y.
    fn place(&self, wheel: usize, axis: usize) -> Option<usize> {
        let body = self.layout.wheel_bodies().start + wheel;
        self.derivatives.coordinates.place(body).map(|x| x + axis)
    }

    /// Returns the coordinate number of the output's angle.
    fn output(&self) -> Option<usize> {
        self.derivatives.coordinates.angle(Layout::OUTPUT)
    }

    /// Returns the coordinate number of the angle of lane `k`'s pin.
    #[inline(always)]
    fn sleeve<S: Simd>(&self, group: &Group<'_, S>, k: usize) -> Option<usize> {
        let bodies = match group.external {
            true => self.layout.external_bodies(),
            false => self.layout.internal_bodies(),
        };
        self.derivatives
            .coordinates
            .angle(bodies.start + group.from + k)
    }

    /// Adds a column of derivatives of the moments at a disc.
    #[inline(always)]
    fn add<S: Simd>(
        &mut self,
        by: Variable,
        group: &Group<'_, S>,
        wheel: usize,
        column: Moments<S>,
    ) {
        let rows = [self.hub(wheel), self.output()];
        let count = if group.external { 1 } else { 2 };
        for (&row, moment) in rows.iter().zip(column).take(count) {
            self.derivatives.add(row, &[by], &[moment.sum()]);
        }
        if self.rubs(group) {
            for (k, &value) in column[2].as_slice().iter().enumerate() {
                if value != 0.0 {
                    self.derivatives.add(self.sleeve(group, k), &[by], &[value]);
                }
            }
        }
    }

    /// Adds a column of derivatives of the force on a floating disc.
    #[inline(always)]
    fn add_force<S: Simd>(
        &mut self,
        by: Variable,
        wheel: &Wheel<S>,
        [n, t]: [ComplexLanes<S>; 2],
        force: Force<S>,
    ) {
        if !self.floats {
            return;
        }
        let force = n.scale(force[0]) + t.scale(force[1]);
        for (k, axis) in [wheel.back, wheel.back.turned()].into_iter().enumerate() {
            let row = self.place(wheel.number, k);
            self.derivatives.add(row, &[by], &[axis.dot(force).sum()]);
        }
    }
}

impl Sink for Derivatives<'_, '_> {
    #[inline(always)]
    fn group<S: Simd>(&mut self, simd: S, group: Group<'_, S>, wheel: &mut Wheel<S>) {
        let (touching, mask) = (&group.touching, group.touching.mask);
        let n = touching.normal.only(mask);
        let t = n.turned();
        let turning = touching.turning.only(mask);
        let (p, centre) = (group.p, wheel.centre * wheel.back);
        let z = p + centre;
        let zero = p.re.like(0.0);
        let (along, across, beside) = (p.dot(n), p.cross(n), p.dot(t));
        let (centre_along, centre_across) = (centre.dot(n), centre.cross(n));
        let rho = group.arm().dot(n).only(mask);
        let carrier = if group.external {
            0.0
        } else {
            self.output_rate
        };
        // Rates of the pin's carrier relative to disc and input.
        let (over_wheel, over_input) = (zero.like(carrier) - wheel.rate, carrier - self.input_rate);

        // P' and the relative velocity at W.
        let velocity = group.sleeves.velocity.load(simd, group.from) * wheel.back
            - wheel.velocity
            - p.turned().scale(wheel.rate);
        let (closing, passing) = (velocity.dot(n), velocity.dot(t));
        let (friction, rubs) = (self.friction[group.side()], self.rubs(&group));
        let spin = if rubs {
            Lanes::load(simd, &group.sleeves.rate[group.from..]) - wheel.rate
        } else {
            zero
        };
        let pressure = Pressure::new(simd, &self.law, &group, closing);
        let force = pressure.force;
        // T = -mu F g, and its derivatives by F and by v_t.
        let one = zero.like(1.0);
        let (mut drag, mut drag_by_force, mut drag_by_slip) = (zero, zero, zero);
        if rubs {
            let share = rho.mul_add(spin, passing) * one.like(1.0 / friction.ramp);
            let sticking = one.only(share.abs().less(one));
            drag_by_force = share.max(-one).min(one) * one.like(-friction.coefficient);
            drag = drag_by_force * force;
            let slope = -friction.coefficient / friction.ramp;
            drag_by_slip = sticking * force * one.like(slope);
        }

        let axes = [wheel.back, wheel.back.turned()];
        let mut normal_levers = [-across, z.cross(n), -centre_across, zero];
        let mut levers = [-along, z.dot(n), -centre_along, zero];
        if group.external {
            (normal_levers[CARRIER], levers[CARRIER]) = (zero, zero);
        }
        let floats = self.floats;
        if floats {
            for (k, axis) in [(PLACE, axes[0]), (PLACE + 1, axes[1])] {
                (normal_levers[k], levers[k]) = (-axis.dot(n), -axis.dot(t));
            }
        }
        let turns = [-one, zero, one];
        // Lever of the disc's rate in the sliding speed: W instead of P.
        let wheel_lever = -(along + rho);
        for k in 0..if floats { PLACE + 2 } else { INPUT + 1 } {
            if k == CARRIER && group.external {
                continue;
            }
            let (depth, path) = (normal_levers[k], levers[k]);
            let tilt = turning * path;
            let is_place = floats && k >= PLACE;
            // Change of z with the rotation of n: its moment on n, and along n.
            let (mut aside, mut against) = (tilt * z.dot(n), zero);
            let (mut slower, mut faster);
            if is_place {
                slower = wheel.rate * path + tilt * passing;
                faster = -(wheel.rate * depth);
            } else {
                let turn = turns[k];
                let by_centre = centre_along * turn;
                aside = aside - path - by_centre;
                against = depth + centre_across * turn;
                slower = -(over_wheel * path) + tilt * passing;
                slower = slower - by_centre * one.like(over_input);
                faster = over_wheel * depth + centre_across * turn * one.like(over_input);
            }
            if floats && k == WHEEL {
                // In the disc's frame all velocities rotate.
                slower = passing + tilt * passing;
                faster = -closing;
            }
            faster = faster - tilt * closing - depth * spin;
            let push =
                pressure.by_path * path + pressure.by_depth * depth + pressure.by_closing * slower;
            let pull = drag_by_force * push + drag_by_slip * faster;
            let mut on_wheel = -(push * normal_levers[WHEEL]) - force * (path - tilt * along)
                + pull * wheel_lever
                - drag * tilt * beside;
            let (mut at_centre, mut more_at_centre) = (zero, zero);
            if let Some(Centre {
                force,
                by_path,
                by_depth,
            }) = pressure.centre
            {
                (at_centre, more_at_centre) = (force, by_path * path + by_depth * depth);
                on_wheel =
                    on_wheel + more_at_centre * levers[WHEEL] - force * (depth + tilt * beside);
            }
            let on_output = -(push * normal_levers[CARRIER]) - force * aside
                + pull * levers[CARRIER]
                + drag * (against + tilt * z.dot(t));
            let on_sleeve = rho * pull - depth * drag;
            let column = [on_wheel, on_output, on_sleeve];
            let number = wheel.number;
            if k == INPUT && !floats {
                self.add(Variable::Time(self.input_rate), &group, number, column);
                continue;
            }
            let of = match k {
                WHEEL => self.hub(number),
                CARRIER => self.output(),
                _ => self.place(number, k - PLACE),
            };
            let Some(of) = of else { continue };
            self.add(Variable::Position(of), &group, number, column);
            let tilt = if k == WHEEL { tilt + one } else { tilt };
            let across = push + (drag + at_centre) * tilt;
            let beside = force * tilt - pull - more_at_centre;
            self.add_force(Variable::Position(of), wheel, [n, t], [across, beside]);
            let lever = if k == WHEEL { wheel_lever } else { path };
            let push = pressure.by_closing * depth;
            let pull = drag_by_force * push + drag_by_slip * lever;
            let column = [
                pull * wheel_lever - push * normal_levers[WHEEL],
                pull * levers[CARRIER] - push * normal_levers[CARRIER],
                rho * pull,
            ];
            self.add(Variable::Rate(of), &group, number, column);
            self.add_force(Variable::Rate(of), wheel, [n, t], [push, -pull]);
        }
        if rubs {
            let pull = drag_by_slip * rho;
            let rows = [pull * wheel_lever, pull * levers[CARRIER], pull * rho];
            for k in 0..Lanes::<S>::COUNT {
                let own = rows[2].as_slice()[k];
                if own == 0.0 {
                    continue;
                }
                let Some(sleeve) = self.sleeve(&group, k) else {
                    continue;
                };
                let (hub, output) = (self.hub(wheel.number), self.output());
                let by = [Variable::Rate(sleeve)];
                self.derivatives.add(Some(sleeve), &by, &[own]);
                self.derivatives.add(hub, &by, &[rows[0].as_slice()[k]]);
                self.derivatives.add(output, &by, &[rows[1].as_slice()[k]]);
                if self.floats {
                    for (k_axis, axis) in axes.iter().enumerate() {
                        let value = -(axis.dot(t) * pull);
                        let row = self.place(wheel.number, k_axis);
                        self.derivatives.add(row, &by, &[value.as_slice()[k]]);
                    }
                }
            }
        }
    }
}
