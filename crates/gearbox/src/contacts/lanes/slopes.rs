//! How the contacts' moments change with angles, rates and time: the exact derivative of [`loads`](super::loads).
//!
//! In the wheel's frame, with z the sleeve's centre P, c the wheel's centre about the origin, n and t = R90 n at the contact,
//! rho = q - delta (W - P = rho n), theta, psi, sigma and phi the angles of wheel, output, sleeve and input:
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
//! and the moments are differentiated by the product rule. The slopes of the normal law are differences of the law itself,
//! right to 1e-9, so that a law needs none of its own. Where friction or law have a kink, one side's slope counts.

use pinwheel_contact::{Lanes, Law, NormalLaw, Real, RegularisedCoulomb};
use pinwheel_mbs::{Arrow, BodyState, Jacobian};
use pulp::Simd;

use super::pair_loop::{Group, Sink, Wheel};
use crate::Layout;
use crate::contacts::pairs::{CLOSING, OUTPUT, PENETRATION_SHARE, STIFFNESS_SHARE};

/// Adds the slopes of the moments about the pins to a Jacobian.
pub(super) struct Slopes<'a, const FRICTION: bool> {
    law: Law,
    friction: RegularisedCoulomb,
    position: &'a mut Arrow,
    rate: &'a mut Arrow,
    time: &'a mut [f64],
    input_rate: f64,
    output_rate: f64,
    /// Sleeves' first body, external and internal.
    first: [usize; 2],
}

/// The angles that move a contact besides the sleeve's own: wheel, output, input.
const WHEEL: usize = 0;
const CARRIER: usize = 1;
const INPUT: usize = 2;
const ANGLES: usize = 3;

impl<'a, const FRICTION: bool> Slopes<'a, FRICTION> {
    /// `None` for a Jacobian that is not of second order.
    pub(super) fn new(
        law: Law,
        friction: RegularisedCoulomb,
        layout: Layout,
        bodies: &[BodyState],
        slopes: &'a mut Jacobian,
    ) -> Option<Self> {
        Some(Self {
            law,
            friction,
            position: slopes.position.as_mut()?,
            rate: &mut slopes.rate,
            time: &mut slopes.time,
            input_rate: bodies[Layout::INPUT].rate,
            output_rate: bodies[Layout::OUTPUT].rate,
            first: [
                layout.external_bodies().start,
                layout.internal_bodies().start,
            ],
        })
    }
}

/// A contact's normal force and its slopes.
struct Pressure<S: Simd> {
    force: Lanes<S>,
    by_stiffness: Lanes<S>,
    by_depth: Lanes<S>,
    by_closing: Lanes<S>,
}

impl<S: Simd> Pressure<S> {
    #[inline(always)]
    fn new(law: &Law, group: &Group<'_, S>, closing: Lanes<S>) -> Self {
        let (touching, mask) = (&group.touching, group.touching.mask);
        let (stiffness, depth) = (touching.stiffness, touching.penetration);
        let c = |x: f64| depth.like(x);
        let (more, less) = (c(1.0 + STIFFNESS_SHARE), c(1.0 - STIFFNESS_SHARE));
        let by_stiffness = (law.force(stiffness * more, depth, closing)
            - law.force(stiffness * less, depth, closing))
            * (stiffness * c(2.0 * STIFFNESS_SHARE)).recip();
        let (more, less) = (c(1.0 + PENETRATION_SHARE), c(1.0 - PENETRATION_SHARE));
        let by_depth = (law.force(stiffness, depth * more, closing)
            - law.force(stiffness, depth * less, closing))
            * (depth * c(2.0 * PENETRATION_SHARE)).recip();
        let by_closing = (law.force(stiffness, depth, closing + c(CLOSING))
            - law.force(stiffness, depth, closing - c(CLOSING)))
            * c(0.5 / CLOSING);
        Self {
            force: law.force(stiffness, depth, closing).only(mask),
            by_stiffness: by_stiffness.only(mask),
            by_depth: by_depth.only(mask),
            by_closing: by_closing.only(mask),
        }
    }
}

/// How K grows along the profile, and the force that some laws have there.
struct Profile<S: Simd> {
    stiffening: Lanes<S>,
    centre: Option<Centre<S>>,
}

/// A force on the sleeves' centres along t and its slopes by the way along t and by the depth; 0 where nothing touches.
struct Centre<S: Simd> {
    force: Lanes<S>,
    by_path: Lanes<S>,
    by_depth: Lanes<S>,
}

impl<S: Simd> Profile<S> {
    #[inline(always)]
    fn new(law: &Law, group: &Group<'_, S>) -> Self {
        let (touching, mask) = (&group.touching, group.touching.mask);
        let depth = touching.penetration;
        let c = |x: f64| depth.like(x);
        let Some(foot) = touching.foot.as_ref() else {
            return Self {
                stiffening: c(0.0),
                centre: None,
            };
        };
        let stiffness = touching.stiffness;
        let slopes = group.shapes.stiffness_slopes(foot, stiffness);
        let (more, less) = (c(1.0 + PENETRATION_SHARE), c(1.0 - PENETRATION_SHARE));
        let (stiffer, softer) = (c(1.0 + STIFFNESS_SHARE), c(1.0 - STIFFNESS_SHARE));
        let all = (
            law.along(stiffness, depth),
            law.along(stiffness, depth * more),
            law.along(stiffness, depth * less),
            law.along(stiffness * stiffer, depth),
            law.along(stiffness * softer, depth),
        );
        let centre = if let (Some(along), Some(more), Some(less), Some(stiffer), Some(softer)) = all
        {
            let rise = (more - less) * (depth * c(2.0 * PENETRATION_SHARE)).recip();
            let by_stiffness = (stiffer - softer) * (stiffness * c(2.0 * STIFFNESS_SHARE)).recip();
            let bend = slopes.bend * along + slopes.along * slopes.along * by_stiffness;
            // K' itself grows with the depth, as the way of the centre shrinks against the foot's: by -b of it.
            let by_depth = slopes.along * (touching.turning * along - rise);
            Some(Centre {
                force: -(slopes.along * along).only(mask),
                by_path: -bend.only(mask),
                by_depth: by_depth.only(mask),
            })
        } else {
            None
        };
        Self {
            stiffening: slopes.along.only(mask),
            centre,
        }
    }
}

/// Slopes of the three moments of a contact: on the wheel, on the output, on the sleeve.
type Moments<S> = [Lanes<S>; 3];

impl<const FRICTION: bool> Slopes<'_, FRICTION> {
    /// Adds a column of slopes, of the angle or rate `of` a hub, or of the time.
    #[inline(always)]
    fn add<S: Simd>(
        &mut self,
        target: Target,
        group: &Group<'_, S>,
        hub: usize,
        column: Moments<S>,
    ) {
        let rows = [hub, OUTPUT];
        let count = if group.external { 1 } else { 2 };
        for (&row, moment) in rows.iter().zip(column).take(count) {
            self.put(target, row, moment.sum());
        }
        if FRICTION {
            for (k, &value) in column[2].as_slice().iter().enumerate() {
                if value != 0.0 {
                    self.put(target, self.sleeve(group, k), value);
                }
            }
        }
    }

    #[inline(always)]
    fn put(&mut self, target: Target, row: usize, value: f64) {
        match target {
            Target::Position(of) => self.position.add(row, of, value),
            Target::Rate(of) => self.rate.add(row, of, value),
            Target::Time => self.time[row] += value,
        }
    }

    /// Place of lane `k`'s sleeve among the free bodies.
    #[inline(always)]
    fn sleeve<S: Simd>(&self, group: &Group<'_, S>, k: usize) -> usize {
        self.first[usize::from(!group.external)] - 1 + group.from + k
    }
}

/// What the columns of slopes are by, and where they go.
#[derive(Clone, Copy)]
enum Target {
    Position(usize),
    Rate(usize),
    Time,
}

impl<const FRICTION: bool> Sink for Slopes<'_, FRICTION> {
    #[inline(always)]
    fn group<S: Simd>(&mut self, simd: S, group: Group<'_, S>, wheel: &mut Wheel<S>) {
        let (touching, mask) = (&group.touching, group.touching.mask);
        let n = touching.normal.only(mask);
        let t = n.turned();
        let turning = touching.turning.only(mask);
        let (p, centre) = (group.p, wheel.centre * wheel.back);
        let z = p + centre;
        let zero = p.re.like(0.0);
        let profile = Profile::new(&self.law, &group);
        let (along, across, beside) = (p.dot(n), p.cross(n), p.dot(t));
        let (centre_along, centre_across) = (centre.dot(n), centre.cross(n));
        let rho = group.arm().dot(n).only(mask);
        let carrier = if group.external {
            0.0
        } else {
            self.output_rate
        };
        // Of the sleeve's carrier against wheel and input.
        let (over_wheel, over_input) = (zero.like(carrier) - wheel.rate, carrier - self.input_rate);

        // P' and the relative velocity at W.
        let velocity = group.sleeves.velocity.load(simd, group.from) * wheel.back
            - wheel.velocity
            - p.turned().scale(wheel.rate);
        let (closing, passing) = (velocity.dot(n), velocity.dot(t));
        let spin = if FRICTION {
            Lanes::load(simd, &group.sleeves.rate[group.from..]) - wheel.rate
        } else {
            zero
        };
        let pressure = Pressure::new(&self.law, &group, closing);
        let force = pressure.force;
        // T = -mu F g, and its slopes by F and by v_t.
        let one = zero.like(1.0);
        let (mut drag, mut drag_by_force, mut drag_by_slip) = (zero, zero, zero);
        if FRICTION {
            let share = rho.mul_add(spin, passing) * one.like(1.0 / self.friction.ramp);
            let sticking = one.only(share.abs().less(one));
            drag_by_force = share.max(-one).min(one) * one.like(-self.friction.coefficient);
            drag = drag_by_force * force;
            let slope = -self.friction.coefficient / self.friction.ramp;
            drag_by_slip = sticking * force * one.like(slope);
        }

        let mut normal_levers = [-across, z.cross(n), -centre_across];
        let mut levers = [-along, z.dot(n), -centre_along];
        if group.external {
            (normal_levers[CARRIER], levers[CARRIER]) = (zero, zero);
        }
        let turns = [-one, zero, one];
        // What the sliding speed depends on the wheel's rate with: W instead of P.
        let wheel_lever = -(along + rho);
        for k in 0..ANGLES {
            if k == CARRIER && group.external {
                continue;
            }
            let (depth, path, turn) = (normal_levers[k], levers[k], turns[k]);
            let tilt = turning * path;
            let by_centre = centre_along * turn;
            let mut slower = -(over_wheel * path) + tilt * passing;
            slower = slower - by_centre * one.like(over_input);
            let faster = over_wheel * depth + centre_across * turn * one.like(over_input)
                - tilt * closing
                - depth * spin;
            let push = pressure.by_stiffness * profile.stiffening * path
                + pressure.by_depth * depth
                + pressure.by_closing * slower;
            let pull = drag_by_force * push + drag_by_slip * faster;
            let mut on_wheel = -(push * normal_levers[WHEEL]) - force * (path - tilt * along)
                + pull * wheel_lever
                - drag * tilt * beside;
            if let Some(Centre {
                force,
                by_path,
                by_depth,
            }) = profile.centre
            {
                on_wheel = on_wheel + (by_path * path + by_depth * depth) * levers[WHEEL]
                    - force * (depth + tilt * beside);
            }
            let on_output = -(push * normal_levers[CARRIER])
                - force * (tilt * z.dot(n) - path - by_centre)
                + pull * levers[CARRIER]
                + drag * (depth + centre_across * turn + tilt * z.dot(t));
            let on_sleeve = rho * pull - depth * drag;
            let column = [on_wheel, on_output, on_sleeve];
            let hub = 1 + wheel.number;
            if k == INPUT {
                let rate = one.like(self.input_rate);
                let column = [on_wheel * rate, on_output * rate, on_sleeve * rate];
                self.add(Target::Time, &group, hub, column);
            } else {
                let of = if k == WHEEL { hub } else { OUTPUT };
                self.add(Target::Position(of), &group, hub, column);
                let lever = if k == WHEEL { wheel_lever } else { path };
                let push = pressure.by_closing * depth;
                let pull = drag_by_force * push + drag_by_slip * lever;
                let column = [
                    pull * wheel_lever - push * normal_levers[WHEEL],
                    pull * levers[CARRIER] - push * normal_levers[CARRIER],
                    rho * pull,
                ];
                self.add(Target::Rate(of), &group, hub, column);
            }
        }
        if FRICTION {
            let pull = drag_by_slip * rho;
            let rows = [pull * wheel_lever, pull * levers[CARRIER], pull * rho];
            for k in 0..Lanes::<S>::COUNT {
                let own = rows[2].as_slice()[k];
                if own != 0.0 {
                    let sleeve = self.sleeve(&group, k);
                    self.rate.add(sleeve, sleeve, own);
                    self.rate
                        .add(1 + wheel.number, sleeve, rows[0].as_slice()[k]);
                    self.rate.add(OUTPUT, sleeve, rows[1].as_slice()[k]);
                }
            }
        }
    }
}
