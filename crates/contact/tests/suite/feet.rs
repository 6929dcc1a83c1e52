//! Closest points: the searches against brute force, and the search in lanes against the scalar one.

use super::brute;

use pinwheel_contact::{Complex, ComplexLanes, Epitrochoid, FeetLanes, Foot, Lanes, Mask};
use proptest::prelude::*;
use pulp::Simd;
use std::f64::consts::{PI, TAU};

const ECCENTRICITY: f64 = 0.0028;

/// Gear and pose of its disc: `lag` pitches behind the ideal mesh, and shifted from its orbit.
#[derive(Debug, Clone, Copy)]
struct Pose {
    zk: u32,
    m: f64,
    backlash: f64,
    input: f64,
    lag: f64,
    shift: f64,
    towards: f64,
}

impl Pose {
    fn curve(&self) -> Epitrochoid {
        Epitrochoid::new(ECCENTRICITY, self.zk, self.m).unwrap()
    }

    /// Returns this pose with the disc at `count` places of its orbit.
    fn turned(self, count: u32) -> impl Iterator<Item = Self> {
        (0..count).map(move |k| Self {
            input: self.input + f64::from(k),
            ..self
        })
    }
}

/// Pins about a disc, in the disc's frame.
struct Mesh<'a> {
    curve: &'a Epitrochoid,
    points: Vec<Complex>,
    /// Feet in the ideal mesh.
    units: Vec<Complex>,
    multiple: Complex,
}

impl<'a> Mesh<'a> {
    fn new(curve: &'a Epitrochoid, pose: &Pose) -> Self {
        let zk = pose.zk;
        let pitch = TAU / f64::from(zk);
        let theta = (PI - pose.input) / f64::from(curve.lobes()) + pose.lag * pitch;
        let shift = Complex::unit(pose.towards).scale(pose.shift);
        let centre = Complex::unit(pose.input).scale(ECCENTRICITY) + shift;
        let back = Complex::unit(-theta);
        let sleeve = |k: u32| Complex::unit(pitch * f64::from(k));
        let circle = curve.pitch_radius() + pose.backlash;
        Self {
            points: (0..zk)
                .map(|k| (sleeve(k).scale(circle) - centre) * back)
                .collect(),
            units: (0..zk).map(|k| sleeve(k) * back).collect(),
            multiple: back.powu(zk),
            curve,
        }
    }

    /// Returns the depths of all pins by the scalar search; 0 outside.
    fn depths(&self) -> Vec<f64> {
        self.points
            .iter()
            .zip(&self.units)
            .map(|(&p, &unit)| {
                let foot = self.curve.foot_within(p, [unit, self.multiple], 0.0);
                foot.map_or(0.0, |foot| -foot.distance)
            })
            .collect()
    }

    /// Compares groups of lanes of every instruction set with the scalar search. On the curve rounding decides between inside
    /// and outside, with no effect on forces.
    fn check(&self) -> Result<(), TestCaseError> {
        self.check_to(0.0)
    }

    /// Compares groups of lanes of every instruction set with the scalar search; depths may have a relative difference of
    /// `share`.
    fn check_to(&self, share: f64) -> Result<(), TestCaseError> {
        let depths = self.depths();
        for arch in [pulp::Arch::new(), at_most_avx2(), pulp::Arch::Scalar] {
            arch.dispatch(Lanewise(self, &depths, share))?;
        }
        Ok(())
    }
}

#[cfg(target_arch = "x86_64")]
fn at_most_avx2() -> pulp::Arch {
    pulp::x86::V3::try_new().map_or(pulp::Arch::Scalar, pulp::Arch::V3)
}

#[cfg(not(target_arch = "x86_64"))]
fn at_most_avx2() -> pulp::Arch {
    pulp::Arch::Scalar
}

struct Lanewise<'a>(&'a Mesh<'a>, &'a [f64], f64);

impl Lanewise<'_> {
    /// Checks the parts of a foot in lane `k` that the kernels use besides its depth, normal and curvature.
    fn check_parts<S: Simd>(
        &self,
        feet: &FeetLanes<S>,
        k: usize,
        start: Complex,
        exact: &Foot,
    ) -> Result<(), TestCaseError> {
        let (curve, foot) = (self.0.curve, &feet.foot);
        let scale = curve.pitch_radius();
        let off = (feet.position.lane(k) - exact.at.position).norm();
        prop_assert!(off < 1e-11 * scale, "position: off by {off:e}");
        // Complex number m e^{i zs a}: the lobe's contribution to a direction.
        let share = ECCENTRICITY * f64::from(curve.lobes() + 1) / scale;
        let lobe = (exact.unit.powu(curve.lobes())).scale(share);
        let actual = Complex::new(foot.cos.as_slice()[k], foot.sin.as_slice()[k]);
        let off = (actual - lobe).norm();
        prop_assert!(off < 1e-10, "lobe: off by {off:e}");
        let stretch = exact.at.speed / scale;
        let off = foot.inverse.as_slice()[k] * stretch - 1.0;
        prop_assert!(off.abs() < 1e-10, "inverse: off by {off:e}");
        let off = foot.outward.lane(k).norm() / stretch - 1.0;
        prop_assert!(off.abs() < 1e-10, "outward: off by {off:e}");
        let off = (foot.turn.lane(k) * start - exact.unit).norm();
        prop_assert!(off < 1e-11, "turn: off by {off:e}");
        Ok(())
    }
}

impl pulp::WithSimd for Lanewise<'_> {
    type Output = Result<(), TestCaseError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(mesh, depths, share) = self;
        let (curve, width) = (mesh.curve, Lanes::<S>::COUNT);
        // Rounding of positions, about 4 ulp of R.
        let rounding = 1e-15_f64.max(8.0 * f64::EPSILON * curve.pitch_radius());
        let multiple = ComplexLanes::splat(simd, mesh.multiple);
        for from in (0..mesh.points.len()).step_by(width) {
            let count = width.min(mesh.points.len() - from);
            let mut p = ComplexLanes::splat(simd, mesh.points[from]);
            let mut unit = ComplexLanes::splat(simd, mesh.units[from]);
            for k in 0..count {
                p.set_lane(k, mesh.points[from + k]);
                unit.set_lane(k, mesh.units[from + k]);
            }
            let feet = curve.penetrating_feet(p, unit, multiple, Mask::first(simd, count));
            for k in 0..width {
                let exact = depths.get(from + k).copied().unwrap_or(0.0);
                let depth = feet.foot.depth.only(feet.foot.inside).as_slice()[k];
                prop_assert!(
                    (depth - exact).abs() < rounding + share * exact,
                    "sleeve {}: {depth} {exact}",
                    from + k
                );
                if !feet.foot.inside.lane(k) {
                    continue;
                }
                prop_assert!(k < count);
                prop_assert!(depth > 0.0, "inside at a depth of {depth}");
                let scalar = curve.foot_within(p.lane(k), [unit.lane(k), mesh.multiple], 0.0);
                if let Some(foot) = scalar {
                    prop_assert!((feet.normal.lane(k) - foot.at.normal).norm() < 1e-11);
                    let (kappa, exact) = (feet.foot.curvature.as_slice()[k], foot.at.curvature);
                    prop_assert!((kappa - exact).abs() < 1e-9 * exact.abs().max(1.0));
                    self.check_parts(&feet, k, unit.lane(k), &foot)?;
                }
            }
        }
        Ok(())
    }
}

prop_compose! {
    /// Poses near the mesh, with backlash up to half of e, the maximum of a scene. Lags are in pitches: Newton's difficulty
    /// depends on the place along the lobe.
    fn poses(sleeves: std::ops::Range<u32>, shortening: std::ops::Range<f64>)(
        zk in sleeves, m in shortening, backlash in prop_oneof![Just(0.0), 0.0..0.5 * ECCENTRICITY],
        input in 0.0..TAU, lag in -0.25..0.25_f64, shift in 0.0..2e-4_f64, towards in 0.0..TAU,
    ) -> Pose {
        Pose { zk, m, backlash, input, lag, shift, towards }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// For any point around any gear the global search agrees with brute force.
    #[test]
    fn closest_is_global(zk in 3_u32..121, m in 0.2_f64..0.95, radius in 0.0_f64..1.5, angle in -3.2_f64..3.2) {
        let curve = Epitrochoid::new(ECCENTRICITY, zk, m).unwrap();
        let p = Complex::unit(angle).scale(radius * curve.pitch_radius());
        let foot = curve.closest(p);
        let scale = curve.pitch_radius();
        prop_assert!((foot.distance + brute::depth(&curve, p)).abs() < 1e-9 * scale, "{foot:?}");
    }

    /// For all pins of any gear, inside and depth agree with brute force.
    #[test]
    fn penetration_is_global(pose in poses(3..121, 0.2..0.95)) {
        let curve = pose.curve();
        let mesh = Mesh::new(&curve, &pose);
        for (&p, computed) in mesh.points.iter().zip(mesh.depths()) {
            let depth = brute::depth(&curve, p).max(0.0);
            prop_assert!((computed - depth).abs() < 2e-15, "{computed} {depth}");
        }
    }

    /// Each lane agrees with the scalar search for any gear, pose, backlash and instruction set.
    #[test]
    fn lanes_are_the_scalar_search(pose in poses(3..121, 0.2..0.95)) {
        let curve = pose.curve();
        for pose in pose.turned(8) {
            Mesh::new(&curve, &pose).check()?;
        }
    }

    /// Lanes agree with the scalar search where Newton's steps run out most often, once in some thousand poses.
    #[test]
    fn hard_lanes_out_of_steps(pose in poses(60..121, 0.5..0.72)) {
        let curve = pose.curve();
        for pose in pose.turned(24) {
            Mesh::new(&curve, &pose).check()?;
        }
    }
}

/// Pins on the curve to rounding: a pin inside has a depth above 0, of which laws take roots.
#[test]
fn regress_sleeves_on_the_curve() {
    for zk in [5, 16, 61] {
        let mesh = Pose {
            zk,
            m: 0.7,
            backlash: 0.0,
            input: 0.0,
            lag: 0.0,
            shift: 0.0,
            towards: 0.0,
        };
        let curve = mesh.curve();
        for pose in mesh.turned(64) {
            Mesh::new(&curve, &pose).check().unwrap();
        }
    }
}

/// Pins inside far beyond the depth at which a foot is certain: the lanes use the scalar search.
#[test]
fn hard_lanes_of_deep_sleeves() {
    let mut deep = 0;
    for (zk, m) in [(16, 0.7), (40, 0.6), (7, 0.9), (3, 0.3)] {
        let pose = Pose {
            zk,
            m,
            backlash: 0.0,
            input: 0.4,
            lag: 0.01,
            shift: 1e-4,
            towards: 0.3,
        };
        let curve = pose.curve();
        for pose in pose.turned(3) {
            let mut mesh = Mesh::new(&curve, &pose);
            for share in [0.97, 0.9, 0.8, 0.6, 0.4, 0.2] {
                mesh.points = (mesh.points.iter().zip(&mesh.units))
                    .map(|(p, unit)| unit.scale(share * curve.pitch_radius()) + p.scale(1e-2))
                    .collect();
                // Their normals have the rounding of powers of zk; measured: 1e-13 of the depth.
                mesh.check_to(1e-12).unwrap();
                deep += mesh.depths().iter().filter(|depth| **depth > 0.0).count();
            }
        }
    }
    assert!(deep > 500, "{deep}");
}

/// Pins larger than the edge's offset also touch outside the curve, exactly where the search over the entire curve has a foot,
/// from starts beside the ideal mesh's.
#[test]
fn feet_within_a_limit_are_those_of_the_complete_curve() {
    let (mut near, mut far) = (0, 0);
    for (zk, m) in [(16, 0.7), (40, 0.6), (11, 0.9)] {
        let curve = Epitrochoid::new(ECCENTRICITY, zk, m).unwrap();
        for k in 0..2000_u32 {
            let a = 0.00314 * f64::from(k);
            let limit = [1e-7, 1e-5, 3e-4, 2e-3][k as usize % 4];
            let at = curve.at(a);
            // From half the limit inside to twice the limit outside, and lifted off along the ray.
            let away = limit * (0.31 * f64::from(k % 9) - 0.5);
            let lifted = at.position.scale(0.02 * f64::from(k % 3));
            let p = at.position + at.normal.scale(away) + lifted;
            let start = Complex::unit(a + 2e-3 * f64::from(k % 5) - 4e-3);
            let foot = curve.foot_within(p, [start, start.powu(zk)], limit);
            let closest = curve.closest(p);
            assert_eq!(
                foot.is_some(),
                closest.distance < limit,
                "{zk} {k}: {}",
                closest.distance
            );
            match foot {
                Some(foot) => {
                    assert!((foot.distance - closest.distance).abs() < 1e-15, "{zk} {k}");
                    near += 1;
                }
                None => far += 1,
            }
        }
    }
    assert!(near > 1000 && far > 1000, "{near} {far}");
}
