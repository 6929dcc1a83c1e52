//! Outlines of wheels and holes as closed polylines, from the published formula alone (Eq. 1):
//! the collider engine shares no contact geometry with the native solver.

use std::f64::consts::TAU;

use pinwheel_scene::Gear;
use rapier2d_f64::prelude::Vector;

/// `count` points of a wheel's edge at equal steps of the curve parameter, counter-clockwise, in
/// the wheel's frame, m.
pub(super) fn wheel_edge(gear: &Gear, count: usize) -> Vec<Vector> {
    let (radius, e, q) = (
        gear.pitch_radius_m(),
        gear.eccentricity_m,
        gear.external_sleeve_radius_m,
    );
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
    around(count)
        .map(|a| centre + radius * Vector::new(a.cos(), -a.sin()))
        .collect()
}

/// The segments of a closed polyline over `count` points.
pub(super) fn closed(count: usize) -> Vec<[u32; 2]> {
    let count = count as u32;
    (0..count).map(|i| [i, (i + 1) % count]).collect()
}

fn around(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| TAU * i as f64 / count as f64)
}

#[cfg(test)]
mod tests {
    use pinwheel_scene::Scene;

    use super::*;

    fn area(points: &[Vector]) -> f64 {
        closed(points.len())
            .iter()
            .map(|&[a, b]| 0.5 * points[a as usize].perp_dot(points[b as usize]))
            .sum()
    }

    /// Without its eight holes of 8.8 mm the paper's wheel covers 8710.1 mm^2
    /// (reference/scenes/paper-geometric.toml).
    #[test]
    fn wheel_edge_encloses_the_known_area_counter_clockwise() {
        let holes = 8.0 * std::f64::consts::PI * 0.0088_f64.powi(2);
        let area = area(&wheel_edge(&Scene::paper().gear, 40_000)) - holes;
        assert!((area - 8710.1e-6).abs() < 0.05e-6, "{area}");
    }

    #[test]
    fn hole_edge_runs_clockwise_about_its_centre() {
        let centre = Vector::new(0.03, -0.01);
        let points = hole_edge(centre, 0.0088, 400);
        assert!(
            points
                .iter()
                .all(|point| ((*point - centre).length() - 0.0088).abs() < 1e-15)
        );
        let circle = std::f64::consts::PI * 0.0088_f64.powi(2);
        assert!((area(&points) + circle).abs() < 1e-4 * circle);
    }
}
