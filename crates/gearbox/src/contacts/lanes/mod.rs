//! Contact loop over pairs of discs and pins, several at a time: the fast counterpart of [`pairs`](super::pairs).
//!
//! Exact detection only. Pin states are in structure-of-arrays columns, padded to full groups of lanes whose surplus is masked.
//! Formulas, signs and frames are those of the scalar loop, the reference (tests: equal to 1e-13 relative). The vector
//! instructions are selected at run time from those of the processor.

mod active_pairs;
mod columns;
mod derivatives;
mod joint_space;
mod loads;
mod pair_loop;
mod shapes;

use pinwheel_contact::{PinLaw, RegularisedCoulomb};
use pinwheel_faults::{Fault, factor};
use pinwheel_mbs::{BodyState, Evaluation, Pose};
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

/// Contact field with exact detection, in lanes.
pub(super) struct LaneField {
    arch: pulp::Arch,
    law: PinLaw,
    /// Friction of the contacts, and of sleeves, of ring and of output pins.
    friction: [RegularisedCoulomb; 2],
    pins: [Option<PinFriction>; 2],
    pairs: LanePairs,
    /// Contacts from joint angles, without friction.
    joint_space: Option<JointSpace>,
    /// Scalar loop for single pairs, where lanes gain nothing.
    scalar: Pairs<Exact>,
}

/// Loop over all pairs in the form required by the dispatcher: functions inlined here are compiled once per instruction set.
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

/// Computes moments, and with `LOADS` loads, from angles and rates.
struct JointSpaceLoop<'a, 'b, const LOADS: bool> {
    joint_space: &'a mut JointSpace,
    shapes: &'a Shapes,
    law: PinLaw,
    bodies: &'a [BodyState],
    request: &'a mut Evaluation<'b>,
}

impl<const LOADS: bool> pulp::WithSimd for JointSpaceLoop<'_, '_, LOADS> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.joint_space
            .run::<S, LOADS>(simd, &self.law, self.shapes, self.bodies, self.request);
    }
}

impl LaneField {
    pub(super) fn new(scene: &Scene, geometry: &Geometry, law: PinLaw, arch: pulp::Arch) -> Self {
        let contact = &scene.contact;
        let layout = Layout::of(&scene.gear);
        Self {
            arch,
            law,
            friction: scene.sliding().map(|coefficient| RegularisedCoulomb {
                coefficient,
                ramp: contact.friction_ramp_m_s * factor(Fault::FrictionSign, -1.0),
            }),
            pins: PinFriction::of(scene),
            // Cranks move like free bodies, without levers.
            joint_space: (!scene.slides() && scene.cranks.is_none())
                .then(|| JointSpace::new(scene, geometry)),
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

    fn add_loads(&mut self, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        let Some(loads) = request.loads.as_deref_mut() else {
            return;
        };
        let sink = Loads {
            law: self.law,
            friction: &self.friction,
            pins: &self.pins,
            output_rate: bodies[Layout::OUTPUT].rate,
            loads,
            energy: request.energy.as_mut(),
        };
        let pairs = &mut self.pairs;
        self.arch.dispatch(PairLoop {
            pairs,
            bodies,
            sink,
        });
    }

    /// Computes moments, and loads if requested, of bodies with the poses that their joints prescribe, without friction.
    fn sum_in_joint_space<const LOADS: bool>(
        &mut self,
        bodies: &[BodyState],
        request: &mut Evaluation<'_>,
    ) {
        if let Some(joint_space) = &mut self.joint_space {
            self.arch.dispatch(JointSpaceLoop::<LOADS> {
                joint_space,
                shapes: &self.pairs.shapes,
                law: self.law,
                bodies,
                request,
            });
        }
    }
}

impl PairField for LaneField {
    fn work_from_angles(&self) -> bool {
        self.joint_space.is_some()
    }

    fn have_derivatives(&self) -> bool {
        true
    }

    fn evaluate(&mut self, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        if let Some(joint_space) = &self.joint_space
            && request.pose == Pose::Prescribed
            && request.derivatives.is_none()
        {
            match request.loads.is_some() || joint_space.floats {
                true => self.sum_in_joint_space::<true>(bodies, request),
                false => self.sum_in_joint_space::<false>(bodies, request),
            }
            return;
        }
        if let Some(derivatives) = &mut request.derivatives {
            let (law, friction, layout) = (self.law, self.friction, self.pairs.layout);
            let sink = Derivatives::new(law, friction, layout, bodies, derivatives);
            self.pair_loop(bodies, sink);
        }
        self.add_loads(bodies, request);
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
