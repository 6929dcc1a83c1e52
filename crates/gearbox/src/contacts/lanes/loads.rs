//! Forces of all touching pairs, summed onto the bodies.

use pinwheel_contact::{Complex, Lanes, PinLaw, Real, RegularisedCoulomb};
use pinwheel_mbs::{ContactEnergy, Wrench};
use pulp::Simd;

use super::columns::Sleeves;
use super::pair_loop::{Group, Sink, Wheel};
use crate::Layout;
use crate::contacts::pin_friction::PinFriction;

/// Adds forces (Eq. 20, 21) to the pins' columns and to the discs' loads, and stored and dissipated energy to `energy`.
pub(super) struct Loads<'a> {
    pub(super) law: PinLaw,
    pub(super) friction: &'a [RegularisedCoulomb; 2],
    pub(super) pins: &'a [Option<PinFriction>; 2],
    pub(super) output_rate: f64,
    pub(super) loads: &'a mut [Wrench],
    pub(super) energy: Option<&'a mut ContactEnergy>,
}

impl Sink for Loads<'_> {
    #[inline(always)]
    fn group<S: Simd>(&mut self, simd: S, group: Group<'_, S>, wheel: &mut Wheel<S>) {
        let (touching, from) = (&group.touching, group.from);
        let (n, arm) = (touching.normal, group.arm());
        let (friction, pins) = (&self.friction[group.side()], &self.pins[group.side()]);
        let rubs = friction.coefficient > 0.0;
        let relative = group.relative_velocity(simd, wheel, rubs);
        let (stiffness, depth) = (touching.stiffness, touching.penetration);
        let (closing, mut sliding) = (relative.dot(n), relative.dot(n.turned()));
        let law = group.law(&self.law);
        let mut drag = depth.like(0.0);
        let pressure = law.force(stiffness, depth, closing);
        let mut on_sleeve = n.scale(-pressure);
        if rubs {
            let one = depth.like(1.0);
            let share = sliding * depth.like(1.0 / friction.ramp);
            drag = pressure * depth.like(-friction.coefficient) * share.max(-one).min(one);
            on_sleeve = n.turned().scale_add(drag, on_sleeve);
        }
        if let Some(pins) = pins {
            let radius = arm.dot(n);
            if !group.external {
                // Sliding speed of a sleeve that does not turn on its pin.
                sliding = radius.mul_add(depth.like(self.output_rate), sliding);
            }
            drag = pins.along_lanes(simd, [pressure, radius, sliding]);
            on_sleeve = n.turned().scale_add(drag, on_sleeve);
            if !group.external {
                let couple = (radius * drag).only(touching.mask);
                self.loads[Layout::OUTPUT].moment += couple.sum();
            }
        }
        if let Some(energy) = &mut self.energy {
            let mask = touching.mask;
            let [_, elastic, stored] = law.observed(stiffness, depth, depth.like(0.0));
            energy.stored_j += stored.only(mask).sum();
            energy.damping_w += ((pressure - elastic) * closing).only(mask).sum();
            let lost = match pins {
                Some(_) => &mut energy.sleeve_friction_w,
                None => &mut energy.contact_friction_w,
            };
            *lost -= (drag * sliding).only(mask).sum();
        }
        // Masked lanes may have any value, even NaN.
        let on_sleeve = on_sleeve.only(touching.mask);
        let point = touching.point.only(touching.mask);
        let total = wheel.push(&group, &self.law, n, point, on_sleeve);
        let sleeves = group.sleeves;
        sleeves.force.add(simd, from, total * wheel.turn);
        if rubs {
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
