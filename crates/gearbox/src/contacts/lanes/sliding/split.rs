//! Loads without friction, and the contacts of a friction stage, from one walk.

use pinwheel_contact::{Complex, NormalLaw};
use pinwheel_mbs::Wrench;
use pulp::Simd;

use super::super::walk::{Group, Sink, Wheel};
use super::table::Pair;
use super::{INTERNAL, Sliding};

/// Adds normal forces to the bodies' loads and lists the pairs.
pub(in super::super) struct Split<'a, L> {
    pub(in super::super) law: L,
    pub(in super::super) sliding: &'a mut Sliding,
    pub(in super::super) loads: &'a mut [Wrench],
}

impl<S: Simd, L: NormalLaw> Sink<S> for Split<'_, L> {
    #[inline(always)]
    fn group(&mut self, simd: S, group: Group<'_, S>, wheel: &mut Wheel<S>) {
        let (touching, from, mask) = (&group.touching, group.from, group.touching.mask);
        let n = touching.normal.only(mask);
        let t = n.turned();
        let (point, arm) = (touching.point.only(mask), group.arm().only(mask));
        let relative = group.relative_velocity::<true>(simd, wheel);
        let closing = relative.dot(touching.normal).only(mask);
        let depth = touching.penetration.only(mask);
        let stiffness = touching.stiffness.only(mask);
        let pressure = self.law.force_lanes(stiffness, depth, closing).only(mask);

        let on_sleeve = n.scale(-pressure);
        let total = wheel.push(&group, &self.law, n, point, on_sleeve);
        group.sleeves.force.add(simd, from, total * wheel.turn);

        let kind = if group.external { 0 } else { INTERNAL };
        let table = &mut self.sliding.pairs[wheel.number][kind];
        table.activate(from);
        table.put(Pair::Sleeve, from, arm.turned().dot(t));
        table.put(Pair::Wheel, from, -point.turned().dot(t));
        table.put(Pair::ClosingWheel, from, -point.turned().dot(n));
        table.put(Pair::Slip, from, relative.only(mask).dot(t));
        table.put(Pair::Closing, from, closing);
        table.put(Pair::Stiffness, from, stiffness);
        table.put(Pair::Penetration, from, depth);
        table.put(Pair::Listed, from, pressure);
        table.put(Pair::Force, from, pressure);
        if !group.external {
            // The output swings the sleeve's centre about the origin.
            let swing = ((group.p + wheel.centre * wheel.back).turned()).only(mask);
            table.put(Pair::Output, from, swing.dot(t));
            table.put(Pair::ClosingOutput, from, swing.dot(n));
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
