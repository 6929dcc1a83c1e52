//! Support of the discs of a gear: rigid eccentrics, elastic bearings on the eccentrics, or the cranks of an RV gear.
//!
//! A gearbox selects its carrier once from its scene; all code that depends on the carrier calls its methods.

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
    /// Revolutes on eccentrics of the input carry the discs.
    Rigid,
    /// Discs float on elastic bearings on the input's eccentrics.
    Floating(EccentricBearings),
    /// Discs float on elastic bearings on cranks in the output, which planets turn.
    Cranks(CrankSet),
}

impl Carrier {
    /// Returns the carrier of a scene.
    pub fn of(scene: &Scene, geometry: &Geometry) -> Self {
        match (BearingLaw::of(scene), &scene.cranks) {
            (None, _) => Self::Rigid,
            (Some(law), None) => Self::Floating(EccentricBearings::of(law, scene, geometry)),
            (Some(law), Some(cranks)) => Self::Cranks(CrankSet::of(law, cranks, scene, geometry)),
        }
    }

    /// True if discs float on elastic bearings.
    pub fn floats(&self) -> bool {
        !matches!(self, Self::Rigid)
    }

    /// Returns the cranks of an RV gear; `None` for other gears.
    pub fn cranks(&self) -> Option<&CrankSet> {
        match self {
            Self::Cranks(cranks) => Some(cranks),
            _ => None,
        }
    }

    /// Returns the degrees of freedom of a disc on this carrier.
    pub fn freedoms_of_disc(&self) -> usize {
        if self.floats() { 3 } else { 1 }
    }

    /// Returns the law of the bearings.
    pub fn law(&self) -> Option<&BearingLaw> {
        match self {
            Self::Rigid => None,
            Self::Floating(bearings) => Some(&bearings.law),
            Self::Cranks(cranks) => Some(&cranks.law),
        }
    }

    /// Returns the offset of a bearing under a force (N), m.
    pub(crate) fn offset_under(&self, force: f64) -> f64 {
        self.law().map_or(0.0, |law| law.offset_under(force))
    }

    /// Returns the stiffness of a bearing under a force (N), N/m.
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

    /// Returns the carrier with bearings without friction.
    pub(crate) fn frictionless(mut self) -> Self {
        if let Some(law) = self.law_mut() {
            law.drag_m = 0.0;
        }
        self
    }

    /// Returns the carrier with bearings without damping.
    pub(crate) fn undamped(mut self) -> Self {
        if let Some(law) = self.law_mut() {
            law.damping_n_s_m = 0.0;
        }
        self
    }

    /// Returns the carrier with the deflections of bearings and supports under equal forces multiplied by `share`, and their
    /// clearance by `of_clearance`.
    pub(crate) fn share(&self, share: f64, of_clearance: f64) -> Self {
        let mut less = self.clone();
        match &mut less {
            Self::Rigid => {}
            Self::Floating(bearings) => bearings.law = bearings.law.share(share, of_clearance),
            Self::Cranks(cranks) => *cranks = cranks.share(share, of_clearance),
        }
        less
    }

    /// Adds the requested loads, moments, derivatives and energy.
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

    /// Adds the loads of all bearings. The moments of bearings on eccentrics about the bodies' centres of mass are added to
    /// `moments`.
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

    /// Adds derivatives of the bearings' loads with respect to all free coordinates and to time.
    pub(crate) fn add_jacobian(&self, bodies: &[BodyState], derivatives: &mut Derivatives<'_>) {
        match self {
            Self::Rigid => {}
            Self::Floating(bearings) => bearings.add_jacobian(bodies, derivatives),
            Self::Cranks(cranks) => cranks.add_jacobian(bodies, derivatives),
        }
    }

    /// Adds the stored energy and the dissipated powers.
    pub(crate) fn add_energy(&self, bodies: &[BodyState], sum: &mut ContactEnergy) {
        match self {
            Self::Rigid => {}
            Self::Floating(bearings) => bearings.add_energy(bodies, sum),
            Self::Cranks(cranks) => cranks.add_energy(bodies, sum),
        }
    }

    /// Returns the load of a disc's bearing. On cranks it is the total load of the disc's bearings, with their mean offset.
    /// `None` if a revolute carries the disc.
    pub fn load(&self, bodies: &[BodyState], wheel: usize) -> Option<BearingLoad> {
        match self {
            Self::Rigid => None,
            Self::Floating(bearings) => Some(bearings.load(bodies, wheel)),
            Self::Cranks(cranks) => Some(cranks.of_wheel(bodies, wheel)),
        }
    }

    /// Returns the bearings of cranks that carry a force, as pairs.
    pub fn pairs(&self, bodies: &[BodyState]) -> Vec<PairContact> {
        self.cranks()
            .map_or_else(Vec::new, |cranks| cranks.pairs(bodies))
    }
}
