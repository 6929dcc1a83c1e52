//! Visits touching pairs one by one after a search in lanes.

use pinwheel_contact::{PinLaw, Real, RegularisedCoulomb};
use pulp::Simd;

use super::pair_loop::{Group, Sink, Wheel};
use crate::Sleeve;
use crate::contacts::detection::Touch;
use crate::contacts::motion::WheelFrame;
use crate::contacts::pair::PairContact;
use crate::contacts::pairs::Loaded;

/// Passes every touching pair, with rates and forces, to `visit`.
pub(super) struct ActivePairs<'a, 'v> {
    pub(super) law: PinLaw,
    pub(super) friction: [RegularisedCoulomb; 2],
    pub(super) visit: &'a mut (dyn FnMut(&PairContact) + 'v),
}

impl Sink for ActivePairs<'_, '_> {
    #[inline(always)]
    fn group<S: Simd>(&mut self, simd: S, group: Group<'_, S>, wheel: &mut Wheel<S>) {
        let touching = &group.touching;
        let arm = group.arm();
        let relative = group.relative_velocity(simd, wheel, true);
        let normal_rate = relative.dot(touching.normal);
        let tangential_rate = relative.dot(touching.normal.turned());
        let (stiffness, depth) = (touching.stiffness, touching.penetration);
        let law = group.law(&self.law);
        let [pressure, ..] = law.observed(stiffness, depth, normal_rate);
        let along = group.along(&self.law);
        let frame = WheelFrame {
            centre: wheel.centre.lane(0),
            turn: wheel.turn.lane(0),
            velocity: wheel.velocity.lane(0),
            rate: wheel.rate.as_slice()[0],
        };
        let ones = pressure.like(1.0).only(touching.mask);
        let ones = ones.as_slice();
        for k in (0..ones.len()).filter(|&k| ones[k] != 0.0) {
            let number = group.from + k;
            let normal_force = pressure.as_slice()[k];
            let tangential_rate = tangential_rate.as_slice()[k];
            let pair = Loaded {
                touch: Touch {
                    point: touching.point.lane(k),
                    normal: touching.normal.lane(k),
                    penetration: touching.penetration.as_slice()[k],
                    stiffness: touching.stiffness.as_slice()[k],
                    stiffness_slope: 0.0,
                },
                arm: arm.lane(k),
                normal_rate: normal_rate.as_slice()[k],
                tangential_rate,
                normal_force,
                friction_force: self.friction[group.side()].force(normal_force, tangential_rate),
                along_force: along.map_or(0.0, |along| along.as_slice()[k]),
                pin_n_m: law.pin_n_m,
                shared_j: 0.0,
            };
            let sleeve = if group.external {
                Sleeve::External(number)
            } else {
                Sleeve::Internal(number)
            };
            (self.visit)(&pair.contact(&self.law, wheel.number, sleeve, &frame));
        }
    }
}
