//! Parts that fit together.

use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

use pinwheel_scene::internals::{Profile, external_sleeves, holes_inside_the_wheel, profile};
use pinwheel_scene::{Gear, Scene};

/// Returns the polar angle of hole k of disc i in the disc's frame.
fn hole_angles(gear: &Gear) -> Vec<f64> {
    let zs = gear.lobes() as f64;
    (0..gear.wheels)
        .flat_map(|i| {
            let phase = TAU * i as f64 / gear.wheels as f64;
            (0..gear.internal_sleeves)
                .map(move |k| TAU * k as f64 / gear.internal_sleeves as f64 - (PI - phase) / zs)
        })
        .collect()
}

/// Returns the smallest distance of a hole's centre from the profile by brute force, m; negative outside.
fn room(gear: &Gear) -> f64 {
    let curve = Profile::of(gear);
    let edge: Vec<[f64; 2]> = (0..20_000)
        .map(|i| curve.offset_point(TAU * f64::from(i) / 20_000.0))
        .collect();
    let circle = gear.internal_circle_radius_m;
    let mut least = f64::INFINITY;
    for angle in hole_angles(gear) {
        let centre = [circle * angle.cos(), circle * angle.sin()];
        // Crossings of a ray from the centre outwards: odd inside.
        let mut inside = false;
        for (i, p) in edge.iter().enumerate() {
            let q = edge[(i + 1) % edge.len()];
            if (p[1] > centre[1]) != (q[1] > centre[1]) {
                let x = p[0] + (centre[1] - p[1]) / (q[1] - p[1]) * (q[0] - p[0]);
                inside ^= x > centre[0];
            }
            // Distance to the chord, because its ends are as far apart as a small hole is wide.
            let [dx, dy] = [q[0] - p[0], q[1] - p[1]];
            let along = (centre[0] - p[0]) * dx + (centre[1] - p[1]) * dy;
            let share = (along / (dx * dx + dy * dy)).clamp(0.0, 1.0);
            let [x, y] = [p[0] + share * dx, p[1] + share * dy];
            least = least.min((x - centre[0]).hypot(y - centre[1]));
        }
        if !inside {
            return -1.0;
        }
    }
    least
}

fn gear(zk: usize, zi: usize, wheels: usize, m: f64, q: f64, circle: f64) -> Gear {
    let radius = 0.1;
    let half_pitch = radius * (PI / zk as f64).sin();
    let mut gear = Gear {
        eccentricity_m: m * radius / zk as f64,
        external_sleeves: zk,
        shortening: m,
        internal_sleeves: zi,
        internal_circle_radius_m: circle * radius,
        wheels,
        ..Scene::paper().gear
    };
    gear.external_sleeve_radius_m = q * half_pitch.min(Profile::of(&gear).smallest_convex_radius());
    gear
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Accepted holes lie inside by brute force, refused ones do not.
    #[test]
    fn holes_agree_with_brute_force(
        zk in 3..25_usize, zi in 3..9_usize, wheels in 1..4_usize,
        m in 0.2..0.95_f64, q in 0.2..0.9_f64, circle in 0.3..1.2_f64, share in 0.7..1.3_f64,
    ) {
        let mut gear = gear(zk, zi, wheels, m, q, circle);
        let room = room(&gear);
        gear.hole_radius_m = share * room.abs().min(0.1);
        let accepted = holes_inside_the_wheel(&gear).is_ok();
        // The chords' error is far below 1e-3 of a hole.
        if room > 0.0 && share < 0.999 {
            prop_assert!(accepted, "room {room}");
        }
        if room < 0.0 || share > 1.001 {
            prop_assert!(!accepted, "room {room}");
        }
    }

    /// No part of an accepted profile is nearer to C than q: it neither folds nor crosses.
    #[test]
    fn accepted_profiles_do_not_cross(zk in 3..30_usize, m in 0.01..0.999_f64, q in 0.01..1.2_f64) {
        let gear = gear(zk, 8, 1, m, q, 0.5);
        let curve = Profile::of(&gear);
        let accepted = external_sleeves(&gear).is_ok() && profile(&gear).is_ok();
        prop_assert_eq!(accepted, q < 1.0);
        let q = gear.external_sleeve_radius_m;
        let nearest = (0..40)
            .map(|i| {
                let a = PI / curve.lobes() * f64::from(i) / 39.0;
                curve.distance(curve.offset_point(a), a, PI, 100 * zk)
            })
            .fold(f64::INFINITY, f64::min);
        if accepted {
            prop_assert!(nearest > q * (1.0 - 1e-6), "{nearest} {q}");
        }
    }
}

/// A hole beyond the circle of the pits is valid behind a lobe, and not behind a pit.
#[test]
fn holes_are_measured_where_they_stand() {
    // Eight lobes, eight holes: those of disc 1 are in the pits' directions.
    let mut gear = gear(9, 8, 1, 0.7, 0.5, 0.6);
    let pit = Profile::of(&gear).pit_radius();
    gear.hole_radius_m = 0.01;
    gear.internal_circle_radius_m = pit - 0.0101;
    assert!(holes_inside_the_wheel(&gear).is_ok());
    gear.internal_circle_radius_m = pit - 0.0099;
    assert!(holes_inside_the_wheel(&gear).is_err());
    // On a curve turned by half a lobe's pitch the same holes would be behind lobes.
    let lobe = Profile::of(&gear);
    let circle = gear.internal_circle_radius_m;
    let at = |angle: f64| {
        lobe.distance(
            [circle * angle.cos(), circle * angle.sin()],
            angle,
            0.7,
            200,
        )
    };
    assert!(at(0.0) > at(PI / 8.0) + 1e-3);
}
