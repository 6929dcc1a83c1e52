//! What carries the discs of a gear: eccentrics that hold them, elastic bearings on the eccentrics, or the cranks of an RV gear.
//!
//! A gearbox resolves it once from its scene; everything that depends on it asks the carrier.

use pinwheel_mbs::{BodyState, ContactEnergy, Derivatives, Evaluation, Wrench};
use pinwheel_scene::bearings::BearingLaw;

use crate::contacts::bearing_load::BearingLoad;
use crate::contacts::cranks::CrankSet;
use crate::contacts::eccentric_bearings::EccentricBearings;
use crate::contacts::pair::PairContact;
use crate::geometry::Geometry;
use crate::scene::Scene;

/// Parts that carry the discs.
#[derive(Debug, Clone)]
pub enum Carrier {
    /// Eccentrics of the input hold the discs by revolutes.
    Rigid,
    /// Discs float on elastic bearings on the input's eccentrics.
    Floating(EccentricBearings),
    /// Discs float on elastic bearings on cranks in the output, which planets turn.
    Cranks(CrankSet),
}

impl Carrier {
    /// Carrier of a scene.
    #[must_use]
    pub fn of(scene: &Scene, geometry: &Geometry) -> Self {
        match (BearingLaw::of(scene), &scene.cranks) {
            (None, _) => Self::Rigid,
            (Some(law), None) => Self::Floating(EccentricBearings::of(law, scene, geometry)),
            (Some(law), Some(cranks)) => Self::Cranks(CrankSet::of(law, cranks, scene, geometry)),
        }
    }

    /// True where discs float on elastic bearings.
    #[must_use]
    pub fn floats(&self) -> bool {
        !matches!(self, Self::Rigid)
    }

    /// The cranks of an RV gear.
    #[must_use]
    pub fn cranks(&self) -> Option<&CrankSet> {
        match self {
            Self::Cranks(cranks) => Some(cranks),
            _ => None,
        }
    }

    /// Degrees of freedom that a disc has on it.
    #[must_use]
    pub fn freedoms_of_disc(&self) -> usize {
        if self.floats() { 3 } else { 1 }
    }

    /// Law of the bearings.
    #[must_use]
    pub fn law(&self) -> Option<&BearingLaw> {
        match self {
            Self::Rigid => None,
            Self::Floating(bearings) => Some(&bearings.law),
            Self::Cranks(cranks) => Some(&cranks.law),
        }
    }

    /// Offset of a bearing under a force, m.
    pub(crate) fn offset_under(&self, force: f64) -> f64 {
        self.law().map_or(0.0, |law| law.offset_under(force))
    }

    /// Stiffness of a bearing under a force, N/m.
    pub(crate) fn slope_under(&self, force: f64) -> f64 {
        self.law().map_or(0.0, |law| law.slope_under(force))
    }

    fn law_mut(&mut self) -> Option<&mut BearingLaw> {
        match self {
            Self::Rigid => None,
            Self::Floating(bearings) => Some(&mut bearings.law),
            Self::Cranks(cranks) => Some(&mut cranks.law),
        }
    }

    /// Bearings without friction.
    pub(crate) fn frictionless(mut self) -> Self {
        if let Some(law) = self.law_mut() {
            law.drag_m = 0.0;
        }
        self
    }

    /// Bearings and supports whose deflection under the same forces is `share` of theirs, with `of_clearance` times
    /// their clearance.
    pub(crate) fn share(&self, share: f64, of_clearance: f64) -> Self {
        let mut less = self.clone();
        match &mut less {
            Self::Rigid => {}
            Self::Floating(bearings) => bearings.law = bearings.law.share(share, of_clearance),
            Self::Cranks(cranks) => *cranks = cranks.share(share, of_clearance),
        }
        less
    }

    /// Adds loads, moments, derivatives and energy as far as they are requested.
    pub(crate) fn add(&self, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        if let Some(derivatives) = &mut request.derivatives {
            self.add_jacobian(bodies, derivatives);
        }
        if let Some(loads) = request.loads.as_deref_mut() {
            self.add_loads(bodies, loads, request.moments.as_deref_mut());
        }
        if let Some(energy) = &mut request.energy {
            self.add_energy(bodies, energy);
        }
    }

    /// Adds loads of all bearings, and of those on eccentrics the moments about the bodies' centres of mass to `moments`.
    #[inline]
    pub(crate) fn add_loads(
        &self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        moments: Option<&mut [f64]>,
    ) {
        match self {
            Self::Rigid => {}
            Self::Floating(bearings) => bearings.add_loads(bodies, loads, moments),
            Self::Cranks(cranks) => cranks.add_loads(bodies, loads),
        }
    }

    /// Adds derivatives of the bearings' loads with respect to everything free, and to time.
    pub(crate) fn add_jacobian(&self, bodies: &[BodyState], derivatives: &mut Derivatives<'_>) {
        match self {
            Self::Rigid => {}
            Self::Floating(bearings) => bearings.add_jacobian(bodies, derivatives),
            Self::Cranks(cranks) => cranks.add_jacobian(bodies, derivatives),
        }
    }

    /// Adds energy stored and powers dissipated.
    pub(crate) fn add_energy(&self, bodies: &[BodyState], sum: &mut ContactEnergy) {
        match self {
            Self::Rigid => {}
            Self::Floating(bearings) => bearings.add_energy(bodies, sum),
            Self::Cranks(cranks) => cranks.add_energy(bodies, sum),
        }
    }

    /// Load of the bearing that carries a disc, or of those of all cranks together, whose offset is their mean; `None`: a revolute
    /// carries it.
    #[must_use]
    pub fn load(&self, bodies: &[BodyState], wheel: usize) -> Option<BearingLoad> {
        match self {
            Self::Rigid => None,
            Self::Floating(bearings) => Some(bearings.load(bodies, wheel)),
            Self::Cranks(cranks) => Some(cranks.of_wheel(bodies, wheel)),
        }
    }

    /// Bearings of cranks that carry a force, as pairs.
    #[must_use]
    pub fn pairs(&self, bodies: &[BodyState]) -> Vec<PairContact> {
        self.cranks()
            .map_or_else(Vec::new, |cranks| cranks.pairs(bodies))
    }
}
