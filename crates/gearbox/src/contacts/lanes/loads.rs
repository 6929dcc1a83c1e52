//! Forces of all touching pairs, summed onto the bodies.

use pinwheel_contact::{Complex, Lanes, NormalLaw, PinLaw, Real, RegularisedCoulomb};
use pinwheel_mbs::{ContactEnergy, Wrench};
use pulp::Simd;

use super::columns::Sleeves;
use super::pair_loop::{Group, Sink, Wheel};

/// Adds forces (Eq. 20, 21) to the sleeves' columns and to the wheels' loads, and with `ENERGY` what they store and
/// dissipate.
pub(super) struct Loads<'a, const FRICTION: bool, const ENERGY: bool> {
    pub(super) law: PinLaw,
    pub(super) friction: RegularisedCoulomb,
    pub(super) loads: &'a mut [Wrench],
    pub(super) energy: &'a mut ContactEnergy,
}

impl<const FRICTION: bool, const ENERGY: bool> Sink for Loads<'_, FRICTION, ENERGY> {
    #[inline(always)]
    fn group<S: Simd>(&mut self, simd: S, group: Group<'_, S>, wheel: &mut Wheel<S>) {
        let (touching, from) = (&group.touching, group.from);
        let (n, arm) = (touching.normal, group.arm());
        let relative = group.relative_velocity::<FRICTION>(simd, wheel);
        let (stiffness, depth) = (touching.stiffness, touching.penetration);
        let closing = relative.dot(n);
        let pressure = group.force(&self.law, depth, closing);
        let mut on_sleeve = n.scale(-pressure);
        if ENERGY {
            let mask = touching.mask;
            let at_rest = depth.like(0.0);
            let [_, elastic, stored] = if group.external {
                self.law.law.observed(stiffness, depth, at_rest)
            } else {
                self.law.observed(stiffness, depth, at_rest)
            };
            self.energy.stored_j += stored.only(mask).sum();
            self.energy.damping_w += ((pressure - elastic) * closing).only(mask).sum();
        }
        if FRICTION {
            let t = n.turned();
            let one = arm.re.like(1.0);
            let sliding = relative.dot(t);
            let share = sliding * arm.re.like(1.0 / self.friction.ramp);
            let drag =
                pressure * arm.re.like(-self.friction.coefficient) * share.max(-one).min(one);
            on_sleeve = t.scale_add(drag, on_sleeve);
            if ENERGY {
                self.energy.friction_w -= (drag * sliding).only(touching.mask).sum();
            }
        }
        // Masked lanes may hold anything, NaN included.
        let on_sleeve = on_sleeve.only(touching.mask);
        let point = touching.point.only(touching.mask);
        let total = wheel.push(&group, &self.law, n, point, on_sleeve);
        let sleeves = group.sleeves;
        sleeves.force.add(simd, from, total * wheel.turn);
        if FRICTION {
            let moment = Lanes::load(simd, &sleeves.moment[from..])
                + arm.only(touching.mask).cross(on_sleeve);
            moment.store(&mut sleeves.moment[from..]);
        }
    }

    #[inline(always)]
    fn end<S: Simd>(&mut self, body: usize, wheel: &Wheel<S>) {
        let force = Complex::new(wheel.force.re.sum(), wheel.force.im.sum());
        let ground = force * wheel.turn.lane(0);
        let load = &mut self.loads[body];
        load.fx += ground.re;
        load.fy += ground.im;
        load.moment += wheel.moment.sum();
    }

    #[inline(always)]
    fn finish(&mut self, sleeves: [&Sleeves; 2]) {
        for sleeves in sleeves {
            sleeves.scatter(self.loads);
        }
    }
}
