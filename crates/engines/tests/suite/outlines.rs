//! Edges of discs and holes.

use pinwheel_engines::rapier::outlines::*;
use pinwheel_scene::Scene;
use rapier2d_f64::prelude::{Rotation, Vector};

fn area(points: &[Vector]) -> f64 {
    closed(points.len())
        .iter()
        .map(|&[a, b]| 0.5 * points[a as usize].perp_dot(points[b as usize]))
        .sum()
}

/// Without its eight holes of 8.8 mm the paper's disc covers 8710.1 mm^2
/// (reference/scenes/paper-geometric.toml).
#[test]
fn wheel_edge_encloses_the_known_area_counter_clockwise() {
    let holes = 8.0 * std::f64::consts::PI * 0.0088_f64.powi(2);
    let area = area(&wheel_edge(&Scene::paper().gear, 40_000)) - holes;
    assert!((area - 8710.1e-6).abs() < 0.05e-6, "{area}");
}

/// Against the disc rotated to either side: every point of the common edge is on one and inside the other.
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
    // Two flanks per lobe, each lower by turn times the radius over a height of 2 e, twice.
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
