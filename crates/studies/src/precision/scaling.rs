//! What one evaluation of the contact forces, and one whole run, cost against the gear's size.
//!
//! Gears are scaled from the paper's: the pitch radius grows with the number of sleeves, so that the teeth keep
//! their shape and size, and the holes move outwards with it. Loads and inertias
//! grow with the gear, so that every contact carries about the paper's force. Every gear takes the same number of
//! steps of the paper's length by the paper's method (rk2), so that cost is time, not accuracy.

use std::io::Write;

use pinwheel_scene::{BodyMass, Detection, Formulation, Scene};
use serde::Serialize;

use super::front::power_law;
use crate::StudyError;
use crate::control::{Control, Progress};

/// One gear, or one number of points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Size {
    /// Wheels.
    pub wheels: usize,
    /// zk.
    pub external_sleeves: usize,
    /// zi.
    pub internal_sleeves: usize,
    /// Wheels times sleeves of both kinds.
    pub pairs: usize,
    /// Points on a wheel; `None` with exact detection.
    pub points: Option<usize>,
    /// Formulation.
    pub formulation: Formulation,
    /// Least CPU time of a run, s.
    pub cpu_min_s: f64,
    /// Median of the runs, s.
    pub cpu_median_s: f64,
    /// Right-hand-side calls of the run.
    pub rhs_calls: u64,
    /// `cpu_min_s` a right-hand-side call, s, samples and energy account included.
    pub per_call_s: f64,
}

/// A fit `cost = factor size^exponent`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fit {
    /// 1: linear; 0: no dependence.
    pub exponent: f64,
    /// Cost of size 1, s.
    pub factor_s: f64,
}

/// Cost against size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scaling {
    /// Gears of growing size, reduced form.
    pub reduced: Vec<Size>,
    /// The same in the Lagrange form.
    pub lagrange: Vec<Size>,
    /// The paper's gear with discrete points on wheel and holes.
    pub points: Vec<Size>,
    /// Cost of a call against pairs, reduced form; over the gears of more than 100 pairs.
    pub reduced_fit: Option<Fit>,
    /// Cost of a call against pairs, Lagrange form.
    pub lagrange_fit: Option<Fit>,
    /// Cost of a call against points.
    pub points_fit: Option<Fit>,
}

/// Simulated time of each run, s: 2000 steps of 1e-5 s.
const DURATION_S: f64 = 0.02;
const REPEATS: usize = 5;

/// Gears: wheels, external and internal sleeves.
const GEARS: [(usize, usize, usize); 11] = [
    (1, 12, 6),
    (1, 16, 8),
    (2, 16, 8),
    (1, 40, 12),
    (2, 40, 12),
    (3, 40, 12),
    (2, 80, 20),
    (4, 80, 20),
    (2, 200, 40),
    (3, 200, 40),
    (4, 200, 40),
];
/// Points on a wheel; a hole has a fortieth.
const POINTS: [usize; 5] = [600, 1200, 4000, 12_000, 40_000];
/// Gears above this many pairs are fitted: below, what does not depend on the size still shows.
const FITTED: usize = 100;

/// Measures everything.
///
/// # Errors
/// Cancelled, or a gear that cannot be run.
pub fn run(control: &Control<'_>) -> Result<Scaling, StudyError> {
    let total = 2 * GEARS.len() + POINTS.len();
    let mut done = 0;
    let mut measure = |scene: &Scene| {
        (control.progress)(Progress::new(done, total, &scene.name));
        done += 1;
        size(scene, control)
    };
    let (mut reduced, mut lagrange, mut points) = (Vec::new(), Vec::new(), Vec::new());
    for (wheels, external, internal) in GEARS {
        let mut scene = gear(wheels, external, internal);
        reduced.push(measure(&scene)?);
        scene.solver.formulation = Formulation::Lagrange;
        lagrange.push(measure(&scene)?);
    }
    for count in POINTS {
        let mut scene = gear(2, 16, 8);
        scene.name = format!("scaling: {count} points");
        scene.contact.detection = Detection::Points;
        scene.contact.wheel_points = count;
        scene.contact.hole_points = (count / 40).max(20);
        points.push(measure(&scene)?);
    }
    let per_pair = |sizes: &[Size]| {
        let large = sizes.iter().filter(|s| s.pairs > FITTED);
        fit(large.map(|s| (s.pairs as f64, s.per_call_s)))
    };
    let per_point = points
        .iter()
        .filter_map(|s| Some((s.points? as f64, s.per_call_s)));
    Ok(Scaling {
        reduced_fit: per_pair(&reduced),
        lagrange_fit: per_pair(&lagrange),
        points_fit: fit(per_point),
        reduced,
        lagrange,
        points,
    })
}

fn fit(points: impl Iterator<Item = (f64, f64)>) -> Option<Fit> {
    let points: Vec<(f64, f64)> = points.collect();
    power_law(&points).map(|(exponent, factor_s)| Fit { exponent, factor_s })
}

fn size(scene: &Scene, control: &Control<'_>) -> Result<Size, StudyError> {
    let mut times = Vec::new();
    let mut rhs_calls = 0;
    for _ in 0..REPEATS {
        let started = cpu_time::ThreadTime::now();
        let run = control.complete(scene)?;
        times.push(started.elapsed().as_secs_f64());
        rhs_calls = run.counts.evaluations;
    }
    times.sort_by(f64::total_cmp);
    let gear = &scene.gear;
    let points =
        (scene.contact.detection == Detection::Points).then_some(scene.contact.wheel_points);
    Ok(Size {
        wheels: gear.wheels,
        external_sleeves: gear.external_sleeves,
        internal_sleeves: gear.internal_sleeves,
        pairs: gear.wheels * (gear.external_sleeves + gear.internal_sleeves),
        points,
        formulation: scene.solver.formulation,
        cpu_min_s: times[0],
        cpu_median_s: super::series::median(&times),
        rhs_calls,
        per_call_s: times[0] / rhs_calls.max(1) as f64,
    })
}

/// Writes all sizes as CSV with a header row.
///
/// # Errors
/// The sink's.
pub fn write_csv(scaling: &Scaling, sink: impl Write) -> Result<(), StudyError> {
    let mut csv = csv::Writer::from_writer(sink);
    for size in scaling
        .reduced
        .iter()
        .chain(&scaling.lagrange)
        .chain(&scaling.points)
    {
        csv.serialize(size)?;
    }
    csv.flush().map_err(csv::Error::from)?;
    Ok(())
}

/// The paper's gear with other numbers of sleeves and wheels.
#[must_use]
pub fn gear(wheels: usize, external: usize, internal: usize) -> Scene {
    let mut scene = Scene {
        name: format!("scaling: {wheels} wheels, {external} + {internal} sleeves"),
        ..Scene::paper()
    };
    // R = e zk/m grows with zk: same teeth on a larger circle.
    let growth = external as f64 / scene.gear.external_sleeves as f64;
    let gear = &mut scene.gear;
    (gear.wheels, gear.external_sleeves, gear.internal_sleeves) = (wheels, external, internal);
    gear.internal_circle_radius_m *= growth;
    let heavier = |body: &mut BodyMass| {
        body.mass_kg *= growth * growth;
        body.moment_kg_m2 *= growth.powi(4);
    };
    heavier(&mut scene.mass.wheel);
    heavier(&mut scene.mass.output_shaft);
    // Force a sleeve: 4 T/(e zs zk) a wheel.
    scene.drive.output_torque_n_m *= growth * growth * wheels as f64 / 2.0;
    scene.solver.duration_s = DURATION_S;
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_gears_can_be_built() {
        for (wheels, external, internal) in GEARS {
            let scene = gear(wheels, external, internal);
            let read = Scene::from_toml(&scene.to_toml(), "a gear", &[]);
            assert_eq!(*read.unwrap(), scene);
            pinwheel_gearbox::Gearbox::new(&scene.clone().check().unwrap()).unwrap();
        }
    }
}
