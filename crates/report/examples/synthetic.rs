//! Writes a report on invented time series, to look at the page without running an engine:
//! `cargo run -p pinwheel-report --example synthetic -- page.html`.
//!
//! Nothing in it was computed by a solver; the shapes only resemble a gearbox's.

use std::error::Error;

use pinwheel_compare::uncertainty::Source;
use pinwheel_compare::{Context, Cost, Evidence, Participant, Rules, SharedModel, Status, compare};
use pinwheel_report::comparison::study;
use pinwheel_report::study::{Study, render};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::table::Table;

const SAMPLES: u32 = 6001;

/// Invented time series; `error` moves an engine away from the others, `samples` ends it early.
fn time_series(error: f64, seed: f64, samples: u32) -> Result<TimeSeries, Box<dyn Error>> {
    let time: Vec<f64> = (0..samples).map(|k| f64::from(k) * 1e-4).collect();
    let of = |f: &dyn Fn(f64) -> f64| time.iter().map(|&t| f(t)).collect::<Vec<f64>>();
    let off = |t: f64, k: f64| {
        1.0 + error * ((523.0 * t + seed + k).sin() + 0.4 * (7000.0 * t + 2.0 * k).sin())
    };
    let start = |t: f64| (-t / 0.05).exp() * (7540.0 * t).sin();
    let mut time_series = TimeSeries::new(time.clone())?;
    let driver = |t: f64| {
        (1.4529 + 0.014 * (837.8 * t).sin() + 0.005 * (447.0 * t).cos() + 0.9 * start(t))
            * off(t, 0.0)
    };
    time_series.push("input_torque_n_m", of(&driver))?;
    let output =
        |t: f64| -22.0 * (1.0 + 0.4 * start(t)) * (1.0 + 0.002 * error * (500.0 * t).sin());
    time_series.push("output_torque_n_m", of(&output))?;
    time_series.push(
        "output_angle_rad",
        of(&|t| -52.34 / 15.0 * t * (1.0 + 1e-3 * error)),
    )?;
    for (group, count, cycle, peak) in [
        ("external_sleeve_force_n", 16, 52.34 * 16.0 / 15.0, 100.4),
        ("internal_sleeve_force_n", 8, 52.34 * 16.0 / 15.0, 156.6),
    ] {
        for k in 0..count {
            let phase = std::f64::consts::TAU * f64::from(k) / f64::from(count);
            let force = |t: f64| {
                let load = (cycle * t + phase).sin().max(0.0).powf(0.8);
                let ring = 1.0 + 1.4 * start(t) + 0.03 * (7540.0 * t + phase).sin();
                (peak * 0.97 * load * ring * off(t, f64::from(k))).max(0.0)
            };
            time_series.push(format!("{group}_{k}"), of(&force))?;
        }
    }
    Ok(time_series)
}

fn participants() -> Result<Vec<Participant>, Box<dyn Error>> {
    let one = |name: &str, track: SharedModel, error: f64, wall_s: f64, differences: &str| {
        Ok::<_, Box<dyn Error>>(Participant {
            name: name.to_owned(),
            track,
            version: "0.1.0".to_owned(),
            summary: format!("Invented engine `{name}`"),
            differences: differences.to_owned(),
            time_series: time_series(error, wall_s, SAMPLES)?,
            cost: Cost {
                wall_s,
                cpu_s: wall_s * 0.98,
                rhs_calls: 120_000,
                steps: 60_000,
                degrees_of_freedom: 27,
                bodies: 28,
                step_s: 1e-5,
                settings: "reduced, rk2".to_owned(),
                notes: Vec::new(),
                ..Cost::default()
            },
            status: Status::Finished,
        })
    };
    let mut all = vec![
        one(
            "native-reduced",
            SharedModel::Native,
            0.0,
            0.41,
            "The base of nothing: it is compared like all others.",
        )?,
        one(
            "native-lagrange",
            SharedModel::Native,
            2e-11,
            1.32,
            "84 coordinates and 57 multipliers; the same contact law and method.",
        )?,
        one(
            "rapier-shared-law",
            SharedModel::SharedLaw,
            2.1e-5,
            3.9,
            "Impulse joints and semi-implicit Euler raised to second order; forces of the shared law, held over a step.",
        )?,
        one(
            "rapier-own-contact-hook",
            SharedModel::OwnContact,
            1.3e-4,
            5.2,
            "rapier resolves contact and friction; exact normals and depths are handed to it.",
        )?,
        one(
            "rapier-own-contact-colliders",
            SharedModel::OwnContact,
            0.11,
            9.7,
            "Polyline discs and rapier's own spring, which is linear: wave forms and peaks are not comparable, means are.",
        )?,
    ];
    all[1].cost.joint_drift_m = Some(3.1e-14);
    all[2].cost.joint_drift_m = Some(4.2e-9);
    all[3]
        .cost
        .notes
        .push("Stabilisation iterations 0.".to_owned());
    let mut broken = one("mujoco-shared-law", SharedModel::SharedLaw, 0.02, 0.3, "")?;
    broken.time_series = time_series(0.02, 1.0, 1200)?;
    broken.status = Status::Diverged {
        time_s: 0.12,
        quantity: "disc 1 angle is 1e12 rad".to_owned(),
    };
    all.push(broken);
    Ok(all)
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "synthetic.html".to_owned());
    let mut participants = participants()?;
    if std::env::args().any(|a| a == "--clean") {
        participants.pop();
    }
    let context = Context {
        scene: "synthetic".to_owned(),
        description:
            "Invented courses that resemble the paper's gearbox: 16 ring and 8 output pins, 22 N m."
                .to_owned(),
        duration_s: 0.6,
        load_n_m: Some(22.0),
        input_speed_rad_s: Some(52.34),
        ..Context::default()
    };
    let evidence: Vec<Evidence> = participants
        .iter()
        .map(|participant| Evidence {
            engine: participant.name.clone(),
            source: Source::Exact(1e-4),
            is_final: None,
            floor: 0.0,
        })
        .collect();
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    let comparison = compare(&context, &participants, &rules)?;
    let assumed = [("Friction coefficient 0", "The paper gives none.")];
    let model = Table::of("Assumptions", assumed)
        .text("", "What", |fact| fact.0)
        .text("", "Why", |fact| fact.1)
        .done();
    let scene = "name = \"synthetic\"\n[gear]\neccentricity_m = 0.0028\n".to_owned();
    let page = render(&Study {
        versions: vec![
            ("pinwheel".into(), "0.1.0".into()),
            ("rapier2d-f64".into(), "0.36.1".into()),
        ],
        machine: vec![
            ("processor".into(), "invented, 2 cores".into()),
            ("system".into(), "none".into()),
        ],
        command: "pinwheel compare synthetic --out report".to_owned(),
        ..study(&comparison, &participants, None, vec![model], scene)
    });
    std::fs::write(path, page)?;
    Ok(())
}
