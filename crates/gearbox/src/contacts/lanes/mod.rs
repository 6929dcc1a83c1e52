//! All pairs of discs and pins, several at a time: the fast form of [`pairs`](super::pairs).
//!
//! Exact detection only. Pin states stand in structure-of-arrays columns, padded to whole groups
//! of lanes whose surplus is masked. Formulas, signs and frames are those of the scalar loop, which
//! stays as the oracle (tests: equal to 1e-13 relative). The vector instructions are chosen when the
//! program runs, by what the processor has.

mod active_pairs;
mod columns;
mod derivatives;
mod joint_space;
mod loads;
mod pair_loop;
mod shapes;

use pinwheel_contact::{PinLaw, RegularisedCoulomb};
use pinwheel_faults::{Fault, factor};
use pinwheel_mbs::{BodyState, ContactEnergy, Evaluation, Pose};
use pulp::Simd;

use super::detection::Exact;
use super::pair::{PairContact, PairField};
use super::pairs::Pairs;
use super::pin_friction::PinFriction;
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::{Layout, Sleeve};
use active_pairs::ActivePairs;
use columns::Sleeves;
use derivatives::Derivatives;
use joint_space::JointSpace;
use loads::Loads;
use pair_loop::{LanePairs, Sink, pair_loop};
use shapes::Shapes;

/// The contact field with exact detection, in lanes.
pub(super) struct LaneField {
    arch: pulp::Arch,
    law: PinLaw,
    friction: RegularisedCoulomb,
    pins: Option<PinFriction>,
    pairs: LanePairs,
    /// Without friction.
    joint_space: Option<JointSpace>,
    /// True if no joint holds the discs.
    floats: bool,
    /// For single pairs, where lanes gain nothing.
    scalar: Pairs<Exact>,
}

/// One walk, as the dispatcher wants it: what is inlined here is compiled once per instruction set.
struct PairLoop<'a, K> {
    pairs: &'a mut LanePairs,
    bodies: &'a [BodyState],
    sink: K,
}

impl<K: Sink> pulp::WithSimd for PairLoop<'_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        pair_loop(simd, self.pairs, self.bodies, self.sink);
    }
}

/// Angles and rates to moments, and with `LOADS` to loads.
struct JointSpaceLoop<'a, 'b, const LOADS: bool, const FLOATS: bool> {
    joint_space: &'a mut JointSpace,
    shapes: &'a Shapes,
    law: PinLaw,
    bodies: &'a [BodyState],
    sums: &'a mut Evaluation<'b>,
}

impl<const LOADS: bool, const FLOATS: bool> pulp::WithSimd
    for JointSpaceLoop<'_, '_, LOADS, FLOATS>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.joint_space.run::<S, LOADS, FLOATS>(
            simd,
            &self.law,
            self.shapes,
            self.bodies,
            self.sums,
        );
    }
}

impl LaneField {
    pub(super) fn new(scene: &Scene, geometry: &Geometry, law: PinLaw, arch: pulp::Arch) -> Self {
        let contact = &scene.contact;
        let layout = Layout::of(&scene.gear);
        let coefficient = contact.friction_coefficient;
        Self {
            arch,
            law,
            friction: RegularisedCoulomb {
                coefficient,
                ramp: contact.friction_ramp_m_s * factor(Fault::FrictionSign, -1.0),
            },
            pins: PinFriction::of(scene),
            floats: scene.bearings.eccentric.is_some(),
            joint_space: (coefficient == 0.0).then(|| JointSpace::new(scene, geometry)),
            pairs: LanePairs {
                layout,
                shapes: Shapes::new(scene, geometry),
                external: Sleeves::new(layout.external_bodies()),
                internal: Sleeves::new(layout.internal_bodies()),
            },
            scalar: Pairs::new(scene, geometry, law, Exact::new(scene, geometry, &law.law)),
        }
    }

    fn pair_loop(&mut self, bodies: &[BodyState], sink: impl Sink) {
        let pairs = &mut self.pairs;
        self.arch.dispatch(PairLoop {
            pairs,
            bodies,
            sink,
        });
    }

    fn sum(&mut self, bodies: &[BodyState], sums: &mut Evaluation<'_>) {
        let Some(loads) = sums.loads.as_deref_mut() else {
            return;
        };
        let mut energy = sums.wants_energy.then(ContactEnergy::default);
        let sink = Loads {
            law: self.law,
            friction: self.friction,
            pins: self.pins,
            output_rate: bodies[Layout::OUTPUT].rate,
            loads,
            energy: energy.as_mut(),
        };
        self.pair_loop(bodies, sink);
        sums.energy = energy;
    }

    /// Moments, and loads if they are asked for, of bodies whose joints hold them. Nothing rubs.
    fn sum_in_joint_space<const LOADS: bool, const FLOATS: bool>(
        &mut self,
        bodies: &[BodyState],
        sums: &mut Evaluation<'_>,
    ) {
        if let Some(joint_space) = &mut self.joint_space {
            self.arch.dispatch(JointSpaceLoop::<LOADS, FLOATS> {
                joint_space,
                shapes: &self.pairs.shapes,
                law: self.law,
                bodies,
                sums,
            });
        }
    }

    /// False, and nothing was added, for free bodies that are not those of a gear with or without friction.
    fn add_jacobian(&mut self, bodies: &[BodyState], sums: &mut Evaluation<'_>) -> bool {
        let Some(derivatives) = sums.derivatives.as_deref_mut() else {
            return true;
        };
        let (layout, law, friction) = (self.pairs.layout, self.law, self.friction);
        let has_friction = friction.coefficient > 0.0;
        let free = if has_friction {
            layout.bodies() - 1
        } else {
            1 + layout.wheels
        };
        let all = derivatives.rate.dimension();
        let places = 2 * layout.wheels;
        if all != free && all != free + places || derivatives.position.is_none() {
            return false;
        }
        if let Some(sink) = Derivatives::new(law, friction, layout, bodies, derivatives) {
            self.pair_loop(bodies, sink);
        }
        true
    }
}

impl PairField for LaneField {
    fn evaluate(&mut self, bodies: &[BodyState], pose: Pose, sums: &mut Evaluation<'_>) -> bool {
        if self.joint_space.is_some() && pose != Pose::Any && sums.derivatives.is_none() {
            match (sums.loads.is_some(), self.floats) {
                (true, false) => self.sum_in_joint_space::<true, false>(bodies, sums),
                (false, false) => self.sum_in_joint_space::<false, false>(bodies, sums),
                (true, true) => self.sum_in_joint_space::<true, true>(bodies, sums),
                // Forces move such discs, and moments are not all.
                (false, true) => return false,
            }
            return true;
        }
        let is_told = sums.moments.is_none() && pose != Pose::AnglesOnly;
        if !is_told || !self.add_jacobian(bodies, sums) {
            return false;
        }
        self.sum(bodies, sums);
        true
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        let sink = ActivePairs {
            law: self.law,
            friction: self.friction,
            visit,
        };
        self.pair_loop(bodies, sink);
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        self.scalar.nearest(bodies, wheel, sleeve)
    }
}
