//! Speed against error on mechanisms whose solutions others published: no gear, no contact, all smooth.
//!
//! The pendulum (A01), two and forty four-bars through their singular pose (A02), and Andrews' squeezer, in
//! the Lagrange form with projection. The error is the largest deviation of the published coordinates
//! (m or rad, all of order 1) at the published times; `reference/published/` holds the values and their
//! sources.

use std::io::Write;
use std::sync::atomic::Ordering;

use pinwheel_mbs::Stabilisation;
use pinwheel_mbs::benchmarks::{Problem, andrews, four_bars, pendulum};
use pinwheel_mbs::integrators::{METHODS, MethodInfo, StepSettings};
use serde::{Deserialize, Serialize};

use super::Knob;
use crate::StudyError;
use crate::control::{Control, Progress};

/// One setting on one mechanism.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Solve {
    /// Step (s) or tolerance.
    pub setting: f64,
    /// Largest deviation from the published solution, m or rad; `None` if the run failed.
    pub error: Option<f64>,
    /// Largest joint error, m.
    pub joint_error_m: f64,
    /// Least CPU time of the runs, s.
    pub cpu_min_s: f64,
    /// Their median, s.
    pub cpu_median_s: f64,
    /// How many there were.
    pub runs: usize,
    /// Right-hand-side calls.
    pub rhs_calls: u64,
    /// Accepted steps.
    pub steps: u64,
    /// Why it failed.
    pub failure: Option<String>,
}

/// One method on one mechanism.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodSolves {
    /// Integrator.
    pub method: String,
    /// Classical order.
    pub order: u32,
    /// What is turned.
    pub knob: Knob,
    /// Settings, coarse to fine.
    pub points: Vec<Solve>,
}

impl MethodSolves {
    /// (cost, error) of the finished points; cost is CPU seconds or right-hand-side calls.
    #[must_use]
    pub fn points(&self, measure: super::Measure) -> Vec<(f64, f64)> {
        let cost = |p: &Solve| match measure {
            super::Measure::Cpu => p.cpu_min_s,
            super::Measure::Rhs => p.rhs_calls as f64,
        };
        self.points
            .iter()
            .filter_map(|p| Some((cost(p), p.error?)))
            .collect()
    }
}

/// All methods on one mechanism.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MechanismStudy {
    /// Name.
    pub name: String,
    /// Bodies.
    pub bodies: usize,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Where the solution comes from.
    pub source: String,
    /// One a method.
    pub series: Vec<MethodSolves>,
}

/// Published values at their times.
struct Published {
    problem: Problem,
    source: String,
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
    /// Coarsest fixed step, s.
    step: f64,
}

/// Halvings of the coarsest step, and tolerances by decades from 1e-3.
const HALVINGS: i32 = 12;
const DECADES: i32 = 10;
/// A run may take this long, s CPU; mechanisms of many bodies get more.
const LONGEST_S: f64 = 0.12;
const LONGEST_BIG_S: f64 = 0.3;
const BIG: usize = 20;
/// A run is given up after this many times that. Where rounding alone exceeds the tolerance, as beside A02's singular
/// pose, steps shrink without end.
const PATIENCE: f64 = 4.0;
/// A setting is repeated until its runs took this long together, but at least twice and at most seven times.
const REPEAT_S: f64 = 0.05;
const FEWEST: usize = 2;
const MOST: usize = 7;
/// Where all published digits are reached.
const ROUNDING: f64 = 1e-13;

/// Runs all methods on all mechanisms. What was measured when the user stops the study is kept.
///
/// # Errors
/// The embedded reference values cannot be read (never in a released build).
pub fn run(control: &Control<'_>) -> Result<Vec<MechanismStudy>, StudyError> {
    let all = published()?;
    let total = all.len() * METHODS.len();
    let mut done = 0;
    let mut studies = Vec::new();
    for published in &all {
        let mut series = Vec::new();
        for method in METHODS {
            if control.cancel.load(Ordering::Relaxed) {
                break;
            }
            (control.progress)(Progress::new(
                done,
                total,
                &format!("{}, {}", published.problem.name, method.name),
            ));
            series.push(solves(published, method, control));
            done += 1;
        }
        studies.push(MechanismStudy {
            name: published.problem.name.clone(),
            bodies: published.problem.mechanism.bodies.len(),
            duration_s: published.times.last().copied().unwrap_or(0.0),
            source: published.source.clone(),
            series,
        });
    }
    Ok(studies)
}

/// One setting as a line of a table.
#[derive(Serialize)]
struct Row<'a> {
    mechanism: &'a str,
    method: &'a str,
    order: u32,
    step_s: Option<f64>,
    tolerance: Option<f64>,
    error: Option<f64>,
    joint_error_m: f64,
    cpu_min_s: f64,
    cpu_median_s: f64,
    runs: usize,
    rhs_calls: u64,
    steps: u64,
    failure: Option<&'a str>,
}

/// Writes all points as CSV with a header row.
///
/// # Errors
/// The sink's.
pub fn write_csv(studies: &[MechanismStudy], sink: impl Write) -> Result<(), StudyError> {
    let mut csv = csv::Writer::from_writer(sink);
    for study in studies {
        for series in &study.series {
            for point in &series.points {
                let of = |knob: Knob| (series.knob == knob).then_some(point.setting);
                csv.serialize(Row {
                    mechanism: &study.name,
                    method: &series.method,
                    order: series.order,
                    step_s: of(Knob::StepS),
                    tolerance: of(Knob::Tolerance),
                    error: point.error,
                    joint_error_m: point.joint_error_m,
                    cpu_min_s: point.cpu_min_s,
                    cpu_median_s: point.cpu_median_s,
                    runs: point.runs,
                    rhs_calls: point.rhs_calls,
                    steps: point.steps,
                    failure: point.failure.as_deref(),
                })?;
            }
        }
    }
    csv.flush().map_err(csv::Error::from)?;
    Ok(())
}

fn solves(published: &Published, method: &MethodInfo, control: &Control<'_>) -> MethodSolves {
    let knob = Knob::of(method.name);
    let settings: Vec<f64> = match knob {
        Knob::StepS => (0..=HALVINGS)
            .map(|k| published.step / 2.0_f64.powi(k))
            .collect(),
        Knob::Tolerance => (0..=DECADES).map(|k| 10.0_f64.powi(-3 - k)).collect(),
    };
    let mut points: Vec<Solve> = Vec::new();
    for (k, &setting) in settings.iter().enumerate() {
        if control.cancel.load(Ordering::Relaxed) {
            break;
        }
        if let Some(last) = points.last() {
            let finer = match knob {
                Knob::StepS => 2.0,
                Knob::Tolerance => (settings[k - 1] / setting).powf(1.0 / f64::from(method.order)),
            };
            let there = last.error.is_some_and(|error| error < ROUNDING);
            let given_up = last.error.is_none() && last.cpu_min_s > published.longest_s();
            if there || given_up || last.cpu_min_s * finer > published.longest_s() {
                break;
            }
        }
        points.push(solve(published, method.name, setting, control));
    }
    MethodSolves {
        method: method.name.to_owned(),
        order: method.order,
        knob,
        points,
    }
}

impl Published {
    fn longest_s(&self) -> f64 {
        if self.problem.mechanism.bodies.len() > BIG {
            LONGEST_BIG_S
        } else {
            LONGEST_S
        }
    }
}

fn solve(published: &Published, method: &str, setting: f64, control: &Control<'_>) -> Solve {
    let knob = Knob::of(method);
    let settings = StepSettings {
        step: match knob {
            Knob::StepS => setting,
            Knob::Tolerance => published.step,
        },
        tolerance: setting,
    };
    let mut times = Vec::new();
    let outcome = loop {
        let started = cpu_time::ThreadTime::now();
        let outcome = published.problem.solve_watched(
            Stabilisation::Projection,
            method,
            settings,
            &published.times,
            &mut |_| {
                control.cancel.load(Ordering::Relaxed)
                    || started.elapsed().as_secs_f64() > PATIENCE * published.longest_s()
            },
        );
        times.push(started.elapsed().as_secs_f64());
        let spent: f64 = times.iter().sum();
        let enough = times.len() >= FEWEST && spent >= REPEAT_S;
        if outcome.is_err() || enough || times.len() >= MOST {
            break outcome;
        }
    };
    times.sort_by(f64::total_cmp);
    let mut found = Solve {
        setting,
        error: None,
        joint_error_m: f64::NAN,
        cpu_min_s: times[0],
        cpu_median_s: super::series::median(&times),
        runs: times.len(),
        rhs_calls: 0,
        steps: 0,
        failure: None,
    };
    match outcome {
        Err(error) => found.failure = Some(error.to_string()),
        Ok(solved) => {
            let error = deviation(&solved.values, &published.values);
            found.error = error.is_finite().then_some(error);
            found.failure = (!error.is_finite()).then(|| "not finite".to_owned());
            found.joint_error_m = solved.joint_error;
            found.rhs_calls = solved.counts.evaluations;
            found.steps = solved.counts.steps;
        }
    }
    found
}

/// Largest difference from the published values, of which a row may hold fewer than were read out.
fn deviation(found: &[Vec<f64>], published: &[Vec<f64>]) -> f64 {
    let rows = found.iter().zip(published);
    rows.flat_map(|(a, b)| a.iter().zip(b))
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, |worst, d| if d <= worst { worst } else { d })
}

macro_rules! published_text {
    ($name:literal) => {
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../reference/published/",
            $name,
            ".toml"
        ))
    };
}

#[derive(Deserialize)]
struct PendulumFile {
    source: String,
    point: Vec<PointAt>,
}

#[derive(Deserialize)]
struct PointAt {
    time_s: f64,
    value: Vec<f64>,
}

#[derive(Deserialize)]
struct FourBarsFile {
    source: String,
    case: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    loops: usize,
    time_s: f64,
    value: Vec<f64>,
}

#[derive(Deserialize)]
struct AndrewsFile {
    source: String,
    time_s: f64,
    q: Vec<f64>,
}

fn published() -> Result<Vec<Published>, StudyError> {
    let swing: PendulumFile = read(published_text!("pendulum"))?;
    let bars: FourBarsFile = read(published_text!("four-bars"))?;
    let squeezer: AndrewsFile = read(published_text!("andrews"))?;
    let mut all = vec![Published {
        problem: pendulum(),
        source: swing.source,
        times: swing.point.iter().map(|p| p.time_s).collect(),
        values: swing.point.into_iter().map(|p| p.value).collect(),
        step: 0.032,
    }];
    for case in bars.case {
        all.push(Published {
            problem: four_bars(case.loops),
            source: bars.source.clone(),
            times: vec![case.time_s],
            values: vec![case.value],
            step: 0.032,
        });
    }
    all.push(Published {
        problem: andrews(),
        source: squeezer.source,
        times: vec![squeezer.time_s],
        values: vec![squeezer.q],
        step: 1.6e-4,
    });
    Ok(all)
}

fn read<T: for<'a> Deserialize<'a>>(text: &str) -> Result<T, StudyError> {
    toml::from_str(text).map_err(|error| StudyError::Published(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The errors of every method fall at its order, or with its tolerance, on the pendulum.
    #[test]
    fn errors_fall_at_the_methods_order() {
        let all = published().unwrap();
        for method in METHODS {
            let error = |setting: f64| {
                solve(&all[0], method.name, setting, &Control::quiet())
                    .error
                    .unwrap()
            };
            match Knob::of(method.name) {
                Knob::StepS => {
                    let observed = (error(4e-3) / error(2e-3)).log2();
                    let order = f64::from(method.order);
                    // Measured 2.00 to 2.08 and 4.3 to 5.0 (the leading error of rk4 nearly vanishes here).
                    assert!(
                        (order - 0.3..order + 1.3).contains(&observed),
                        "{}: {observed:.2}",
                        method.name
                    );
                }
                Knob::Tolerance => {
                    let (loose, tight) = (error(1e-4), error(1e-6));
                    assert!(tight < 0.1 * loose, "{}: {loose:e} {tight:e}", method.name);
                }
            }
        }
    }

    #[test]
    fn not_a_number_is_no_small_deviation() {
        assert!(deviation(&[vec![1.0, f64::NAN]], &[vec![1.0, 2.0]]).is_nan());
        assert_eq!(deviation(&[vec![1.0, 3.0, 9.0]], &[vec![1.0, 2.0]]), 1.0);
    }
}
