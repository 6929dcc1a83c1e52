//! Contact points of several pins at a time, in the disc's frame.

use pinwheel_contact::{ComplexLanes, Epitrochoid, Lanes, LocalFeet, Mask, Real};
use pinwheel_scene::scales::hertz;
use pulp::Simd;

use super::columns::Column;
use crate::geometry::Geometry;
use crate::scene::Scene;

/// Touching lanes of a group in the disc's frame.
pub(super) struct Touching<S: Simd> {
    pub(super) mask: Mask<S>,
    pub(super) point: ComplexLanes<S>,
    pub(super) normal: ComplexLanes<S>,
    pub(super) penetration: Lanes<S>,
    pub(super) stiffness: Lanes<S>,
    /// Rate at which n rotates towards t = R90 n as the pin's centre moves along t, 1/m.
    pub(super) turning: Lanes<S>,
    /// Feet of ring pins.
    pub(super) foot: Option<LocalFeet<S>>,
}

/// Derivatives of K where pins touch the profile.
pub(super) struct StiffnessSlopes<S: Simd> {
    /// Derivative of K by the motion of the pin's centre along t = R90 n, N/m^2.5.
    pub(super) along: Lanes<S>,
    /// Derivative of `along` along t, N/m^3.5.
    pub(super) bend: Lanes<S>,
}

/// Geometry of the contacts.
#[derive(Debug, Clone)]
pub(super) struct Shapes {
    pub(super) curve: Epitrochoid,
    /// Shortening m.
    shortening: f64,
    pub(super) zk: u32,
    /// Distance q' of the edge inside of C, m.
    edge: f64,
    /// Excess q - q' of the pins' radius over the tool's, m; never above 0.
    larger: f64,
    /// Radii q, q' and q - q', or 0 where K does not change with the curvature.
    bending: [f64; 3],
    /// K where C is straight, N/m^1.5: K = `profile_stiffness` * sqrt((1 - q' kappa)/(1 + (q - q') kappa)).
    profile_stiffness: f64,
    pub(super) hole_stiffness: f64,
    hole_radius: f64,
    pub(super) clearance: f64,
    pub(super) directions: Column,
    /// Hole centres in the disc's frame, by disc.
    pub(super) holes: Vec<Column>,
}

impl Shapes {
    pub(super) fn new(scene: &Scene, geometry: &Geometry) -> Self {
        let gear = &scene.gear;
        let hertz = hertz(scene);
        let (q, edge) = (gear.external_sleeve_radius_m, geometry.edge_offset_m);
        let larger = q - edge;
        let holes = geometry.hole_centres.iter();
        Self {
            curve: geometry.curve.clone(),
            shortening: gear.generating_shortening(),
            zk: gear.external_sleeves as u32,
            edge,
            larger,
            bending: match hertz.is_curved() {
                true => [q, edge, larger],
                false => [0.0; 3],
            },
            profile_stiffness: hertz.on_flat(q),
            hole_stiffness: hertz.of_hole(gear.internal_sleeve_radius_m, gear.hole_radius_m),
            hole_radius: gear.hole_radius_m,
            clearance: gear.hole_radius_m - gear.internal_sleeve_radius_m,
            directions: Column::padded(geometry.external_directions.iter().copied()),
            holes: holes.map(|w| Column::padded(w.iter().copied())).collect(),
        }
    }

    /// Returns the touches of ring pins centred at `p` (disc frame) with the profile.
    #[inline(always)]
    pub(super) fn profile<S: Simd>(
        &self,
        p: ComplexLanes<S>,
        unit: ComplexLanes<S>,
        multiple: ComplexLanes<S>,
        present: Mask<S>,
    ) -> Touching<S> {
        let feet = self.curve.penetrating_feet(p, unit, multiple, present);
        let foot = feet.foot;
        let edge = p.re.like(self.edge);
        let (mask, penetration) = self.pressed(&foot);
        // P moves along t by 1 - delta kappa times the distance of the foot, and t points towards smaller parameters.
        let closer = (p.re.like(1.0) - foot.curvature * foot.depth).recip();
        Touching {
            mask,
            point: feet.normal.scale_add(-edge, feet.position),
            normal: feet.normal.scale(p.re.like(-1.0)),
            penetration,
            stiffness: self.profile_stiffness(foot.curvature),
            turning: -(foot.curvature * closer),
            foot: Some(foot),
        }
    }

    /// Returns the mask of ring pins in contact, and their penetrations, m.
    #[inline(always)]
    pub(super) fn pressed<S: Simd>(&self, foot: &LocalFeet<S>) -> (Mask<S>, Lanes<S>) {
        if self.larger == 0.0 {
            return (foot.inside, foot.depth);
        }
        let penetration = foot.depth + foot.depth.like(self.larger);
        let pressed = penetration.like(0.0).less(penetration);
        (foot.inside.and(pressed), penetration)
    }

    /// Returns the derivatives of K where ring pins touch, with c and s the cosine and sine of zs a at the foot, g = 1 + m^2 +
    /// 2 m c, and ' the derivative along C:
    ///
    /// ```text
    /// kappa'  = -zs N m s/(R^2 g^3),    N = (1 + zk) g - 3 (1 + m^2 zk + m (1 + zk) c)
    /// kappa'' = -zs^2 (((1 + zk) g + 6 N) m^2 s^2 + N g m c)/(R^3 g^(9/2))
    /// K' = -K q kappa'/(2 r),    K'' = -K q (kappa'' + (q' - 3 l + 4 q' l kappa) kappa'^2/(2 r))/(2 r)
    /// r = (1 - q' kappa)(1 + l kappa),    l = q - q'
    /// ```
    /// The pin's centre moves along t by -(1 - delta kappa) times the distance of the foot.
    #[inline(always)]
    pub(super) fn stiffness_slopes<S: Simd>(
        &self,
        foot: &LocalFeet<S>,
        stiffness: Lanes<S>,
    ) -> StiffnessSlopes<S> {
        let c = |x: f64| stiffness.like(x);
        let (zk, radius) = (f64::from(self.zk), self.curve.pitch_radius());
        let (cos, sin, over_root) = (foot.cos, foot.sin, foot.inverse);
        let m2 = self.shortening * self.shortening;
        let g = cos.mul_add(c(2.0), c(1.0 + m2));
        let bend = cos.mul_add(c(1.0 + zk), c(1.0 + m2 * zk));
        let by_cos = g * c(1.0 + zk) - bend * c(3.0);
        let over_g = over_root * over_root;
        let over = over_g * over_g * over_g * c(1.0 / (radius * radius));
        let first = -(by_cos * c(zk - 1.0) * sin * over);
        let squared = (g * c(1.0 + zk) + by_cos * c(6.0)) * sin * sin;
        let second = -((squared + by_cos * g * cos)
            * over
            * over_g
            * over_root
            * c((zk - 1.0) * (zk - 1.0) / radius));

        let [q, edge, larger] = self.bending.map(c);
        let mut twice = c(2.0) - (edge + edge) * foot.curvature;
        let mut bent = edge;
        if self.larger != 0.0 {
            twice = twice * foot.curvature.mul_add(larger, c(1.0));
            let both = edge * larger * c(4.0);
            bent = foot.curvature.mul_add(both, edge - larger * c(3.0));
        }
        let half = twice.recip();
        let share = stiffness * q * half;
        let closer = (c(1.0) - foot.curvature * foot.depth).recip();
        let along = share * first * closer;
        let curving = -(share * (second + bent * first * first * half));
        StiffnessSlopes {
            along,
            bend: (curving - along * foot.depth * first) * closer * closer,
        }
    }

    /// Returns K for a curvature of C, N/m^1.5.
    #[inline(always)]
    pub(super) fn profile_stiffness<S: Simd>(&self, curvature: Lanes<S>) -> Lanes<S> {
        let [_, edge, larger] = self.bending;
        let mut radicand = curvature.mul_add(curvature.like(-edge), curvature.like(1.0));
        if larger != 0.0 {
            let wider = curvature.mul_add(curvature.like(larger), curvature.like(1.0));
            radicand = radicand * wider.recip();
        }
        curvature.like(self.profile_stiffness) * radicand.sqrt()
    }

    /// Returns the touches of output pins centred at `p` (disc frame) with their holes.
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
            foot: None,
        }
    }
}
