//! Forces of all touching pairs, summed onto the bodies.

use pinwheel_contact::{Complex, Lanes, LanesLaw, RegularisedCoulomb};
use pinwheel_mbs::Wrench;
use pulp::Simd;

use super::walk::{Group, Sink, Wheel};

/// Adds forces (Eq. 20, 21) to the sleeves' columns and to the wheels' loads.
pub(super) struct Loads<'a, L, const FRICTION: bool> {
    pub(super) law: L,
    pub(super) friction: RegularisedCoulomb,
    pub(super) loads: &'a mut [Wrench],
}

impl<S: Simd, L: LanesLaw, const FRICTION: bool> Sink<S> for Loads<'_, L, FRICTION> {
    #[inline(always)]
    fn group(&mut self, simd: S, group: Group<'_, S>, wheel: &mut Wheel<S>) {
        let (touching, from) = (&group.touching, group.from);
        let (n, arm) = (touching.normal, group.arm());
        let relative = group.relative_velocity::<FRICTION>(simd, wheel);
        let pressure =
            self.law
                .force_lanes(touching.stiffness, touching.penetration, relative.dot(n));
        let mut on_sleeve = n.scale(-pressure);
        if FRICTION {
            let t = n.turned();
            let one = arm.re.like(1.0);
            let share = relative.dot(t) * arm.re.like(1.0 / self.friction.ramp);
            let drag =
                pressure * arm.re.like(-self.friction.coefficient) * share.max(-one).min(one);
            on_sleeve = t.scale_add(drag, on_sleeve);
        }
        // Masked lanes may hold anything, NaN included.
        let on_sleeve = on_sleeve.only(touching.mask);
        let point = touching.point.only(touching.mask);
        wheel.force = wheel.force - on_sleeve;
        wheel.moment = wheel.moment - point.cross(on_sleeve);
        let sleeves = group.sleeves;
        sleeves.force.add(simd, from, on_sleeve * wheel.turn);
        if FRICTION {
            let moment = Lanes::load(simd, &sleeves.moment[from..])
                + arm.only(touching.mask).cross(on_sleeve);
            moment.store(&mut sleeves.moment[from..]);
        }
    }

    #[inline(always)]
    fn end(&mut self, body: usize, wheel: &Wheel<S>) {
        let force = Complex::new(wheel.force.re.sum(), wheel.force.im.sum());
        let ground = force * wheel.turn.lane(0);
        let load = &mut self.loads[body];
        load.fx += ground.re;
        load.fy += ground.im;
        load.moment += wheel.moment.sum();
    }
}
