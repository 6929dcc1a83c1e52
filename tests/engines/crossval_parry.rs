//! Distances of points from the curve: the exact closest point against parry with a fine polyline.

use std::f64::consts::TAU;

use parry2d_f64::math::Vector;
use parry2d_f64::query::PointQuery;
use parry2d_f64::shape::{Polyline, PolylineFlags};
use pinwheel_contact::{Complex, Epitrochoid, LobeOffset};
use pinwheel_studies::rng::Rng;

/// Number of vertices of the polyline. Its error falls with their square: 12 000 give 2.6e-7 m.
const VERTICES: usize = 40_000;

/// Measured 2.3e-8 m on the paper's gear, 4 times that for others; an error of the exact point, of
/// the order of a lobe or of its sign, would be 1e-5 m and more.
const LIMIT_M: f64 = 1e-7;

/// Returns parry's polyline of the pin centres' curve. Counter-clockwise: inside is solid.
fn polyline(curve: &Epitrochoid) -> Polyline {
    let point = |i: usize| curve.at(TAU * i as f64 / VERTICES as f64).position;
    let vertices = (0..VERTICES)
        .map(|i| Vector::new(point(i).re, point(i).im))
        .collect();
    let segments = (0..VERTICES as u32)
        .map(|i| [i, (i + 1) % VERTICES as u32])
        .collect();
    Polyline::with_flags(vertices, Some(segments), PolylineFlags::ORIENTED)
}

/// Returns the largest difference of distance over random positions: half of them within contact and backlash of the curve,
/// half anywhere in and around the gear.
fn largest_error(curve: &Epitrochoid, positions: usize) -> f64 {
    let line = polyline(curve);
    let mut random = Rng::new(7);
    let mut largest: f64 = 0.0;
    for i in 0..positions {
        let p = if i % 2 == 0 {
            let at = curve.at(TAU * random.share());
            // From 1 nm to 1 mm, on both sides.
            let off = 10.0_f64.powf(-9.0 + 6.0 * random.share());
            let side = if random.share() < 0.5 { -1.0 } else { 1.0 };
            at.position + at.normal.scale(side * off)
        } else {
            Complex::unit(TAU * random.share()).scale(1.5 * curve.pitch_radius() * random.share())
        };
        let foot = curve.closest(p);
        let point = Vector::new(p.re, p.im);
        let nearest = line.project_local_point(point, false);
        let distance = (point - nearest.point).length();
        let error = (distance - foot.distance.abs()).abs();
        assert!(
            error < LIMIT_M,
            "at ({}, {}): parry {distance:e} m, exact {:e} m",
            p.re,
            p.im,
            foot.distance
        );
        // For points closer to the curve than the polyline is, the side depends on the polyline.
        if foot.distance.abs() > LIMIT_M {
            assert_eq!(
                nearest.is_inside,
                foot.distance < 0.0,
                "side at ({}, {})",
                p.re,
                p.im
            );
        }
        largest = largest.max(error);
    }
    largest
}

#[test]
fn crossval_parry_distance() {
    let curve = Epitrochoid::new(0.0028, 16, 0.7).unwrap();
    let largest = largest_error(&curve, 40_000);
    // The oracle is no finer than this: an error of zero would mean that nothing was compared.
    assert!(largest > 1e-10, "{largest:e}");
    println!("largest difference {largest:e} m");
}

#[test]
fn crossval_parry_distance_of_other_gears() {
    // Few and many lobes, blunt and sharp pits.
    for (eccentricity, sleeves, shortening) in [
        (0.003, 11, 0.7),
        (0.0012, 40, 0.7),
        (0.002, 6, 0.35),
        (0.0015, 24, 0.9),
    ] {
        let curve = Epitrochoid::new(eccentricity, sleeves, shortening).unwrap();
        let largest = largest_error(&curve, 5_000);
        println!("zk = {sleeves}, m = {shortening}: largest difference {largest:e} m");
    }
}

/// User-defined profiles by a Fourier series with unequal flanks, and by points.
#[test]
fn crossval_parry_distance_of_own_profiles() {
    for offset in [
        LobeOffset::series(&[5e-6, 8e-6, 0.0, -2e-6], &[6e-6, 1e-6]),
        LobeOffset::spline(&[0.0, 9e-6, 2e-6, -5e-6, 4e-6, 1e-6, -3e-6, 6e-6]),
    ] {
        let curve = Epitrochoid::with_offset(0.0028, 16, 0.7, offset).unwrap();
        println!("largest difference {:e} m", largest_error(&curve, 4_000));
    }
}
