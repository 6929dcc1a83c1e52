//! Outlines of discs and holes as closed polylines, from the published formula alone (Eq. 1):
//! the collider engine shares no contact geometry with the native solver.

use std::f64::consts::TAU;

use pinwheel_scene::Gear;
use rapier2d_f64::prelude::{Rotation, Vector};

/// About `count` points of a disc's edge, counter-clockwise, in the disc's frame, m: all chords miss the edge by as much
/// ([`sag_of_corners`]), along each flank where flanks are turned.
pub(super) fn wheel_edge(gear: &Gear, count: usize) -> Vec<Vector> {
    let turn = gear.modification.rotational_rad;
    let pitch = TAU / gear.lobes() as f64;
    if turn == 0.0 {
        let lobe = Lobe::new(gear, 0.0, pitch);
        let steps = (count as f64 / gear.lobes() as f64).ceil() as usize;
        let parameters: Vec<f64> = (0..steps)
            .map(|k| lobe.parameter(k as f64 / steps as f64))
            .collect();
        let lobes = (0..gear.lobes()).map(|number| pitch * number as f64);
        return lobes
            .flat_map(|from| parameters.iter().map(move |a| edge_point(gear, from + a)))
            .collect();
    }
    let half = 0.5 * pitch;
    let polar = |a: f64| {
        let point = edge_point(gear, a);
        point.y.atan2(point.x)
    };
    // From the tip at 0 to the pit: the flank of a disc turned back by `turn`, up to the middle of tip and pit.
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
    let along = Lobe::new(gear, tip, pit);
    let flank: Vec<Vector> = (0..=steps)
        .map(|k| back * edge_point(gear, along.parameter(k as f64 / steps as f64)))
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

/// Returns the number of corners of a disc's edge whose chords deviate from it by `sag_m`.
pub(super) fn corners_for_sag(gear: &Gear, sag_m: f64) -> f64 {
    whole(gear) / (8.0 * sag_m).sqrt()
}

/// By how much the chords between so many corners miss a disc's edge, m: `c^2 |kappa|/8` of a chord c.
pub(super) fn sag_of_corners(gear: &Gear, count: usize) -> f64 {
    (whole(gear) / count as f64).powi(2) / 8.0
}

/// Integral of `sqrt |kappa|` along the edge, m^0.5.
fn whole(gear: &Gear) -> f64 {
    let lobes = gear.lobes() as f64;
    let lobe = Lobe::new(gear, 0.0, TAU / lobes);
    lobes * lobe.weights.last().copied().unwrap_or_default()
}

/// Places on a stretch of the edge by `sqrt |kappa|`, at the ends of equal steps of the curve parameter.
struct Lobe {
    from: f64,
    step: f64,
    /// Integrals from the stretch's beginning.
    weights: Vec<f64>,
}

/// Steps of a stretch.
const STEPS: usize = 2000;
/// Least curvature that counts, as a share of one over the disc's radius: chords on straight pieces stay short.
const LEAST_CURVATURE: f64 = 3.0;

impl Lobe {
    fn new(gear: &Gear, from: f64, to: f64) -> Self {
        let step = (to - from) / STEPS as f64;
        let point = |k: f64| edge_point(gear, from + k * step);
        let least = LEAST_CURVATURE / gear.generating_radius_m();
        let mut weights = vec![0.0];
        let mut sum = 0.0;
        for k in 0..STEPS {
            // A circle through three points of the step.
            let k = k as f64;
            let [a, b, c] = [k, k + 0.5, k + 1.0].map(point);
            let (ab, bc, ac) = (b - a, c - b, c - a);
            let sides = ab.length() * bc.length() * ac.length();
            let curvature = (2.0 * ab.perp_dot(ac) / sides).abs().max(least);
            sum += curvature.sqrt() * ac.length();
            weights.push(sum);
        }
        Self {
            from,
            step,
            weights,
        }
    }

    /// The curve parameter up to which this share of the stretch's weight lies.
    fn parameter(&self, share: f64) -> f64 {
        let wanted = share * self.weights[STEPS];
        let after = self
            .weights
            .partition_point(|w| *w < wanted)
            .clamp(1, STEPS);
        let (low, high) = (self.weights[after - 1], self.weights[after]);
        let part = ((wanted - low) / (high - low)).clamp(0.0, 1.0);
        self.from + self.step * (after as f64 - 1.0 + part)
    }
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

    /// Without its eight holes of 8.8 mm the paper's disc covers 8710.1 mm^2
    /// (reference/scenes/paper-geometric.toml).
    #[test]
    fn wheel_edge_encloses_the_known_area_counter_clockwise() {
        let holes = 8.0 * std::f64::consts::PI * 0.0088_f64.powi(2);
        let area = area(&wheel_edge(&Scene::paper().gear, 40_000)) - holes;
        assert!((area - 8710.1e-6).abs() < 0.05e-6, "{area}");
    }

    /// Against the disc turned to either side: every point of the common edge lies on one and within the other.
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
