//! Contact detection: on the exact curve, or on discrete points as published.

use pinwheel_contact::{
    Complex, Dual, Epitrochoid, Foot, HertzStiffness, Hole, HolePoints, Law, NormalLaw,
    ProfilePoints, Scalar,
};

use pinwheel_scene::scales::hertz;

use crate::GearboxError;
use crate::geometry::Geometry;
use crate::scene::{self, Scene};

/// Contact point of a pair in the disc's frame.
#[derive(Debug, Clone, Copy)]
pub struct Touch<S = f64> {
    /// Contact point W, m from the disc's centre.
    pub point: Complex<S>,
    /// Unit vector n from the pin centre to W.
    pub normal: Complex<S>,
    /// Penetration delta, m; above 0 except for `Detection::profile_gap` and `Detection::hole_gap`.
    pub penetration: S,
    /// Stiffness K, N/m^1.5.
    pub stiffness: S,
    /// Growth of K as P moves along t = R90 n, N/m^2.5; 0 where K is constant or only defined at points.
    pub stiffness_slope: S,
}

impl<S: Scalar> Touch<S> {
    /// Returns the touch of a pin of radius `radius` centred at `p` with a vertex `point`, where K is `stiffness`.
    pub fn at_point(p: Complex<S>, point: Complex, radius: f64, stiffness: f64) -> Self {
        let c = |x: f64| p.re.like(x);
        let arm = point.like(p.re) - p;
        Self {
            point: point.like(p.re),
            normal: outwards(arm),
            penetration: c(radius) - arm.norm(),
            stiffness: c(stiffness),
            stiffness_slope: c(0.0),
        }
    }

    /// Returns the touch on a disc rotated by e^{i angle} = `by`.
    pub(super) fn turned(self, by: Complex) -> Self {
        let by = by.like(self.penetration);
        Self {
            point: self.point * by,
            normal: self.normal * by,
            ..self
        }
    }
}

impl Touch {
    /// True if a pin of radius `radius` penetrates by more than 0 and less than its radius.
    fn presses(&self, radius: f64) -> bool {
        self.penetration > 0.0 && self.penetration < radius
    }
}

/// Detection of the contact of one pin centre `p` (disc frame) with the disc.
pub(super) trait Detection: Send + 'static {
    /// Returns the exact detection for derivatives of touches; `None` for nearest points, which jump.
    fn exact(&self) -> Option<&Exact> {
        None
    }
    /// Returns the touch of ring pin `j` and e^{ia} of its foot; e^{i a0} and e^{i zk a0} start the search.
    fn profile(&self, j: usize, p: Complex, start: [Complex; 2]) -> Option<(Touch, Complex)>;
    /// Returns the touch of the output pin in hole `k` of `wheel`.
    fn hole(&self, wheel: usize, k: usize, p: Complex) -> Option<Touch>;
    /// Returns the closest points of a ring pin that [`profile`](Self::profile) reports without contact.
    fn profile_gap(&self, j: usize, p: Complex) -> Touch;
    /// Returns the closest points of an output pin that [`hole`](Self::hole) reports without contact.
    fn hole_gap(&self, wheel: usize, k: usize, p: Complex) -> Touch;
    /// Returns the radius of ring pin `j`, and its K where the curvature of the curve is `kappa`.
    fn sleeve(&self, j: usize, kappa: f64) -> (f64, f64);
}

/// Ring pin.
#[derive(Debug, Clone, Copy)]
struct External {
    radius: f64,
    /// Excess of the radius over the generating pin's, m: the pin touches if its centre is less than that outside C.
    larger: f64,
}

/// Hole and its pin.
#[derive(Debug, Clone)]
struct Internal {
    hole: Hole,
    sleeve: f64,
    stiffness: f64,
}

impl Internal {
    /// Returns the touch of the pin at the hole's exact edge, pressed in along `normal`.
    #[inline]
    fn touch<S: Scalar>(&self, penetration: S, normal: Complex<S>) -> Touch<S> {
        let c = |x: f64| penetration.like(x);
        Touch {
            point: self.hole.centre.like(penetration) + normal.scale(c(self.hole.radius)),
            normal,
            penetration,
            stiffness: c(self.stiffness),
            stiffness_slope: c(0.0),
        }
    }
}

/// Data common to both detections.
#[derive(Debug, Clone)]
struct Shapes {
    curve: Epitrochoid,
    /// Distance q' of the edge inside the curve, m.
    offset: f64,
    external: Vec<External>,
    internal: Vec<Vec<Internal>>,
    hertz: HertzStiffness,
}

impl Shapes {
    fn new(scene: &Scene, geometry: &Geometry) -> Self {
        let hertz = hertz(scene);
        let offset = geometry.edge_offset_m;
        let external = |&radius: &f64| External {
            radius,
            larger: radius - offset,
        };
        let wheel = |(centres, radii): (&Vec<Complex>, &Vec<f64>)| {
            let holes = centres.iter().zip(radii).zip(&geometry.internal_radii_m);
            holes
                .map(|((&centre, &radius), &sleeve)| Internal {
                    hole: Hole { centre, radius },
                    sleeve,
                    stiffness: hertz.of_hole(sleeve, radius),
                })
                .collect()
        };
        let wheels = geometry.hole_centres.iter().zip(&geometry.hole_radii_m);
        Self {
            curve: geometry.curve.clone(),
            offset,
            external: geometry.external_radii_m.iter().map(external).collect(),
            internal: wheels.map(wheel).collect(),
            hertz,
        }
    }

    fn sleeve<S: Scalar>(&self, j: usize, kappa: S) -> (f64, S) {
        let radius = self.external[j].radius;
        (radius, self.hertz.of_edge(radius, self.offset, kappa))
    }

    /// Returns the foot of ring pin `j` if it is in contact.
    #[inline]
    fn foot(&self, j: usize, p: Complex, start: [Complex; 2]) -> Option<Foot> {
        self.curve.foot_within(p, start, self.external[j].larger)
    }

    /// Returns dK/da of K = k sqrt(r (1 - q' kappa)/(1 + (r - q') kappa)) over the distance |C'| (1 + s kappa) that P, s
    /// outside of C, moves with da, along t = R90 n; n is minus the curve's normal, so t points towards smaller a.
    fn stiffness_slope<S: Scalar>(&self, j: usize, foot: &Foot<S>, stiffness: S) -> S {
        let c = |x: f64| stiffness.like(x);
        if !self.hertz.is_curved() {
            return c(0.0);
        }
        let (External { radius, larger }, at) = (self.external[j], &foot.at);
        let bend = self
            .curve
            .curvature_slope(foot.unit, foot.unit.powu(self.curve.lobes() + 1));
        let one = c(1.0);
        let room = (one - c(self.offset) * at.curvature) * (one + c(larger) * at.curvature);
        let per_parameter = c(-0.5) * stiffness * c(radius) * bend / room;
        -per_parameter / (at.speed * (one + foot.distance * at.curvature))
    }
}

/// Detection at the closest point of the exact curve. delta is minus the signed distance of P from C, plus the excess of the
/// pin's radius over the one that made the edge. The second field is true if the slope of K is needed.
pub(super) struct Exact(Shapes, bool);

impl Exact {
    /// Creates the detection; the slope of K is only computed for laws with a force along the profile.
    pub(super) fn new(scene: &Scene, geometry: &Geometry, law: &Law) -> Self {
        Self(Shapes::new(scene, geometry), law.along(1.0, 1.0).is_some())
    }

    #[inline]
    fn at<S: Scalar>(&self, j: usize, foot: &Foot<S>) -> Touch<S> {
        let c = |x: f64| foot.distance.like(x);
        let (_, stiffness) = self.0.sleeve(j, foot.at.curvature);
        let stiffness_slope = if self.1 {
            self.0.stiffness_slope(j, foot, stiffness)
        } else {
            c(0.0)
        };
        Touch {
            point: foot.at.position - foot.at.normal.scale(c(self.0.offset)),
            normal: -foot.at.normal,
            penetration: c(self.0.external[j].larger) - foot.distance,
            stiffness,
            stiffness_slope,
        }
    }

    /// Returns the touch of ring pin `j` with derivatives, at the foot e^{ia} = `unit` of the value of `p`.
    pub(super) fn beside<const N: usize>(
        &self,
        j: usize,
        p: Complex<Dual<N>>,
        unit: Complex,
    ) -> Touch<Dual<N>> {
        // The touch depends only on the pin's position, whose two coordinates are fewer variables than all that move it.
        let [x, y] = Dual::variables([p.re.value, p.im.value]);
        let touch = self.at(j, &self.0.curve.foot_beside(unit, Complex::new(x, y)));
        let own = [p.re, p.im];
        let vector = |z: Complex<Dual<2>>| Complex::new(z.re.through(&own), z.im.through(&own));
        Touch {
            point: vector(touch.point),
            normal: vector(touch.normal),
            penetration: touch.penetration.through(&own),
            stiffness: touch.stiffness.through(&own),
            stiffness_slope: touch.stiffness_slope.through(&own),
        }
    }

    /// Returns the touch of the output pin in hole `k` of `wheel`.
    #[inline]
    pub(super) fn in_hole<S: Scalar>(
        &self,
        wheel: usize,
        k: usize,
        p: Complex<S>,
    ) -> Option<Touch<S>> {
        let internal = &self.0.internal[wheel][k];
        let (penetration, normal) = internal.hole.penetration(p, internal.sleeve)?;
        Some(internal.touch(penetration, normal))
    }
}

/// Returns the direction of an offset from a hole's centre; at the centre itself, the disc's x axis.
fn outwards<S: Scalar>(offset: Complex<S>) -> Complex<S> {
    let distance = offset.norm();
    if distance.value() > 0.0 {
        offset.scale(distance.like(1.0) / distance)
    } else {
        Complex::ONE.like(distance)
    }
}

impl Detection for Exact {
    // A curve with an offset provides values only, no derivatives.
    fn exact(&self) -> Option<&Exact> {
        (!self.0.curve.has_offset()).then_some(self)
    }

    #[inline]
    fn profile(&self, j: usize, p: Complex, start: [Complex; 2]) -> Option<(Touch, Complex)> {
        let foot = self.0.foot(j, p, start)?;
        Some((self.at(j, &foot), foot.unit))
    }

    fn profile_gap(&self, j: usize, p: Complex) -> Touch {
        self.at(j, &self.0.curve.closest(p))
    }

    fn hole_gap(&self, wheel: usize, k: usize, p: Complex) -> Touch {
        let internal = &self.0.internal[wheel][k];
        let offset = p - internal.hole.centre;
        let penetration = offset.norm() + internal.sleeve - internal.hole.radius;
        internal.touch(penetration, outwards(offset))
    }

    #[inline]
    fn hole(&self, wheel: usize, k: usize, p: Complex) -> Option<Touch> {
        self.in_hole(wheel, k, p)
    }

    fn sleeve(&self, j: usize, kappa: f64) -> (f64, f64) {
        self.0.sleeve(j, kappa)
    }
}

/// Detection at the paper's points: W is the vertex nearest to P, delta = pin radius - |W - P|.
///
/// Vertices lie on the exact curves and are never closer to P than these. The exact test therefore decides first if any vertex
/// can touch, and its foot selects the candidates.
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
        let radii = geometry.external_radii_m.iter();
        let largest = radii.fold(0.0, |most: f64, &radius| most.max(radius));
        let profile = ProfilePoints::new(&shapes.curve, shapes.offset, largest, wheel_points)
            .ok_or(GearboxError::TooFewPoints { wheel_points })?;
        Ok(Self {
            shapes,
            profile,
            hole: HolePoints::new(hole_points),
        })
    }

    /// Returns the touch of ring pin `j` at the vertex of the edge that is nearest to `p`, whose foot is near e^{ia} = `unit`.
    #[inline]
    fn vertex(&self, j: usize, p: Complex, unit: Complex) -> Touch {
        let (vertex, _) = self.profile.nearest(p, unit.arg());
        let radius = self.shapes.external[j].radius;
        let stiffness = vertex.stiffness(radius, &self.shapes.hertz);
        Touch::at_point(p, vertex.position, radius, stiffness)
    }

    /// Returns the touch of an output pin at the point of its hole nearest to `p`; the points begin along the disc's x axis.
    #[inline]
    fn rim(&self, internal: &Internal, p: Complex) -> Touch {
        let Hole { centre, radius } = internal.hole;
        let point = centre + self.hole.nearest(p - centre).scale(radius);
        Touch::at_point(p, point, internal.sleeve, internal.stiffness)
    }
}

impl Detection for Points {
    #[inline]
    fn profile(&self, j: usize, p: Complex, start: [Complex; 2]) -> Option<(Touch, Complex)> {
        let External { radius, larger } = self.shapes.external[j];
        let unit = self.shapes.curve.unit_within(p, start, larger)?;
        let touch = self.vertex(j, p, unit);
        touch.presses(radius).then_some((touch, unit))
    }

    #[inline]
    fn hole(&self, wheel: usize, k: usize, p: Complex) -> Option<Touch> {
        let internal = &self.shapes.internal[wheel][k];
        internal.hole.penetration(p, internal.sleeve)?;
        let touch = self.rim(internal, p);
        touch.presses(internal.sleeve).then_some(touch)
    }

    fn profile_gap(&self, j: usize, p: Complex) -> Touch {
        self.vertex(j, p, self.shapes.curve.closest(p).unit)
    }

    fn hole_gap(&self, wheel: usize, k: usize, p: Complex) -> Touch {
        self.rim(&self.shapes.internal[wheel][k], p)
    }

    fn sleeve(&self, j: usize, kappa: f64) -> (f64, f64) {
        self.shapes.sleeve(j, kappa)
    }
}
