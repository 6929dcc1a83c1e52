//! All pairs of wheels and sleeves, several at a time: the fast form of [`pairs`](super::pairs).
//!
//! Exact detection only. Sleeve states stand in structure-of-arrays columns, padded to whole groups
//! of lanes whose surplus is masked. Formulas, signs and frames are those of the scalar loop, which
//! stays as the oracle (tests: equal to 1e-13 relative). The vector instructions are chosen when the
//! program runs, by what the processor has.

mod columns;
mod levers;
mod listing;
mod loads;
mod shapes;
mod sliding;
mod slopes;
mod walk;

use pinwheel_contact::{Law, NormalLaw, RegularisedCoulomb};
use pinwheel_faults::{Fault, factor};
use pinwheel_mbs::sliding::RateStage;
use pinwheel_mbs::{BodyState, Jacobian, Wrench};
use pulp::Simd;

use super::detection::Exact;
use super::field::{ContactEnergy, ContactField, PairContact};
use super::pairs::Pairs;
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::{Layout, Sleeve};
use columns::Sleeves;
use levers::{Found, Levers};
use listing::{Listing, Visit};
use loads::Loads;
use shapes::Shapes;
use sliding::{Sliding, Split};
use slopes::Slopes;
use walk::{Sink, walk};

/// The contact field with exact detection, in lanes.
pub(super) struct LaneField {
    arch: pulp::Arch,
    law: Law,
    friction: RegularisedCoulomb,
    pairs: LanePairs,
    /// Without friction.
    levers: Option<Levers>,
    /// For single pairs, where lanes gain nothing.
    scalar: Pairs<Law, Exact>,
    /// With friction, if the gear has no more wheels than there is room for.
    sliding: Option<Sliding>,
}

/// What a walk needs.
struct LanePairs {
    layout: Layout,
    shapes: Shapes,
    external: Sleeves,
    internal: Sleeves,
}

/// One walk, as the dispatcher wants it: what is inlined here is compiled once per instruction set.
struct Walk<'a, K> {
    pairs: &'a mut LanePairs,
    bodies: &'a [BodyState],
    sink: K,
}

/// A walk that leaves its sums in the sleeves' columns.
struct SumWalk<'a, L, const FRICTION: bool, const ENERGY: bool>(
    Walk<'a, Loads<'a, L, FRICTION, ENERGY>>,
);

/// A walk that visits.
struct ListWalk<'a, 'v, L>(Walk<'a, Listing<'a, 'v, L>>);

/// A walk that lists the contacts of a friction stage.
struct SplitWalk<'a, L>(Walk<'a, Split<'a, L>>);

impl<K> Walk<'_, K> {
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S)
    where
        K: Sink<S>,
    {
        let LanePairs {
            layout,
            shapes,
            external,
            internal,
        } = self.pairs;
        let sleeves = [external, internal];
        walk(simd, *layout, shapes, sleeves, self.bodies, &mut self.sink);
    }
}

impl<L: NormalLaw, const FRICTION: bool, const ENERGY: bool> pulp::WithSimd
    for SumWalk<'_, L, FRICTION, ENERGY>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        self.0.run(simd);
        self.0.pairs.external.scatter(self.0.sink.loads);
        self.0.pairs.internal.scatter(self.0.sink.loads);
    }
}

impl<L: NormalLaw> pulp::WithSimd for ListWalk<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        self.0.run(simd);
    }
}

impl<L: NormalLaw> pulp::WithSimd for SplitWalk<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        self.0.run(simd);
        self.0.pairs.external.scatter(self.0.sink.loads);
        self.0.pairs.internal.scatter(self.0.sink.loads);
    }
}

/// A walk that adds up slopes.
struct SlopeWalk<'a, L, const FRICTION: bool>(Walk<'a, Slopes<'a, L, FRICTION>>);

impl<L: NormalLaw, const FRICTION: bool> pulp::WithSimd for SlopeWalk<'_, L, FRICTION> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        self.0.run(simd);
    }
}

/// Angles and rates to moments or loads.
struct LeverWalk<'a, 'b, L, const LOADS: bool> {
    levers: &'a mut Levers,
    shapes: &'a Shapes,
    law: L,
    bodies: &'a [BodyState],
    found: &'a mut Found<'b>,
}

impl<L: NormalLaw, const LOADS: bool> pulp::WithSimd for LeverWalk<'_, '_, L, LOADS> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            levers,
            shapes,
            law,
            bodies,
            found,
        } = self;
        levers.run::<S, L, LOADS>(simd, &law, shapes, bodies, found);
    }
}

impl LaneField {
    pub(super) fn new(scene: &Scene, geometry: &Geometry, law: Law, arch: pulp::Arch) -> Self {
        let contact = &scene.contact;
        let layout = Layout::of(&scene.gear);
        let friction = RegularisedCoulomb {
            coefficient: contact.friction_coefficient,
            ramp: contact.friction_ramp_m_s,
        };
        Self {
            arch,
            law,
            friction: RegularisedCoulomb {
                ramp: friction.ramp * factor(Fault::FrictionSign, -1.0),
                ..friction
            },
            levers: (friction.coefficient == 0.0).then(|| Levers::new(scene, geometry)),
            sliding: (friction.coefficient > 0.0)
                .then(|| Sliding::new(layout, friction))
                .flatten(),
            pairs: LanePairs {
                layout,
                shapes: Shapes::new(scene, geometry),
                external: Sleeves::new(layout.external_bodies()),
                internal: Sleeves::new(layout.internal_bodies()),
            },
            scalar: Pairs::new(scene, geometry, law, Exact::new(scene, geometry, &law)),
        }
    }

    fn sum<const FRICTION: bool, const ENERGY: bool>(
        &mut self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
    ) -> ContactEnergy {
        let mut energy = ContactEnergy::default();
        let sink = Loads::<Law, FRICTION, ENERGY> {
            law: self.law,
            friction: self.friction,
            loads,
            energy: &mut energy,
        };
        let pairs = &mut self.pairs;
        self.arch.dispatch(SumWalk(Walk {
            pairs,
            bodies,
            sink,
        }));
        energy
    }

    /// False, and nothing was added, where something rubs.
    fn levers<const LOADS: bool>(&mut self, bodies: &[BodyState], found: &mut Found<'_>) -> bool {
        let Some(levers) = self.levers.as_mut() else {
            return false;
        };
        let walk = LeverWalk::<_, LOADS> {
            levers,
            shapes: &self.pairs.shapes,
            law: self.law,
            bodies,
            found,
        };
        self.arch.dispatch(walk);
        true
    }

    fn slopes<const FRICTION: bool>(
        &mut self,
        bodies: &[BodyState],
        slopes: &mut Jacobian,
    ) -> bool {
        let layout = self.pairs.layout;
        let sink = Slopes::<_, FRICTION>::new(self.law, self.friction, layout, bodies, slopes);
        let Some(sink) = sink else {
            return false;
        };
        let pairs = &mut self.pairs;
        self.arch.dispatch(SlopeWalk(Walk {
            pairs,
            bodies,
            sink,
        }));
        true
    }

    fn list(&mut self, bodies: &[BodyState], visit: &mut Visit<'_>) {
        let sink = Listing {
            law: self.law,
            friction: self.friction,
            visit,
        };
        let pairs = &mut self.pairs;
        self.arch.dispatch(ListWalk(Walk {
            pairs,
            bodies,
            sink,
        }));
    }
}

impl ContactField for LaneField {
    fn add_loads(&mut self, bodies: &[BodyState], loads: &mut [Wrench]) {
        if self.friction.coefficient > 0.0 {
            self.sum::<true, false>(bodies, loads);
        } else {
            self.sum::<false, false>(bodies, loads);
        }
    }

    fn add_loads_with_energy(
        &mut self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
    ) -> ContactEnergy {
        if self.friction.coefficient > 0.0 {
            self.sum::<true, true>(bodies, loads)
        } else {
            self.sum::<false, true>(bodies, loads)
        }
    }

    fn add_moments(&mut self, bodies: &[BodyState], moments: &mut [f64]) -> bool {
        let found = &mut Found {
            moments,
            loads: &mut [],
            energy: None,
        };
        self.levers::<false>(bodies, found)
    }

    fn hold(
        &mut self,
        bodies: &[BodyState],
        moments: &mut [f64],
        loads: &mut [Wrench],
    ) -> Option<ContactEnergy> {
        self.levers.as_ref()?;
        for shaft in [Layout::INPUT, Layout::OUTPUT] {
            loads[shaft] = Wrench::default();
        }
        let mut found = Found {
            moments,
            loads,
            energy: Some(ContactEnergy::default()),
        };
        self.levers::<true>(bodies, &mut found);
        found.energy
    }

    fn add_held_loads(
        &mut self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        observed: bool,
    ) -> Option<ContactEnergy> {
        let mut found = Found {
            moments: &mut [],
            loads,
            energy: observed.then(ContactEnergy::default),
        };
        if self.levers::<true>(bodies, &mut found) {
            return found.energy;
        }
        self.add_asked_loads(bodies, loads, observed)
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        let law = self.law;
        self.list(bodies, &mut |wheel, sleeve, frame, pair| {
            visit(&pair.contact(&law, wheel, sleeve, frame));
        });
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        self.scalar.nearest(bodies, wheel, sleeve)
    }

    fn energy(&mut self, bodies: &[BodyState]) -> ContactEnergy {
        let mut sum = ContactEnergy::default();
        let law = self.law;
        self.list(bodies, &mut |_, _, _, pair| pair.add_energy(&law, &mut sum));
        sum
    }

    fn normal_force(&self, pair: &PairContact, rate: f64) -> f64 {
        self.law.force(pair.stiffness, pair.penetration_m, rate)
    }

    fn solve_friction(
        &mut self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        stage: &mut RateStage<'_>,
    ) -> Option<bool> {
        let sliding = self.sliding.as_mut()?;
        // Free are all bodies but the input.
        if stage.rates.len() + 1 != bodies.len() {
            return None;
        }
        sliding.clear();
        let sink = Split {
            law: self.law,
            sliding,
            loads,
        };
        let pairs = &mut self.pairs;
        self.arch.dispatch(SplitWalk(Walk {
            pairs,
            bodies,
            sink,
        }));
        let sliding = self.sliding.as_mut()?;
        Some(sliding.solve(self.arch, self.law, stage))
    }

    fn add_slopes(&mut self, bodies: &[BodyState], slopes: &mut Jacobian) -> bool {
        let layout = self.pairs.layout;
        let (rubs, free) = (self.friction.coefficient > 0.0, slopes.rate().dimension());
        match (rubs, free) {
            (true, n) if n == layout.bodies() - 1 => self.slopes::<true>(bodies, slopes),
            (false, n) if n == 1 + layout.wheels => self.slopes::<false>(bodies, slopes),
            _ => false,
        }
    }
}
