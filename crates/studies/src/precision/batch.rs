//! Gears a second and core: what a sweep or a sample of a scene costs, where every gear is read, built and run once.
//!
//! The gears are the scene with its contacts' stiffness and its load changed by a few per cent, each pair of values once
//! (Kronecker's sequence). Every adaptive method that is asked for runs each of them at the loosest tolerance of its ladder that
//! brings the scene itself within the target, one gear after the other and all methods in turn, so that other programs disturb
//! them alike. Times are medians of one thread's CPU time.

use std::io::Write;

use pinwheel_gearbox::resolve::{Budget, run_resolved};
use pinwheel_gearbox::{Distance, Gearbox, auto};
use pinwheel_mbs::integrators::METHODS;
use pinwheel_scene::{Override, Scene};
use serde::Serialize;

use super::ladder::{Knob, settings};
use super::series::median;
use super::{Options, StudyError};
use crate::control::{Control, Ended, Progress, compile, of_scene, run_compiled};

/// What a method gives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Throughput {
    /// Method.
    pub method: String,
    /// Its tolerance.
    pub tolerance: f64,
    /// Relative L2 error of the scene's own forces at this tolerance.
    pub force_l2: f64,
    /// Median of reading, checking and building a gear, s.
    pub set_up_s: f64,
    /// Median of a run, s.
    pub run_s: f64,
    /// Median of the right-hand sides of a run.
    pub rhs_calls: f64,
    /// Gears a second on one core: 1/(`set_up_s` + `run_s`).
    pub gears_per_s: f64,
}

impl Throughput {
    /// Set-up as a share of a run.
    #[must_use]
    pub fn set_up_share(&self) -> f64 {
        self.set_up_s / self.run_s
    }
}

/// The study's result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Batch {
    /// Gears of each method.
    pub gears: usize,
    /// Relative L2 force error asked for.
    pub target: f64,
    /// The quickest first; methods that do not reach the target are missing.
    pub methods: Vec<Throughput>,
}

/// Gears of a method.
const GEARS: usize = 24;
/// Largest change of stiffness and load, relative.
const SPREAD: f64 = 0.05;
/// Share of the target that the reference may be off.
const REFERENCE: f64 = 0.03;

/// Measures the methods of `options`, or what `auto` takes and Dormand-Prince beside it.
///
/// # Errors
/// Cancelled, or a reference that is not resolved.
pub fn run(scene: &Scene, options: &Options, control: &Control<'_>) -> Result<Batch, StudyError> {
    let target = options.target;
    let announce =
        |done: usize, what: &str| (control.progress)(Progress::new(done, GEARS + 1, what));
    announce(0, "batch: reference");
    let own = compile(scene)?;
    let mut found = Vec::new();
    let promise = REFERENCE * target;
    let mut watch = |_| control.is_cancelled();
    let truth = match run_resolved(&own, promise, Budget::default(), &mut watch) {
        Ok((run, known)) if known.is_resolved() => run.courses,
        Ok((_, known)) => return Err(unresolved(scene, known.sentence())),
        Err(pinwheel_gearbox::native::NativeError::Stopped) => return Err(StudyError::Cancelled),
        Err(error) => return Err(unresolved(scene, error.to_string())),
    };
    for method in methods(scene, options) {
        for tolerance in settings(Knob::Tolerance, scene) {
            let gearbox = with(&own, method, tolerance)?;
            if let Ended::Whole(run) = run_compiled(&gearbox, &mut watch)? {
                let force_l2 = Distance::between(&own, &run.courses, &truth).forces;
                if force_l2 <= target {
                    found.push((method, tolerance, force_l2, Vec::new()));
                    break;
                }
            }
        }
    }
    let text = scene.to_toml();
    for k in 0..GEARS {
        announce(k + 1, "batch: gears");
        for (method, tolerance, _, times) in &mut found {
            let began = cpu_time::ThreadTime::now();
            let checked =
                Scene::from_toml(&text, &scene.name, &changes(scene, k, method, *tolerance));
            let gearbox = Gearbox::after(Some(&own), &checked?);
            let gearbox = gearbox.map_err(|source| of_scene(scene, source))?;
            let set_up_s = began.elapsed().as_secs_f64();
            if let Ended::Whole(run) = run_compiled(&gearbox, &mut watch)? {
                let whole_s = began.elapsed().as_secs_f64();
                times.push([set_up_s, whole_s - set_up_s, run.counts.evaluations as f64]);
            }
        }
    }
    let middle = |times: &[[f64; 3]], k: usize| {
        let mut values: Vec<f64> = times.iter().map(|each| each[k]).collect();
        values.sort_by(f64::total_cmp);
        median(&values)
    };
    let mut methods: Vec<Throughput> = found
        .into_iter()
        .filter(|(.., times)| !times.is_empty())
        .map(|(method, tolerance, force_l2, times)| {
            let [set_up_s, run_s, rhs_calls] = [0, 1, 2].map(|k| middle(&times, k));
            Throughput {
                method: method.to_owned(),
                tolerance,
                force_l2,
                set_up_s,
                run_s,
                rhs_calls,
                gears_per_s: (set_up_s + run_s).recip(),
            }
        })
        .collect();
    methods.sort_by(|a, b| b.gears_per_s.total_cmp(&a.gears_per_s));
    Ok(Batch {
        gears: GEARS,
        target,
        methods,
    })
}

fn unresolved(scene: &Scene, reason: String) -> StudyError {
    StudyError::Reference {
        scene: scene.name.clone(),
        reason,
    }
}

fn methods(scene: &Scene, options: &Options) -> Vec<&'static str> {
    let planned = auto::plan(scene, options.target).integrator;
    let asked = |name: &str| match options.methods.as_slice() {
        [] => [planned, "dopri5"].contains(&name),
        names => names.iter().any(|asked| asked == name),
    };
    let adaptive = METHODS.iter().filter(|m| m.adaptive && asked(m.name));
    adaptive.map(|m| m.name).collect()
}

fn with(gearbox: &Gearbox, method: &str, tolerance: f64) -> Result<Gearbox, StudyError> {
    let set = gearbox.with_solver(|solver| {
        method.clone_into(&mut solver.integrator);
        solver.tolerance = tolerance;
    });
    set.map_err(|fault| of_scene(&gearbox.scene, fault.into()))
}

/// What makes gear `k` of the scene.
fn changes(scene: &Scene, k: usize, method: &str, tolerance: f64) -> Vec<Override> {
    // Powers of the plastic number: the sequence that spreads most evenly in two dimensions.
    let change = |step: f64| 1.0 + SPREAD * (2.0 * (step * (k + 1) as f64).fract() - 1.0);
    let stiffness = scene.contact.stiffness_multiplier * change(0.754_877_666_246_692_7);
    let load = scene.drive.output_torque_n_m * change(0.569_840_290_998_053_2);
    vec![
        Override::new("contact.stiffness_multiplier", stiffness.to_string()),
        Override::new("drive.output_torque_n_m", load.to_string()),
        Override::new("solver.integrator", format!("\"{method}\"")),
        Override::new("solver.tolerance", tolerance.to_string()),
    ]
}

/// Writes all methods as CSV with a header row.
///
/// # Errors
/// The sink's.
pub fn write_csv(found: &Batch, sink: impl Write) -> Result<(), StudyError> {
    let mut csv = csv::Writer::from_writer(sink);
    for method in &found.methods {
        csv.serialize(method)?;
    }
    csv.flush().map_err(csv::Error::from)?;
    Ok(())
}
