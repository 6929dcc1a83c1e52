//! Why the published model does not converge above C = 8 N s/m (docs/physics.md):
//! `cargo run --release -p pinwheel-studies --example damping`.
//!
//! Its choices are switched on one at a time, at several dampings:
//!
//! - detection by 600 points instead of the exact curve;
//! - the law without the clamp (Eq. 20 as printed: contacts may pull);
//! - the velocity of Q as printed: Eq. 16 and 17 multiply the pin's radius, a number of metres, by a
//!   velocity that was not normalised, so that v_n comes out as (1 - R) times what it is. For a law
//!   linear in v_n that is the damping (1 - R) C, and so it is modelled;
//! - the step of 1e-5 s instead of a converged run.
//!
//! For the largest damping that a model stands, friction (whose coefficient is not printed) and Eq. 17 computed in
//! millimetres are tried as well; everything else is without friction, as in the preset `paper`.

#![allow(clippy::print_stdout, reason = "a program that prints its tables")]

use std::error::Error;

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::native::{self, NativeRun};
use pinwheel_scene::{CheckedScene, Detection, Scene};
use pinwheel_timeseries::norms::{Distance, LoadFloor, LoadMagnitude};
use pinwheel_timeseries::{Ending, TimeSeries, TimeSeriesError, columns};

/// Feature of the model that is switched on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Switch {
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
    fn words(self) -> &'static str {
        match self {
            Self::Converged => "nothing: our model, converged",
            Self::Step => "the paper's method and step",
            Self::Points => "600 points a disc, 20 a hole",
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

/// Switches for which the largest damping is sought, also those that cannot be compared with the converged run.
const LIMITED: [Switch; 9] = [
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

/// Switches whose errors are measured, in the order of the table.
const SWITCHES: [Switch; 7] = [
    Switch::Converged,
    Switch::Step,
    Switch::Points,
    Switch::Unclamped,
    Switch::PrintedVelocity,
    Switch::PointsAndStep,
    Switch::Everything,
];

/// Dampings of the study, N s/m: the paper's, and what lies above.
const DAMPINGS: [f64; 6] = [8.0, 16.0, 32.0, 64.0, 200.0, 512.0];
/// Points on a disc and on a hole: the paper's rough analysis.
const POINTS: (usize, usize) = (600, 20);
/// Friction coefficient where there is friction.
const FRICTION: f64 = 0.1;
/// Step of the converged runs, s. Points make forces jump, so a fixed step serves all alike.
const FINE: f64 = 5e-7;

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene = Scene::load("paper", &[])?.into_scene();
    scene.solver.duration_s = 0.3;
    println!(
        "C (N s/m), switched on: forces against our converged run in the second half of 0.3 s; roughness of the driver torque"
    );
    for damping in DAMPINGS {
        let converged = run(&switched(&scene, damping, Switch::Converged))??;
        let converged = steady(&converged.time_series)?;
        for switch in SWITCHES {
            match run(&switched(&scene, damping, switch))? {
                Ok(found) => {
                    let found = steady(&found.time_series)?;
                    let error = Distance::between(&found, &converged, LoadFloor::default()).forces;
                    println!(
                        "{damping:5} {:48} {error:.1e} {:.1e}",
                        switch.words(),
                        roughness(&found)
                    );
                }
                Err(error) => println!("{damping:5} {:48} {error}", switch.words()),
            }
        }
    }
    scene.solver.duration_s = 0.05;
    println!(
        "largest C (N s/m) at which 0.05 s of Heun end with forces below twice those of the converged run at C = 8"
    );
    for step_s in [1e-5, 5e-6] {
        for switch in LIMITED {
            let (most, how) = limit(&scene, switch, step_s)?;
            let how = how.unwrap_or_else(|| "holds".to_owned());
            println!("{step_s:.0e} s {:48} {most:9.2} {how}", switch.words());
        }
    }
    Ok(())
}

/// Runs a published model, whose damping no sound scene may have. The inner error says how the run ended.
fn run(scene: &Scene) -> Result<Result<NativeRun, Ending>, Box<dyn Error>> {
    let gearbox = Gearbox::new(&CheckedScene::unchecked(scene.clone()))?;
    Ok(native::run(&gearbox, &mut |_| false)?.finished())
}

fn switched(scene: &Scene, damping: f64, switch: Switch) -> Scene {
    let mut scene = scene.clone();
    let has_friction = matches!(switch, Switch::Friction | Switch::EverythingWithFriction);
    let all = matches!(switch, Switch::Everything | Switch::EverythingWithFriction);
    scene.contact.damping_n_s_m = damping;
    if has_friction {
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
        || has_friction
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
fn steady(time_series: &TimeSeries) -> Result<TimeSeries, TimeSeriesError> {
    let from = time_series.len() / 2;
    let mut half = TimeSeries::new(time_series.time_s()[from..].to_vec())?;
    for channel in time_series.channels() {
        half.push(channel.name.clone(), channel.values[from..].to_vec())?;
    }
    Ok(half)
}

fn roughness(time_series: &TimeSeries) -> f64 {
    let torque = time_series.channel(columns::INPUT_TORQUE).unwrap_or(&[]);
    let n = torque.len().max(2) as f64;
    let mean = torque.iter().sum::<f64>() / n;
    let change: f64 = torque
        .windows(2)
        .map(|w| (w[1] - w[0]) * (w[1] - w[0]))
        .sum();
    (change / (n - 1.0)).sqrt() / mean.abs()
}

/// Dampings above are not tried, N s/m.
const MOST_DAMPING: f64 = 1e5;

/// Dampings below are not tried, N s/m.
const LEAST_DAMPING: f64 = 0.0625;

/// Largest damping that a model stands by the paper's method at `step` (s), to 10 %, N s/m (0: not even the least), and how it
/// fails above (`None`: not up to the most).
///
/// The damping is doubled from the paper's 8 N s/m (or halved, if that fails) until the verdict changes, then bisected.
fn limit(
    scene: &Scene,
    switch: Switch,
    step: f64,
) -> Result<(f64, Option<String>), Box<dyn Error>> {
    let base = LoadMagnitude::of(&run(&switched(scene, 8.0, Switch::Converged))??.time_series);
    let fails = |damping: f64| -> Result<Option<String>, Box<dyn Error>> {
        let mut scene = switched(scene, damping, switch);
        "rk2".clone_into(&mut scene.solver.integrator);
        scene.solver.step_s = step;
        Ok(match run(&scene)? {
            Err(error) => Some(error.to_string()),
            Ok(run) => {
                let ratio = LoadMagnitude::of(&run.time_series).peak_force_n / base.peak_force_n;
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
    Ok((good.unwrap_or(0.0), bad.map(|(_, how)| how)))
}
