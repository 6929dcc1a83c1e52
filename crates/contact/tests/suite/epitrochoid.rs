//! The curve of a disc: curvatures, reaches, slopes.

use approx::assert_relative_eq;
use std::f64::consts::TAU;

use pinwheel_contact::{Complex, Epitrochoid, LobeOffset};

/// The paper's disc (Tab. 1).
fn paper() -> Epitrochoid {
    Epitrochoid::new(0.0028, 16, 0.7).unwrap()
}

#[test]
fn curvature_slope_is_the_derivative() {
    let curve = paper();
    for k in 0..50 {
        let (a, h) = (0.13 * f64::from(k), 1e-6);
        let unit = Complex::unit(a);
        let slope = (curve.at(a + h).curvature - curve.at(a - h).curvature) / (2.0 * h);
        let exact = curve.curvature_slope(unit, unit.powu(16));
        assert!((exact - slope).abs() < 1e-3, "{a}: {exact} {slope}");
    }
}

#[test]
fn paper_radii_of_curvature() {
    let curve = paper();
    assert_relative_eq!(curve.pitch_radius(), 0.064, max_relative = 1e-15);
    assert_relative_eq!(
        1.0 / curve.curvature(1.0) - 0.006,
        9.1607e-3,
        max_relative = 1e-5
    );
    assert_relative_eq!(
        1.0 / curve.curvature(-1.0) - 0.006,
        -6.5647e-3,
        max_relative = 1e-5
    );
    // R sqrt(27 (1 - m^2)(zk - 1)/(zk + 1)^3), at c = -0.1.
    let closed: f64 = 0.064 * (27.0_f64 * 0.51 * 15.0 / 17.0_f64.powi(3)).sqrt();
    assert_relative_eq!(
        1.0 / curve.largest_curvature(),
        closed,
        max_relative = 1e-13
    );
    assert_relative_eq!(1.0 / curve.curvature(-0.1), closed, max_relative = 1e-13);
}

#[test]
fn normal_and_curvature_agree_with_differences() {
    let curve = paper();
    for k in 0..200 {
        let (a, h) = (0.0314 * f64::from(k), 1e-5);
        let (before, here, after) = (curve.at(a - h), curve.at(a), curve.at(a + h));
        let tangent = (after.position - before.position).scale(0.5 / h);
        assert_relative_eq!(tangent.norm(), here.speed, max_relative = 1e-7);
        assert!(tangent.dot(here.normal).abs() < 1e-7 * here.speed);
        let turn = before.normal.cross(after.normal).asin() / (2.0 * h);
        assert_relative_eq!(
            turn / here.speed,
            here.curvature,
            max_relative = 1e-5,
            epsilon = 1e-2
        );
    }
}

#[test]
fn reach_is_just_below_the_sharpest_radii() {
    let curve = paper();
    assert_relative_eq!(curve.reach_outside, 0.9 * 0.5647e-3, max_relative = 1e-3);
    assert_relative_eq!(curve.reach_inside, 0.9 * 13.12258e-3, max_relative = 1e-3);
}

/// Convex, few lobes (the opposite side bounds the reach inside), sharp, many lobes.
const CURVES: [(u32, f64); 6] = [
    (3, 0.3),
    (3, 0.9),
    (4, 0.1),
    (16, 0.7),
    (7, 0.95),
    (60, 0.6),
];

/// Returns `count` parameters of half a lobe, which all others mirror.
fn half_a_lobe(curve: &Epitrochoid, count: u32) -> impl Iterator<Item = f64> {
    let half = std::f64::consts::PI / f64::from(curve.lobes());
    (0..=count).map(move |k| half * f64::from(k) / f64::from(count))
}

/// Reaches by their definition, over pairs of places and by curvatures: 0.9 of the radii of the largest balls that touch a
/// place and contain no part of the curve.
#[test]
fn reaches_are_those_of_all_pairs() {
    for (zk, m) in CURVES {
        let curve = Epitrochoid::new(0.0028, zk, m).unwrap();
        let r = curve.pitch_radius();
        let all = 150 * curve.lobes();
        let others: Vec<_> = (0..all)
            .map(|k| curve.at(std::f64::consts::TAU * f64::from(k) / f64::from(all)))
            .collect();
        let curvatures = half_a_lobe(&curve, 4000).map(|a| curve.at(a).curvature);
        let sharpest = curvatures.fold(f64::NEG_INFINITY, f64::max);
        assert_relative_eq!(curve.largest_curvature(), sharpest, max_relative = 1e-5);
        let (mut outside, mut inside, mut repulsion) = (10.0 * r, f64::INFINITY, 0.0_f64);
        for a in half_a_lobe(&curve, 75) {
            let at = curve.at(a);
            let mut here = 10.0 * r;
            if at.curvature < 0.0 {
                here = here.min(-1.0 / at.curvature);
            } else {
                inside = inside.min(1.0 / at.curvature);
            }
            for other in &others {
                let chord = other.position - at.position;
                if chord.norm() < 1e-9 * r {
                    continue;
                }
                let ball = chord.norm2() / (2.0 * chord.dot(at.normal));
                if ball > 0.0 {
                    here = here.min(ball);
                } else {
                    inside = inside.min(-ball);
                }
            }
            outside = outside.min(here);
            repulsion = repulsion.max(at.speed / (2.0 * here * r));
        }
        for (name, actual, exact) in [
            ("outside", curve.reach_outside, 0.9 * outside),
            ("inside", curve.reach_inside, 0.9 * inside),
            ("repulsion", curve.repulsion(), r * repulsion / 0.9),
        ] {
            assert_relative_eq!(actual, exact, max_relative = 2e-3);
            assert!(actual.is_finite() && actual > 0.0, "{zk} {m} {name}");
        }
    }
}

/// Slope: 1.1 of the steepest angle between curve and circle, by differences. Tolerance: that of the sharpest place, from
/// speeds and normals by differences.
#[test]
fn slopes_and_tolerances_are_those_of_the_sharpest_places() {
    let mut gentle = 0;
    for (zk, m) in CURVES.into_iter().chain([(120, 0.95)]) {
        let curve = Epitrochoid::new(0.0028, zk, m).unwrap();
        let (r, h) = (curve.pitch_radius(), 1e-4 / f64::from(zk));
        let (mut steepest, mut product) = (0.0_f64, 0.0_f64);
        for a in half_a_lobe(&curve, 400) {
            let (before, after) = (curve.at(a - h), curve.at(a + h));
            let tangent = after.position - before.position;
            let here = curve.at(a).position;
            steepest = steepest.max((here.dot(tangent) / here.cross(tangent)).abs());
            let uneven = (after.speed - before.speed) / (2.0 * h) / (2.0 * r);
            let turned = before.normal.cross(after.normal).asin() / tangent.norm();
            // In units of R the speed is sqrt(g), and its change along the arc counts.
            let stretch = curve.at(a).speed / r;
            product = product.max((uneven / stretch.powi(2) * turned * r).abs());
        }
        assert_relative_eq!(curve.steepest, 1.1 * steepest + 1e-3, max_relative = 5e-3);
        let share = (2000.0 / product).sqrt().min(1.0);
        // 64 samples miss the tip of the sharpest pits: 40 % at m = 0.95, 0.25 % elsewhere.
        let missed = if m > 0.9 { 0.6 } else { 5e-3 };
        assert_relative_eq!(curve.settling, share, max_relative = missed);
        gentle += i32::from(share == 1.0);
    }
    assert!((1..7).contains(&gentle), "{gentle}");
}

#[test]
fn a_curve_knows_what_it_was_made_of() {
    let curve = paper();
    assert!(curve.is_of(0.0028, 16, 0.7, None) && curve.lobes() == 15);
    for (e, zk, m) in [(0.0029, 16, 0.7), (0.0028, 17, 0.7), (0.0028, 16, 0.8)] {
        assert!(!curve.is_of(e, zk, m, None));
    }
}

#[test]
fn out_of_range_parameters_are_refused() {
    for (e, zk, m) in [
        (0.0, 16, 0.7),
        (f64::NAN, 16, 0.7),
        (0.0028, 2, 0.7),
        (0.0028, 16, 1.0),
        (0.0028, 16, 0.0),
    ] {
        assert!(Epitrochoid::new(e, zk, m).is_none());
    }
}

fn moved(offset: LobeOffset) -> Option<Epitrochoid> {
    Epitrochoid::with_offset(0.0028, 16, 0.7, Some(offset))
}

/// Returns a wavy offset with different flanks, m.
fn waves() -> LobeOffset {
    LobeOffset::series(&[5e-6, 8e-6, 0.0, -2e-6], &[6e-6, 1e-6]).unwrap()
}

/// Normal, speed and curvature of an offset curve are the derivatives of its points; both certificates agree with a search of
/// the entire curve.
#[test]
fn a_moved_curve_is_its_points() {
    let curve = moved(waves()).unwrap();
    let h = 1e-5;
    for k in 0..200 {
        let a = 0.0314 * f64::from(k);
        let [low, at, high] = [a - h, a, a + h].map(|a| curve.at(a));
        let first = (high.position - low.position).scale(0.5 / h);
        assert!((first.norm() / at.speed - 1.0).abs() < 1e-6);
        assert!((first.scale(1.0 / at.speed) - at.normal.turned()).norm() < 1e-6);
        let turn = low.normal.cross(high.normal) / (2.0 * h * at.speed);
        assert!(
            (turn - at.curvature).abs() < 1e-4 * at.curvature.abs() + 1e-3,
            "{a}"
        );
        for off in [-2e-4, -1e-6, 1e-6, 3e-4] {
            let p = at.position + at.normal.scale(off);
            let global = curve.closest(p);
            assert!(
                (global.distance - off).abs() < 1e-13,
                "{a}: {off} {}",
                global.distance
            );
            let start = Complex::unit(a + 1e-3);
            let local = curve.foot_within(p, [start, start.powu(16)], 0.0);
            assert_eq!(local.is_some(), off < 0.0);
            assert!(local.is_none_or(|foot| (foot.distance - global.distance).abs() < 1e-14));
        }
    }
}

/// A constant offset is a parallel curve, and points of a series reproduce it. Points of the distance to a larger generating
/// circle reproduce that circle within the spline's error, which falls with the fourth power of the step.
#[test]
fn published_offsets_are_the_built_in_modifications() {
    let plain = Epitrochoid::new(0.0028, 16, 0.7).unwrap();
    let parallel = moved(LobeOffset::series(&[1e-5], &[]).unwrap()).unwrap();
    let larger = Epitrochoid::new(0.0028, 16, 0.0028 * 16.0 / (0.064 + 2e-5)).unwrap();
    // Along the inward normal of the plain curve to the larger one.
    let way = |phase: f64| {
        let at = plain.at(phase / 15.0);
        let mut w = 0.0;
        for _ in 0..40 {
            w += larger.closest(at.position - at.normal.scale(w)).distance;
        }
        w
    };
    let spline = |points: u32, w: &dyn Fn(f64) -> f64| {
        let values = (0..points).map(|k| w(TAU * f64::from(k) / f64::from(points)));
        LobeOffset::spline(&values.collect::<Vec<_>>()).unwrap()
    };
    let series = |phase: f64| waves().at(phase)[0];
    let error = |curve: &Epitrochoid, other: &Epitrochoid| {
        let far = (0..300).map(|k| {
            curve
                .closest(other.at(0.0209 * f64::from(k)).position)
                .distance
                .abs()
        });
        far.fold(0.0, f64::max)
    };
    let radial = [40, 80].map(|n| error(&moved(spline(n, &way)).unwrap(), &larger));
    let waved = [40, 80].map(|n| {
        error(
            &moved(spline(n, &series)).unwrap(),
            &moved(waves()).unwrap(),
        )
    });
    println!("radial {radial:?}, waves {waved:?}");
    assert!(
        radial[1] < 1e-9 && radial[0] / radial[1] > 8.0,
        "{radial:?}"
    );
    assert!(waved[1] < 1e-10 && waved[0] / waved[1] > 12.0, "{waved:?}");
    for k in 0..100 {
        let (at, moved) = (
            plain.at(0.0628 * f64::from(k)),
            parallel.at(0.0628 * f64::from(k)),
        );
        assert!((at.position - at.normal.scale(1e-5) - moved.position).norm() < 1e-15);
        assert!((moved.curvature * (1.0 - 1e-5 * at.curvature) / at.curvature - 1.0).abs() < 1e-9);
    }
    assert!(parallel.reach_inside < plain.reach_inside);
}

#[test]
fn bad_input_offsets_that_fold() {
    // Offset beyond the radius of the pit.
    assert!(moved(LobeOffset::series(&[-1e-3], &[]).unwrap()).is_none());
    assert!(LobeOffset::spline(&[0.0, 1e-6]).is_none());
    assert!(LobeOffset::series(&[f64::NAN], &[]).is_none());
}
