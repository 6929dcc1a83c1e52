//! Loop over all pairs of discs and pins, a group of lanes at a time.

use pinwheel_contact::{Complex, ComplexLanes, Lanes, PinLaw};
use pinwheel_mbs::BodyState;
use pulp::Simd;

use super::columns::Sleeves;
use super::shapes::{Shapes, Touching};
use crate::Layout;

/// Columns of all pins and shapes of all curves, the inputs of a loop over the pairs.
pub(super) struct LanePairs {
    pub(super) layout: Layout,
    pub(super) shapes: Shapes,
    pub(super) external: Sleeves,
    pub(super) internal: Sleeves,
}

/// Frame of a disc, and the sums of its contacts' loads (in that frame).
pub(super) struct Wheel<S: Simd> {
    pub(super) number: usize,
    pub(super) centre: ComplexLanes<S>,
    /// Rotation e^{i theta}, disc frame to ground.
    pub(super) turn: ComplexLanes<S>,
    /// Inverse of `turn`.
    pub(super) back: ComplexLanes<S>,
    pub(super) velocity: ComplexLanes<S>,
    pub(super) rate: Lanes<S>,
    pub(super) force: ComplexLanes<S>,
    pub(super) moment: Lanes<S>,
}

impl<S: Simd> Wheel<S> {
    #[inline(always)]
    fn new(simd: S, number: usize, b: &BodyState) -> Self {
        let turn = Complex::unit(b.angle);
        let back = turn.conj();
        let splat = |z| ComplexLanes::splat(simd, z);
        Self {
            number,
            centre: splat(Complex::new(b.x, b.y)),
            turn: splat(turn),
            back: splat(back),
            velocity: splat(Complex::new(b.vx, b.vy) * back),
            rate: Lanes::splat(simd, b.rate),
            force: splat(Complex::default()),
            moment: Lanes::splat(simd, 0.0),
        }
    }

    /// Adds the reactions of the force `on_sleeve` at `point`, 0 without contact, and of the law's force along the profile at
    /// the pins' centres; returns the total force on the pins.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        group: &Group<'_, S>,
        law: &PinLaw,
        n: ComplexLanes<S>,
        point: ComplexLanes<S>,
        on_sleeve: ComplexLanes<S>,
    ) -> ComplexLanes<S> {
        let mut total = on_sleeve;
        self.moment = self.moment - point.cross(on_sleeve);
        if let Some(along) = group.along(law) {
            // P x t = P.n, and t = R90 n.
            self.moment = self.moment - group.p.dot(n).only(group.touching.mask) * along;
            total = n.turned().only(group.touching.mask).scale_add(along, total);
        }
        self.force = self.force - total;
        total
    }
}

/// Lanes of one group, some of which touch.
pub(super) struct Group<'a, S: Simd> {
    /// True for ring pins, else output pins.
    pub(super) external: bool,
    /// Number of the group's first pin.
    pub(super) from: usize,
    /// Pin centres in the disc's frame.
    pub(super) p: ComplexLanes<S>,
    pub(super) touching: Touching<S>,
    pub(super) shapes: &'a Shapes,
    pub(super) sleeves: &'a mut Sleeves,
}

impl<S: Simd> Group<'_, S> {
    /// Returns 0 for ring pins and 1 for output pins.
    #[inline(always)]
    pub(super) fn side(&self) -> usize {
        usize::from(!self.external)
    }

    /// Returns the arm W - P, m.
    #[inline(always)]
    pub(super) fn arm(&self) -> ComplexLanes<S> {
        self.touching.point - self.p
    }

    /// Returns the law of the group's contacts.
    #[inline(always)]
    pub(super) fn law(&self, law: &PinLaw) -> PinLaw {
        if self.external {
            law.on(law.ring_n_m)
        } else {
            *law
        }
    }

    /// Returns the force on the pins at their centres along t, N, in touching lanes, and 0 in others; `None` if the law has no
    /// such force.
    #[inline(always)]
    pub(super) fn along(&self, law: &PinLaw) -> Option<Lanes<S>> {
        let touching = &self.touching;
        let foot = touching.foot.as_ref()?;
        let along = self
            .law(law)
            .along(touching.stiffness, touching.penetration)?;
        let derivatives = self.shapes.stiffness_slopes(foot, touching.stiffness);
        Some(-(derivatives.along * along).only(touching.mask))
    }

    /// Returns the velocity of the pins relative to the disc at W, in the disc's frame; see `Pairs::load`. A pin's spin moves W
    /// across the normal only, so it may be omitted without friction.
    #[inline(always)]
    pub(super) fn relative_velocity(
        &self,
        simd: S,
        wheel: &Wheel<S>,
        spin: bool,
    ) -> ComplexLanes<S> {
        let relative = self.sleeves.velocity.load(simd, self.from) * wheel.back
            - wheel.velocity
            - self.touching.point.turned().scale(wheel.rate);
        if spin {
            let rate = Lanes::load(simd, &self.sleeves.rate[self.from..]);
            self.arm().turned().scale_add(rate, relative)
        } else {
            relative
        }
    }
}

/// Operation on touching pairs.
pub(super) trait Sink {
    /// Processes a group of which some lanes touch.
    fn group<S: Simd>(&mut self, simd: S, group: Group<'_, S>, wheel: &mut Wheel<S>);

    /// Ends a disc (body index `body`), all of whose groups were evaluated.
    #[inline(always)]
    fn end<S: Simd>(&mut self, _body: usize, _wheel: &Wheel<S>) {}

    /// Ends the loop after the last disc; `sleeves`: columns of ring pins and output pins with their sums.
    #[inline(always)]
    fn finish(&mut self, _sleeves: [&Sleeves; 2]) {}
}

/// Visits every group with a touching pair: disc by disc, ring pins before output pins.
#[inline(always)]
pub(super) fn pair_loop<S: Simd>(
    simd: S,
    pairs: &mut LanePairs,
    bodies: &[BodyState],
    mut sink: impl Sink,
) {
    let LanePairs {
        layout,
        shapes,
        external,
        internal,
    } = pairs;
    external.gather(bodies);
    internal.gather(bodies);
    for (i, body) in layout.wheel_bodies().enumerate() {
        let mut wheel = Wheel::new(simd, i, &bodies[body]);
        // In the ideal mesh the foot of pin j is at a0 = beta_j - theta, and zk beta_j is a multiple of 2 pi.
        let multiple = wheel.back.lane(0).powu(shapes.zk);
        let multiple = ComplexLanes::splat(simd, multiple);
        for (from, present) in external.groups(simd) {
            let p = (external.position.load(simd, from) - wheel.centre) * wheel.back;
            let unit = shapes.directions.load(simd, from) * wheel.back;
            let touching = shapes.profile(p, unit, multiple, present);
            if touching.mask.any() {
                let group = Group {
                    external: true,
                    from,
                    p,
                    touching,
                    shapes,
                    sleeves: external,
                };
                sink.group(simd, group, &mut wheel);
            }
        }
        for (from, present) in internal.groups(simd) {
            let p = (internal.position.load(simd, from) - wheel.centre) * wheel.back;
            let centres = shapes.holes[i].load(simd, from);
            let touching = shapes.hole(p, centres, present);
            if touching.mask.any() {
                let group = Group {
                    external: false,
                    from,
                    p,
                    touching,
                    shapes,
                    sleeves: internal,
                };
                sink.group(simd, group, &mut wheel);
            }
        }
        sink.end(body, &wheel);
    }
    sink.finish([external, internal]);
}
