//! Discrete points of profiles and holes.

use std::f64::consts::TAU;

use pinwheel_contact::{
    Complex, Epitrochoid, HertzStiffness, Hole, HolePoints, Material, ProfilePoints,
};
use proptest::prelude::*;

/// Returns the point on the offset of `curve` by `offset` at the parameter `a`.
fn vertex(curve: &Epitrochoid, offset: f64, a: f64) -> Complex {
    let at = curve.at(a);
    at.position - at.normal.scale(offset)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// The walk and a scan of all vertices agree, for any gear and number of points.
    #[test]
    fn nearest_vertex_is_the_scan_s(
        zk in 4_u32..30, m in 0.3_f64..0.8, per_lobe in 8_usize..300, a in -3.2_f64..3.2, depth in -1e-4_f64..2e-4,
        off in -3e-3_f64..3e-3,
    ) {
        let curve = Epitrochoid::new(0.0028, zk, m).unwrap();
        let q = 0.45 / curve.largest_curvature();
        let count = per_lobe * curve.lobes() as usize;
        let points = ProfilePoints::new(&curve, q, q, count);
        prop_assume!(points.is_some());
        let points = points.unwrap();
        let at = curve.at(a);
        let p = at.position - at.normal.scale(depth);
        let (_, nearest) = points.nearest(p, curve.closest(p).parameter());
        let vertices = (0..count).map(|k| vertex(&curve, q, TAU / count as f64 * k as f64));
            let scan = vertices.map(|v| (p - v).norm2()).fold(f64::INFINITY, f64::min);
        prop_assert!(nearest == scan, "{nearest} {scan}");
        let start = [a + off, f64::from(zk) * (a + off)].map(Complex::unit);
        match curve.unit_within(p, start, 0.0) {
            Some(unit) => prop_assert!(points.nearest(p, unit.arg()).1 == scan, "{scan}"),
            None => prop_assert!(scan >= q * q, "{scan} {q}"),
        }
    }

    /// The direct formula and a scan of all points of a hole agree.
    #[test]
    fn nearest_hole_point_is_the_scan_s(count in 8_usize..200, angle in -3.2_f64..3.2) {
        let points = HolePoints::new(count);
        let offset = Complex::unit(angle).scale(0.0028);
        let reach = points.nearest(offset).dot(offset);
        let directions = (0..count).map(|k| Complex::unit(TAU / count as f64 * k as f64));
            let scan = directions.map(|d| d.dot(offset)).fold(f64::MIN, f64::max);
        prop_assert!((reach - scan).abs() < 1e-15);
    }
}

/// From a foot some points off, to either side, the walk reaches the same vertex.
#[test]
fn the_walk_goes_both_ways() {
    let curve = Epitrochoid::new(0.0028, 16, 0.7).unwrap();
    let points = ProfilePoints::new(&curve, 0.006, 0.006, 4000).unwrap();
    let step = TAU / 4000.0;
    for k in 0..100 {
        let a = 0.0627 * f64::from(k);
        let at = curve.at(a);
        let p = at.position - at.normal.scale(0.006 + 1e-5);
        let (_, right) = points.nearest(p, a);
        for wrong in [-6.0, -2.3, -1.2, 1.2, 2.3, 6.0] {
            let (_, vertex) = points.nearest(p, a + wrong * step);
            assert_eq!(vertex, right, "{k} {wrong}");
        }
    }
}

#[test]
fn fine_points_have_the_exact_curvature() {
    let curve = Epitrochoid::new(0.0028, 16, 0.7).unwrap();
    let steel = Material {
        young: 2e11,
        poisson: 0.3,
    };
    let hertz = HertzStiffness::new(steel, steel, 0.01);
    let points = ProfilePoints::new(&curve, 0.006, 0.006, 40_000).unwrap();
    for k in (0..40_000).step_by(97) {
        let a = TAU * k as f64 / 40_000.0;
        let kappa = curve.at(a).curvature;
        let exact = hertz.of_edge(0.006, 0.006, kappa);
        let actual = points
            .nearest(vertex(&curve, 0.006, a), a)
            .0
            .stiffness(0.006, &hertz);
        assert!((actual / exact - 1.0).abs() < 2e-3, "{k}: {actual} {exact}");
    }
}

#[test]
fn penetration_is_signed_by_clearance() {
    let hole = Hole {
        centre: Complex::new(0.038, 0.0),
        radius: 0.0088,
    };
    assert!(hole.penetration(Complex::new(0.0407, 0.0), 0.006).is_none());
    let (depth, normal) = hole.penetration(Complex::new(0.0409, 0.0), 0.006).unwrap();
    assert!((depth - 1e-4).abs() < 1e-15 && normal == Complex::ONE);
    // A pin in the very centre touches nothing, although its direction is undefined.
    assert!(hole.penetration(hole.centre, 0.006).is_none());
}
