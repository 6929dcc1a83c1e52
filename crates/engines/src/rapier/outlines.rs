//! Outlines of wheels and holes as closed polylines, from the published formula alone (Eq. 1):
//! the collider engine shares no contact geometry with the native solver.

use std::f64::consts::TAU;

use pinwheel_gearbox::scene::Gear;
use rapier2d_f64::prelude::Vector;

/// `count` points of a wheel's edge at equal steps of the curve parameter, counter-clockwise, in
/// the wheel's frame, m.
pub(super) fn wheel_edge(gear: &Gear, count: usize) -> Vec<Vector> {
    let (radius, e, q) =
        (gear.pitch_radius_m(), gear.eccentricity_m, gear.external_sleeve_radius_m);
    let (zk, zs) = (gear.external_sleeves as f64, gear.lobes() as f64);
    around(count)
        .map(|a| {
            let gamma = (zs * a).sin().atan2(1.0 / gear.shortening + (zs * a).cos());
            Vector::new(
                radius * a.cos() + e * (zk * a).cos() - q * (a + gamma).cos(),
                radius * a.sin() + e * (zk * a).sin() - q * (a + gamma).sin(),
            )
        })
        .collect()
}

/// `count` points of a circle about `centre`, m; clockwise, so that rapier takes the outside for
/// solid.
pub(super) fn hole_edge(centre: Vector, radius: f64, count: usize) -> Vec<Vector> {
    around(count).map(|a| centre + radius * Vector::new(a.cos(), -a.sin())).collect()
}

/// The segments of a closed polyline over `count` points.
pub(super) fn closed(count: usize) -> Vec<[u32; 2]> {
    let count = count as u32;
    (0..count).map(|i| [i, (i + 1) % count]).collect()
}

fn around(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| TAU * i as f64 / count as f64)
}
