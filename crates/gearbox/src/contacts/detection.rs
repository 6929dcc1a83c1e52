//! How the contact point is found: the exact curve, or discrete points as published.

use pinwheel_contact::{
    Complex, Epitrochoid, Foot, HertzStiffness, Hole, HolePoints, NormalLaw, ProfilePoints,
};

use pinwheel_scene::scales::hertz;

use crate::GearboxError;
use crate::geometry::Geometry;
use crate::scene::{self, Scene};

/// A touching pair in the wheel's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    /// W, m from the wheel's centre.
    pub(super) point: Complex,
    /// n, from the sleeve centre to W.
    pub(super) normal: Complex,
    /// delta, m; above 0 but for [`Detection::profile_gap`] and [`Detection::hole_gap`].
    pub(super) penetration: f64,
    /// K, N/m^1.5.
    pub(super) stiffness: f64,
    /// Growth of K as P moves along t = R90 n, N/m^2.5; 0 where K is constant or only known at points.
    pub(super) stiffness_slope: f64,
}

/// Finds the contact of one sleeve centre `p` (wheel frame) with the wheel.
pub(super) trait Detection: Send + 'static {
    /// External sleeve: `unit` = e^{i a0} and `multiple` = e^{i zk a0} start the search.
    fn profile(&self, p: Complex, unit: Complex, multiple: Complex) -> Option<Touch>;
    /// Internal sleeve in hole `k` of `wheel`.
    fn hole(&self, wheel: usize, k: usize, p: Complex) -> Option<Touch>;
    /// Closest points of an external sleeve that [`profile`](Self::profile) finds without contact.
    fn profile_gap(&self, p: Complex) -> Touch;
    /// Closest points of an internal sleeve that [`hole`](Self::hole) finds without contact.
    fn hole_gap(&self, wheel: usize, k: usize, p: Complex) -> Touch;
}

/// What both detections share.
#[derive(Debug, Clone)]
struct Shapes {
    curve: Epitrochoid,
    external_radius: f64,
    internal_radius: f64,
    holes: Vec<Vec<Hole>>,
    hole_stiffness: f64,
    hertz: HertzStiffness,
}

impl Shapes {
    fn new(scene: &Scene, geometry: &Geometry) -> Self {
        let (gear, contact) = (&scene.gear, &scene.contact);
        let hertz = hertz(contact);
        let radius = gear.hole_radius_m;
        Self {
            curve: geometry.curve.clone(),
            external_radius: gear.external_sleeve_radius_m,
            internal_radius: gear.internal_sleeve_radius_m,
            holes: geometry
                .hole_centres
                .iter()
                .map(|wheel| {
                    wheel
                        .iter()
                        .map(|&centre| Hole { centre, radius })
                        .collect()
                })
                .collect(),
            hole_stiffness: hertz.of_hole(gear.internal_sleeve_radius_m, radius),
            hertz,
        }
    }
}

impl Shapes {
    /// dK/da of K = k sqrt(q (1 - q kappa)) over the way |C'| (1 - delta kappa) that P moves with da, along
    /// t = R90 n; n is minus the curve's normal, so t points towards smaller a.
    fn stiffness_slope(&self, foot: &Foot, stiffness: f64) -> f64 {
        let (q, at) = (self.external_radius, &foot.at);
        let bend = self
            .curve
            .curvature_slope(foot.unit, foot.unit.powu(self.curve.lobes() + 1));
        let per_parameter = -0.5 * stiffness * q * bend / (1.0 - q * at.curvature);
        -per_parameter / (at.speed * (1.0 + foot.distance * at.curvature))
    }
}

/// Closest point of the exact curve: delta is minus the signed distance of P from C.
/// The second field: whether the slope of K is wanted.
pub(super) struct Exact(Shapes, bool);

impl Exact {
    /// The slope of K is only found for laws with a force along the profile.
    pub(super) fn new(scene: &Scene, geometry: &Geometry, law: &impl NormalLaw) -> Self {
        Self(Shapes::new(scene, geometry), law.along(0.0).is_some())
    }
}

impl Exact {
    #[inline]
    fn at(&self, foot: &Foot) -> Touch {
        let q = self.0.external_radius;
        let stiffness = self.0.hertz.of_profile(q, foot.at.curvature);
        let stiffness_slope = if self.1 {
            self.0.stiffness_slope(foot, stiffness)
        } else {
            0.0
        };
        Touch {
            point: foot.at.position - foot.at.normal.scale(q),
            normal: -foot.at.normal,
            penetration: -foot.distance,
            stiffness,
            stiffness_slope,
        }
    }
}

/// Direction of an offset from a hole's centre; the wheel's x axis in the centre itself.
fn outwards(offset: Complex) -> Complex {
    let distance = offset.norm();
    if distance > 0.0 {
        offset.scale(1.0 / distance)
    } else {
        Complex::ONE
    }
}

impl Detection for Exact {
    #[inline]
    fn profile(&self, p: Complex, unit: Complex, multiple: Complex) -> Option<Touch> {
        let foot = self.0.curve.penetrating_foot(p, unit, multiple)?;
        Some(self.at(&foot))
    }

    fn profile_gap(&self, p: Complex) -> Touch {
        self.at(&self.0.curve.closest(p))
    }

    fn hole_gap(&self, wheel: usize, k: usize, p: Complex) -> Touch {
        let hole = &self.0.holes[wheel][k];
        let normal = outwards(p - hole.centre);
        Touch {
            point: hole.centre + normal.scale(hole.radius),
            normal,
            penetration: (p - hole.centre).norm() + self.0.internal_radius - hole.radius,
            stiffness: self.0.hole_stiffness,
            stiffness_slope: 0.0,
        }
    }

    #[inline]
    fn hole(&self, wheel: usize, k: usize, p: Complex) -> Option<Touch> {
        let hole = &self.0.holes[wheel][k];
        let (penetration, normal) = hole.penetration(p, self.0.internal_radius)?;
        Some(Touch {
            point: hole.centre + normal.scale(hole.radius),
            normal,
            penetration,
            stiffness: self.0.hole_stiffness,
            stiffness_slope: 0.0,
        })
    }
}

/// The paper's points: W is the vertex nearest to P, delta = sleeve radius - |W - P|.
///
/// Vertices lie on the exact curves and are never closer to P than these, so the exact test
/// decides first whether any can touch, and its foot tells which.
pub(super) struct Points {
    shapes: Shapes,
    profile: ProfilePoints,
    hole: HolePoints,
}

impl Points {
    pub(super) fn new(scene: &Scene, geometry: &Geometry) -> Result<Self, GearboxError> {
        let shapes = Shapes::new(scene, geometry);
        let scene::Contact {
            wheel_points,
            hole_points,
            ..
        } = scene.contact;
        let profile = ProfilePoints::new(
            &shapes.curve,
            shapes.external_radius,
            wheel_points,
            &shapes.hertz,
        )
        .ok_or(GearboxError::TooFewPoints { wheel_points })?;
        Ok(Self {
            shapes,
            profile,
            hole: HolePoints::new(hole_points),
        })
    }

    #[inline]
    fn touch(p: Complex, point: Complex, radius: f64, stiffness: f64) -> Option<Touch> {
        let arm = point - p;
        let distance = arm.norm();
        let penetration = radius - distance;
        (penetration > 0.0 && distance > 0.0).then(|| Touch {
            point,
            normal: arm.scale(1.0 / distance),
            penetration,
            stiffness,
            stiffness_slope: 0.0,
        })
    }

    fn gap(p: Complex, point: Complex, radius: f64, stiffness: f64) -> Touch {
        Touch {
            point,
            normal: outwards(point - p),
            penetration: radius - (point - p).norm(),
            stiffness,
            stiffness_slope: 0.0,
        }
    }
}

impl Detection for Points {
    #[inline]
    fn profile(&self, p: Complex, unit: Complex, multiple: Complex) -> Option<Touch> {
        let foot = self.shapes.curve.penetrating_foot(p, unit, multiple)?;
        let (vertex, _) = self.profile.nearest(p, foot.parameter());
        Self::touch(
            p,
            vertex.position,
            self.shapes.external_radius,
            vertex.stiffness,
        )
    }

    #[inline]
    fn hole(&self, wheel: usize, k: usize, p: Complex) -> Option<Touch> {
        let hole = &self.shapes.holes[wheel][k];
        hole.penetration(p, self.shapes.internal_radius)?;
        // A hole's points start along the wheel's x axis.
        let direction = self.hole.nearest(p - hole.centre);
        let point = hole.centre + direction.scale(hole.radius);
        Self::touch(
            p,
            point,
            self.shapes.internal_radius,
            self.shapes.hole_stiffness,
        )
    }

    fn profile_gap(&self, p: Complex) -> Touch {
        let foot = self.shapes.curve.closest(p);
        let (vertex, _) = self.profile.nearest(p, foot.parameter());
        let radius = self.shapes.external_radius;
        Self::gap(p, vertex.position, radius, vertex.stiffness)
    }

    fn hole_gap(&self, wheel: usize, k: usize, p: Complex) -> Touch {
        let hole = &self.shapes.holes[wheel][k];
        let direction = self.hole.nearest(p - hole.centre);
        let point = hole.centre + direction.scale(hole.radius);
        let (radius, stiffness) = (self.shapes.internal_radius, self.shapes.hole_stiffness);
        Self::gap(p, point, radius, stiffness)
    }
}
