//! Why the published model does not converge above C = 8 N s/m.
//!
//! Its choices are switched on one at a time, at several dampings:
//!
//! - detection by 600 points instead of the exact curve;
//! - the law without the clamp (Eq. 20 as printed: contacts may pull);
//! - the velocity of Q as printed: Eq. 16 and 17 multiply the sleeve's radius, a number of metres, by a
//!   velocity that was not normalised, so that v_n comes out as (1 - R) times what it is. For a law
//!   linear in v_n that is the damping (1 - R) C, and so it is modelled;
//! - the step of 1e-5 s instead of a converged run.
//!
//! For the largest damping that a model stands, friction (whose coefficient is not printed) and Eq. 17 computed in
//! millimetres are tried as well; everything else is without friction, as in the preset `paper`.

use pinwheel_courses::columns;
use pinwheel_scene::{Detection, Scene};
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::control::{Control, Ended, Progress};
use pinwheel_courses::norms::{Distance, Least, Level};

/// What is switched on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Switch {
    /// Our model, converged: the reference of all others.
    Converged,
    /// Our model at the paper's step and method.
    Step,
    /// Points detection at 600, converged.
    Points,
    /// The law without the clamp, converged.
    Unclamped,
    /// The velocity of Q as printed, converged.
    PrintedVelocity,
    /// All of them at the paper's step.
    Everything,
    /// Points detection at the paper's step: without what the others add.
    PointsAndStep,
    /// Friction, whose coefficient is not printed: mu = 0.1, at the paper's method and step.
    Friction,
    /// All of them with friction, at the paper's step.
    EverythingWithFriction,
    /// Eq. 17 computed in millimetres: its factor (1 - R) is then -5, and damping feeds energy in.
    Millimetres,
}

impl Switch {
    /// As a table names it.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Converged => "nothing: our model, converged",
            Self::Step => "the paper's method and step",
            Self::Points => "600 points a wheel, 20 a hole",
            Self::Unclamped => "no clamp (Eq. 20 as printed)",
            Self::PrintedVelocity => "velocity of Q as printed (Eq. 16, 17)",
            Self::Everything => "all of them, at the paper's step",
            Self::PointsAndStep => "600 points at the paper's step",
            Self::Friction => "friction, mu = 0.1, at the paper's step",
            Self::EverythingWithFriction => "all of them with friction, at the paper's step",
            Self::Millimetres => "Eq. 17 in millimetres, at the paper's step",
        }
    }
}

/// Those for which the largest damping is looked for: what cannot be compared with the converged run is among
/// them.
pub const LIMITED: [Switch; 9] = [
    Switch::Step,
    Switch::Points,
    Switch::Unclamped,
    Switch::PrintedVelocity,
    Switch::PointsAndStep,
    Switch::Friction,
    Switch::Everything,
    Switch::EverythingWithFriction,
    Switch::Millimetres,
];

/// Those whose errors are measured, in the order of the table.
pub const SWITCHES: [Switch; 7] = [
    Switch::Converged,
    Switch::Step,
    Switch::Points,
    Switch::Unclamped,
    Switch::PrintedVelocity,
    Switch::PointsAndStep,
    Switch::Everything,
];

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// C, N s/m.
    pub damping_n_s_m: f64,
    /// What is switched on.
    pub switch: Switch,
    /// Against the converged run at the same damping, in the steady half of the run.
    pub error: Option<Distance>,
    /// Sizes in the steady half.
    pub level: Option<Level>,
    /// RMS of the driver torque's change from sample to sample, over its mean: roughness.
    pub roughness: Option<f64>,
    /// How the run failed.
    pub failure: Option<String>,
}

/// Dampings of the study, N s/m: the paper's, and what lies above.
pub const DAMPINGS: [f64; 6] = [8.0, 16.0, 32.0, 64.0, 200.0, 512.0];
/// Points on a wheel and on a hole: the paper's rough analysis.
const POINTS: (usize, usize) = (600, 20);
/// Friction coefficient where there is friction.
const FRICTION: f64 = 0.1;
/// Step of the converged runs, s. Points make forces jump, so a fixed step serves all alike.
const FINE: f64 = 5e-7;

/// Runs the study on `scene` (usually `paper`).
///
/// # Errors
/// Cancelled, or our own converged run fails.
pub fn run(
    scene: &Scene,
    dampings: &[f64],
    control: &Control<'_>,
) -> Result<Vec<Entry>, StudyError> {
    let mut entries = Vec::new();
    let total = dampings.len() * SWITCHES.len();
    for &damping in dampings {
        let converged = control.complete(&switched(scene, damping, Switch::Converged))?;
        let reference = steady(&converged.courses)?;
        for switch in SWITCHES {
            let piece = format!("C = {damping}, {switch:?}");
            (control.progress)(Progress::new(entries.len(), total, &piece));
            let ended = control.run_published(&switched(scene, damping, switch))?;
            let mut entry = Entry {
                damping_n_s_m: damping,
                switch,
                error: None,
                level: None,
                roughness: None,
                failure: None,
            };
            match ended {
                Ended::Whole(run) => {
                    let courses = steady(&run.courses)?;
                    entry.error = Some(Distance::between(&courses, &reference, Least::default()));
                    entry.level = Some(Level::of(&courses));
                    entry.roughness = Some(roughness(&courses));
                }
                Ended::Diverged {
                    time_s, quantity, ..
                } => {
                    entry.failure = Some(format!("at t = {time_s:.4} s: {quantity}"));
                }
            }
            entries.push(entry);
        }
    }
    Ok(entries)
}

fn switched(scene: &Scene, damping: f64, switch: Switch) -> Scene {
    let mut scene = scene.clone();
    let rubs = matches!(switch, Switch::Friction | Switch::EverythingWithFriction);
    let all = matches!(switch, Switch::Everything | Switch::EverythingWithFriction);
    scene.contact.damping_n_s_m = damping;
    if rubs {
        scene.contact.friction_coefficient = FRICTION;
    }
    if all || matches!(switch, Switch::Points | Switch::PointsAndStep) {
        scene.contact.detection = Detection::Points;
        (scene.contact.wheel_points, scene.contact.hole_points) = POINTS;
    }
    if all || switch == Switch::Unclamped {
        "paper-printed".clone_into(&mut scene.contact.law);
    }
    if all || switch == Switch::PrintedVelocity {
        scene.contact.damping_n_s_m *= 1.0 - scene.gear.external_sleeve_radius_m;
    }
    if switch == Switch::Millimetres {
        scene.contact.damping_n_s_m *= 1.0 - 1e3 * scene.gear.external_sleeve_radius_m;
    }
    let published = all
        || rubs
        || matches!(
            switch,
            Switch::Step | Switch::PointsAndStep | Switch::Millimetres
        );
    (scene.solver.step_s, scene.solver.integrator) = if published {
        (1e-5, "rk2".to_owned())
    } else {
        (FINE, "rk4".to_owned())
    };
    scene
}

/// The second half of the run: what the start leaves is gone or nearly so.
fn steady(courses: &pinwheel_courses::Courses) -> Result<pinwheel_courses::Courses, StudyError> {
    let from = courses.len() / 2;
    let mut half = pinwheel_courses::Courses::new(courses.time_s()[from..].to_vec())?;
    for channel in courses.channels() {
        half.push(channel.name.clone(), channel.values[from..].to_vec())?;
    }
    Ok(half)
}

fn roughness(courses: &pinwheel_courses::Courses) -> f64 {
    let torque = courses.channel(columns::INPUT_TORQUE).unwrap_or(&[]);
    let n = torque.len().max(2) as f64;
    let mean = torque.iter().sum::<f64>() / n;
    let change: f64 = torque
        .windows(2)
        .map(|w| (w[1] - w[0]) * (w[1] - w[0]))
        .sum();
    (change / (n - 1.0)).sqrt() / mean.abs()
}

/// Where a model stops working as its damping grows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// What is switched on.
    pub switch: Switch,
    /// Step, s.
    pub step_s: f64,
    /// Largest damping, to 10 %, at which the run ends with peak forces below twice those without the
    /// switch at the paper's damping, N s/m; 0: not even at [`LEAST_DAMPING`].
    pub damping_n_s_m: f64,
    /// How it fails above; `None`: not up to [`MOST_DAMPING`].
    pub failure: Option<String>,
}

/// Dampings above are not tried, N s/m.
pub const MOST_DAMPING: f64 = 1e5;

/// Dampings below are not tried, N s/m.
pub const LEAST_DAMPING: f64 = 0.0625;

/// Doubles the damping from the paper's 8 N s/m (or halves it, if that fails) until the verdict on the
/// paper's method at `step` changes, then bisects.
///
/// # Errors
/// Cancelled, or the run at the paper's damping fails.
pub fn limit(
    scene: &Scene,
    switch: Switch,
    step: f64,
    control: &Control<'_>,
) -> Result<Limit, StudyError> {
    let at = |damping: f64| {
        let mut scene = switched(scene, damping, switch);
        "rk2".clone_into(&mut scene.solver.integrator);
        scene.solver.step_s = step;
        control.run_published(&scene)
    };
    let base = Level::of(
        &control
            .complete(&switched(scene, 8.0, Switch::Converged))?
            .courses,
    );
    let fails = |damping: f64| -> Result<Option<String>, StudyError> {
        Ok(match at(damping)? {
            Ended::Diverged {
                time_s, quantity, ..
            } => Some(format!("at t = {time_s:.5} s: {quantity}")),
            Ended::Whole(run) => {
                let ratio = Level::of(&run.courses).peak_force_n / base.peak_force_n;
                (!(ratio < 2.0)).then(|| format!("forces {ratio:.1} times as high"))
            }
        })
    };
    let (mut good, mut bad) = (None, None);
    let mut damping = 8.0;
    loop {
        match fails(damping)? {
            None => good = Some(damping),
            Some(how) => bad = Some((damping, how)),
        }
        damping *= if good.is_some() { 2.0 } else { 0.5 };
        let both = good.is_some() && bad.is_some();
        if both || !(LEAST_DAMPING..=2.0 * MOST_DAMPING).contains(&damping) {
            break;
        }
    }
    while let (Some(low), Some((high, _))) = (good, &bad)
        && high / low > 1.1
    {
        let middle: f64 = (low * high).sqrt();
        match fails(middle)? {
            None => good = Some(middle),
            Some(how) => bad = Some((middle, how)),
        }
    }
    Ok(Limit {
        switch,
        step_s: step,
        damping_n_s_m: good.unwrap_or(0.0),
        failure: bad.map(|(_, how)| how),
    })
}
