//! Outlines of discs and holes as closed polylines, from the published formula (Eq. 1): the collider engine shares no contact
//! geometry with the native solver.

use std::f64::consts::TAU;

use pinwheel_contact::bisect;
use pinwheel_scene::Gear;
use rapier2d_f64::prelude::{Rotation, Vector};

/// Returns about `count` points of a disc's edge, counter-clockwise, in the disc's frame, m, with equal sagitta of all chords
/// ([`sag_of_corners`]), along each flank of rotated flanks.
pub fn wheel_edge(gear: &Gear, count: usize) -> Vec<Vector> {
    let turn = gear.modification.rotational_rad;
    let pitch = TAU / gear.lobes() as f64;
    let edge_point = edge(gear);
    if turn == 0.0 {
        let lobe = Lobe::new(gear, 0.0, pitch);
        let steps = (count as f64 / gear.lobes() as f64).ceil() as usize;
        let parameters: Vec<f64> = (0..steps)
            .map(|k| lobe.parameter(k as f64 / steps as f64))
            .collect();
        let lobes = (0..gear.lobes()).map(|number| pitch * number as f64);
        return lobes
            .flat_map(|from| {
                parameters.iter().map({
                    let edge = &edge_point;
                    move |a| edge(from + a)
                })
            })
            .collect();
    }
    let half = 0.5 * pitch;
    let polar = |a: f64| {
        let point = edge_point(a);
        point.y.atan2(point.x)
    };
    // From the tip at 0 to the pit: the flank of a disc rotated back by `turn`, up to the middle of tip and pit.
    let at = |angle: f64| bisect([angle - half, angle + half], |a| polar(a) < angle)[1];
    let (tip, pit) = (at(turn), at(half + turn));
    let steps = (count / (2 * gear.lobes())).max(2);
    let back = Rotation::new(-turn);
    let along = Lobe::new(gear, tip, pit);
    let flank: Vec<Vector> = (0..=steps)
        .map(|k| back * edge_point(along.parameter(k as f64 / steps as f64)))
        .collect();
    (0..gear.lobes())
        .flat_map(|lobe| {
            let lobe = Rotation::new(2.0 * half * lobe as f64);
            let up = flank.iter().skip(1).rev().map(|p| Vector::new(p.x, -p.y));
            let down = flank.iter().take(steps).copied();
            let edge: Vec<Vector> = up.chain(down).map(|p| lobe * p).collect();
            edge
        })
        .collect()
}

/// Returns the number of corners of a disc's edge whose chords deviate from it by `sag_m`.
pub fn corners_for_sag(gear: &Gear, sag_m: f64) -> f64 {
    bend_integral(gear) / (8.0 * sag_m).sqrt()
}

/// Returns the sag of the chords between `count` corners of a disc's edge, m: `c^2 |kappa|/8` of a chord c.
pub fn sag_of_corners(gear: &Gear, count: usize) -> f64 {
    (bend_integral(gear) / count as f64).powi(2) / 8.0
}

/// Returns the integral of `sqrt |kappa|` along the edge, m^0.5.
fn bend_integral(gear: &Gear) -> f64 {
    let lobes = gear.lobes() as f64;
    let lobe = Lobe::new(gear, 0.0, TAU / lobes);
    lobes * lobe.weights.last().copied().unwrap_or_default()
}

/// Points on a part of the edge, distributed by `sqrt |kappa|`, from equal steps of the curve parameter.
struct Lobe {
    from: f64,
    step: f64,
    /// Integrals from the start of the part.
    weights: Vec<f64>,
}

/// Steps of a part.
const STEPS: usize = 2000;
/// Least curvature for the distribution, in units of one over the disc's radius: it keeps chords on straight parts short.
const LEAST_CURVATURE: f64 = 3.0;

impl Lobe {
    fn new(gear: &Gear, from: f64, to: f64) -> Self {
        let step = (to - from) / STEPS as f64;
        let edge = edge(gear);
        let point = |k: f64| edge(from + k * step);
        let least = LEAST_CURVATURE / gear.generating_radius_m();
        let mut weights = vec![0.0];
        let mut sum = 0.0;
        for k in 0..STEPS {
            // Circle through three points of the step.
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

    /// Returns the curve parameter up to which this share of the part's weight lies.
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

/// Returns the edge as a function of the curve parameter; only an offset uses the native geometry.
fn edge(gear: &Gear) -> Box<dyn Fn(f64) -> Vector + '_> {
    if gear.modification.normal_m.is_none() {
        return Box::new(|a| formula(gear, a));
    }
    let edge = gear.edge_m();
    Box::new(move |a| Vector::from(edge(a)))
}

/// Returns the edge at the curve parameter `a` by Eq. 1 with the modified radii.
fn formula(gear: &Gear, a: f64) -> Vector {
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

/// Returns `count` points of a circle about `centre`, m; clockwise, so that rapier takes the outside for solid.
pub fn hole_edge(centre: Vector, radius: f64, count: usize) -> Vec<Vector> {
    around(count)
        .map(|a| centre + radius * Vector::new(a.cos(), -a.sin()))
        .collect()
}

/// Returns the segments of a closed polyline over `count` points.
pub fn closed(count: usize) -> Vec<[u32; 2]> {
    let count = count as u32;
    (0..count).map(|i| [i, (i + 1) % count]).collect()
}

fn around(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| TAU * i as f64 / count as f64)
}
