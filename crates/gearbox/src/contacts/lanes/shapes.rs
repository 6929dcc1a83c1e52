//! Where sleeves touch, several at a time, in the wheel's frame.

use pinwheel_contact::{ComplexLanes, Epitrochoid, FeetLanes, Lanes, Mask};
use pinwheel_scene::scales::hertz;
use pulp::Simd;

use super::columns::Column;
use crate::geometry::Geometry;
use crate::scene::Scene;

/// Touching lanes of a group in the wheel's frame.
pub(super) struct Touching<S: Simd> {
    pub(super) mask: Mask<S>,
    pub(super) point: ComplexLanes<S>,
    pub(super) normal: ComplexLanes<S>,
    pub(super) penetration: Lanes<S>,
    pub(super) stiffness: Lanes<S>,
    /// By how much n turns towards t = R90 n as the sleeve's centre moves along t, 1/m.
    pub(super) turning: Lanes<S>,
    /// Growth of K as the sleeve's centre moves along t, N/m^2.5.
    pub(super) stiffness_slope: Lanes<S>,
}

/// Geometry of the contacts.
#[derive(Debug, Clone)]
pub(super) struct Shapes {
    curve: Epitrochoid,
    eccentricity: f64,
    pub(super) zk: u32,
    external_radius: f64,
    /// K where C is straight: K = this * sqrt(1 - q kappa).
    profile_stiffness: f64,
    hole_stiffness: f64,
    hole_radius: f64,
    clearance: f64,
    pub(super) directions: Column,
    /// Hole centres in the wheel's frame, by wheel.
    pub(super) holes: Vec<Column>,
}

impl Shapes {
    pub(super) fn new(scene: &Scene, geometry: &Geometry) -> Self {
        let (gear, contact) = (&scene.gear, &scene.contact);
        let hertz = hertz(contact);
        let q = gear.external_sleeve_radius_m;
        let holes = geometry.hole_centres.iter();
        Self {
            curve: geometry.curve.clone(),
            eccentricity: gear.eccentricity_m,
            zk: gear.external_sleeves as u32,
            external_radius: q,
            profile_stiffness: hertz.of_radius(q),
            hole_stiffness: hertz.of_hole(gear.internal_sleeve_radius_m, gear.hole_radius_m),
            hole_radius: gear.hole_radius_m,
            clearance: gear.hole_radius_m - gear.internal_sleeve_radius_m,
            directions: Column::padded(geometry.external_directions.iter().copied()),
            holes: holes.map(|w| Column::padded(w.iter().copied())).collect(),
        }
    }

    /// External sleeves centred at `p` (wheel frame) against the profile.
    #[inline(always)]
    pub(super) fn profile<S: Simd>(
        &self,
        p: ComplexLanes<S>,
        unit: ComplexLanes<S>,
        multiple: ComplexLanes<S>,
        present: Mask<S>,
    ) -> Touching<S> {
        let feet = self.curve.penetrating_feet(p, unit, multiple, present);
        let q = p.re.like(self.external_radius);
        let radicand = p.re.like(1.0) - q * feet.curvature;
        let stiffness = p.re.like(self.profile_stiffness) * radicand.sqrt();
        // P moves along t by 1 - delta kappa times what the foot moves, and t points towards smaller parameters.
        let closer = (p.re.like(1.0) - feet.curvature * feet.depth).recip();
        let bend = self.curvature_slope(&feet);
        Touching {
            mask: feet.inside,
            point: feet.normal.scale_add(-q, feet.position),
            normal: feet.normal.scale(p.re.like(-1.0)),
            penetration: feet.depth,
            stiffness,
            turning: -(feet.curvature * closer),
            stiffness_slope: stiffness * q * bend * closer * (radicand + radicand).recip(),
        }
    }

    /// d kappa/ds along the curve, 1/m^2; see [`Epitrochoid::curvature_slope`].
    ///
    /// cos(zs a) and sin(zs a) follow from where the foot is and where its normal points.
    #[inline(always)]
    fn curvature_slope<S: Simd>(&self, feet: &FeetLanes<S>) -> Lanes<S> {
        let c = |x: f64| feet.depth.like(x);
        let (r, e, zk) = (
            self.curve.pitch_radius(),
            self.eccentricity,
            f64::from(self.zk),
        );
        let m = e * zk / r;
        let squared = feet.position.dot(feet.position);
        let cos = (squared - c(r * r + e * e)) * c(0.5 / (r * e));
        let stretch2 = cos.mul_add(c(2.0 * m), c(1.0 + m * m));
        let stretch = stretch2.sqrt();
        let sin = feet.position.cross(feet.normal) * stretch * c(1.0 / (e * (zk - 1.0)));
        let bend = cos.mul_add(c(m * (1.0 + zk)), c(1.0 + m * m * zk));
        let by_cos = stretch2 * c(m * (1.0 + zk)) - bend * c(3.0 * m);
        // Over R stretch^5 for the slope by cos(zs a), and R stretch for the speed.
        let inverse = (stretch2 * stretch2 * stretch2 * c(r * r)).recip();
        -(by_cos * c(zk - 1.0) * sin * inverse)
    }

    /// Internal sleeves centred at `p` (wheel frame) in their holes.
    #[inline(always)]
    pub(super) fn hole<S: Simd>(
        &self,
        p: ComplexLanes<S>,
        centres: ComplexLanes<S>,
        present: Mask<S>,
    ) -> Touching<S> {
        let offset = p - centres;
        let distance = offset.dot(offset).sqrt();
        let penetration = distance - p.re.like(self.clearance);
        let normal = offset.scale(distance.recip());
        Touching {
            mask: p.re.like(0.0).less(penetration).and(present),
            point: normal.scale_add(p.re.like(self.hole_radius), centres),
            normal,
            penetration,
            stiffness: p.re.like(self.hole_stiffness),
            turning: distance.recip(),
            stiffness_slope: p.re.like(0.0),
        }
    }
}
