//! Outlines of wheels and holes as closed polylines, from the published formula alone (Eq. 1):
//! the collider engine shares no contact geometry with the native solver.

use std::f64::consts::TAU;

use pinwheel_scene::Gear;
use rapier2d_f64::prelude::{Rotation, Vector};

/// About `count` points of a wheel's edge, counter-clockwise, in the wheel's frame, m: at equal steps of the curve
/// parameter, and where flanks are turned at equal steps of it along each flank.
pub(super) fn wheel_edge(gear: &Gear, count: usize) -> Vec<Vector> {
    let turn = gear.modification.rotational_rad;
    if turn == 0.0 {
        return around(count).map(|a| edge_point(gear, a)).collect();
    }
    let half = std::f64::consts::PI / gear.lobes() as f64;
    let polar = |a: f64| {
        let point = edge_point(gear, a);
        point.y.atan2(point.x)
    };
    // From the tip at 0 to the pit: the flank of a wheel turned back by `turn`, up to the middle of tip and pit.
    let at = |angle: f64| {
        let (mut low, mut high) = (angle - half, angle + half);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if polar(middle) < angle {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    };
    let (tip, pit) = (at(turn), at(half + turn));
    let steps = (count / (2 * gear.lobes())).max(2);
    let back = Rotation::new(-turn);
    let flank: Vec<Vector> = (0..=steps)
        .map(|k| back * edge_point(gear, tip + (pit - tip) * k as f64 / steps as f64))
        .collect();
    (0..gear.lobes())
        .flat_map(|lobe| {
            let lobe = Rotation::new(2.0 * half * lobe as f64);
            let up = flank.iter().skip(1).rev().map(|p| Vector::new(p.x, -p.y));
            let down = flank.iter().take(steps).copied();
            let whole: Vec<Vector> = up.chain(down).map(|p| lobe * p).collect();
            whole
        })
        .collect()
}

/// Eq. 1 with the modified radii: the edge at the curve parameter `a`.
fn edge_point(gear: &Gear, a: f64) -> Vector {
    let (radius, e, q) = (
        gear.generating_radius_m(),
        gear.eccentricity_m,
        gear.edge_offset_m(),
    );
    let (zk, zs) = (gear.external_sleeves as f64, gear.lobes() as f64);
    let gamma = (zs * a)
        .sin()
        .atan2(1.0 / gear.generating_shortening() + (zs * a).cos());
    Vector::new(
        radius * a.cos() + e * (zk * a).cos() - q * (a + gamma).cos(),
        radius * a.sin() + e * (zk * a).sin() - q * (a + gamma).sin(),
    )
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

    /// Against the wheel turned to either side: every point of the common edge lies on one and within the other.
    #[test]
    fn turned_flanks_bound_what_both_wheels_have_in_common() {
        let mut gear = Scene::paper().gear;
        let plain = area(&wheel_edge(&gear, 40_000));
        gear.modification.rotational_rad = 1e-3;
        let edge = wheel_edge(&gear, 6_000);
        gear.modification.rotational_rad = 0.0;
        let fine = wheel_edge(&gear, 60_000);
        for point in edge.iter().step_by(13) {
            let radius_at = |turn: f64| {
                let turned = Rotation::new(-turn) * *point;
                let near = |p: &&Vector| p.perp_dot(turned).abs() / p.dot(turned);
                let nearest = fine.iter().filter(|p| p.dot(turned) > 0.0);
                nearest
                    .min_by(|a, b| near(a).total_cmp(&near(b)))
                    .unwrap()
                    .length()
            };
            let least = radius_at(1e-3).min(radius_at(-1e-3));
            assert!((point.length() - least).abs() < 1e-5, "{point} {least}");
        }
        // Two flanks a lobe, each lower by turn times the radius over a height of 2 e, twice.
        let lost = plain - area(&edge);
        let wanted = 15.0 * 1e-3 * ((0.0608_f64).powi(2) - (0.0552_f64).powi(2));
        assert!((lost / wanted - 1.0).abs() < 0.01, "{lost} {wanted}");
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
