//! Figs. 14 to 16: torques for several backlashes, and over a longer time.

use std::f64::consts::TAU;

use pinwheel_scene::{Scene, Start};

use super::backlash::{BACKLASHES, plot, words};
use super::figure::{Curve, Figure, Plot, number, verdict};
use super::read::{DRAWN, DYING, INPUT, OUTPUT, STEADY, mean, part, range, times};
use super::runs::{Model, Runs};
use crate::StudyError;

/// How long the longer time is, s; the paper does not say.
const LONG: f64 = 1.8;

pub(super) fn figures(runs: &Runs<'_>) -> Result<Vec<Figure>, StudyError> {
    Ok(vec![
        ripple(runs, INPUT, "fig-14", "Fig. 14", "input")?,
        ripple(runs, OUTPUT, "fig-15", "Fig. 15", "output")?,
        sixteen(runs)?,
    ])
}

fn ripple(
    runs: &Runs<'_>,
    name: &str,
    id: &str,
    figure: &str,
    shaft: &str,
) -> Result<Figure, StudyError> {
    let ranges = |model: Model, start: Start, window: (f64, f64)| -> Result<Vec<f64>, StudyError> {
        let mut found = Vec::new();
        for backlash in BACKLASHES {
            let run = runs.get(model, |s| {
                s.gear.backlash_m = backlash;
                s.drive.start = start;
            })?;
            found.push(range(part(&run.courses, name, window)));
        }
        Ok(found)
    };
    let steady = ranges(Model::Ours, Start::Kinematic, STEADY)?;
    let early = ranges(Model::Ours, Start::Kinematic, DYING)?;
    let balanced = ranges(Model::Ours, Start::Equilibrium, DYING)?;
    let coarse = ranges(Model::Points(4000), Start::Kinematic, STEADY)?;
    let last = BACKLASHES.len() - 1;
    let larger = |n: &[f64]| n[last] > 1.5 * n[0];
    let label = format!("Torque at the {shaft} shaft");
    let axis = format!("{}{} torque (N m)", shaft[..1].to_uppercase(), &shaft[1..]);
    Ok(Figure {
        id: id.into(),
        name: figure.into(),
        title: format!("Torque at the {shaft} shaft for several backlashes"),
        says: "The amplitude of the oscillation is considerably lower without backlash.".into(),
        found: format!(
            "From 0.06 to 0.15 s the {shaft} torque ranges over {:.2} N m without and {:.2} N m with 0.6 mm; steady over {:.4} and {:.4} N m. \
             Started in equilibrium instead, it ranges over {:.3} and {:.3} N m from 0.06 to 0.15 s. Steady with 4000 points: {:.2} and {:.2} N m.",
            early[0], early[last], steady[0], steady[last], balanced[0], balanced[last], coarse[0], coarse[last]
        ),
        why: "The difference is the start: the wheels first fall through their free play and then ring. A start in equilibrium \
              has no difference, nor has the steady motion; points add a ripple of their own, which falls with backlash."
            .into(),
        numbers: vec![
            number("range_start_0", early[0], "N m"),
            number("range_start_0.6_mm", early[last], "N m"),
            number("range_steady_0", steady[0], "N m"),
            number("range_steady_0.6_mm", steady[last], "N m"),
            number("range_equilibrium_0", balanced[0], "N m"),
            number("range_equilibrium_0.6_mm", balanced[last], "N m"),
            number("range_steady_4000_points_0", coarse[0], "N m"),
            number("range_steady_4000_points_0.6_mm", coarse[last], "N m"),
        ],
        // "Considerably": by half at least.
        verdict: verdict(larger(&steady), larger(&early)),
        plots: vec![
            plot(runs, Model::Ours, [&format!("{id}a"), &format!("The start: {}", label.to_lowercase()), &axis], name, (0.0, 0.24))?,
            plot(runs, Model::Ours, [&format!("{id}b"), &label, &axis], name, DRAWN)?,
            plot(runs, Model::Points(4000), [&format!("{id}c"), &label, &axis], name, DRAWN)?,
        ],
    })
}

/// How much a course differs from itself one period earlier, relative to its own variation, for the last period.
fn unlike_before(values: &[f64], period: usize) -> f64 {
    let now = &values[values.len().saturating_sub(period)..];
    let before =
        &values[values.len().saturating_sub(2 * period)..values.len().saturating_sub(period)];
    let middle = mean(now);
    let off: f64 = now.iter().zip(before).map(|(a, b)| (a - b) * (a - b)).sum();
    let own: f64 = now.iter().map(|a| (a - middle) * (a - middle)).sum();
    (off / own).sqrt()
}

fn sixteen(runs: &Runs<'_>) -> Result<Figure, StudyError> {
    // A common period of both meshes: zs/zk of an input turn.
    let gear = Scene::paper().gear;
    let turn = TAU / Scene::paper().drive.input_speed_rad_s;
    let period = turn * gear.lobes() as f64 / gear.external_sleeves as f64;
    let samples = 1000;
    let whole = (LONG / period).floor();
    let mut curves = Vec::new();
    let mut x = Vec::new();
    let mut unlike = Vec::new();
    for (model, backlash) in [
        (Model::Ours, 0.0),
        (Model::Ours, 6e-4),
        (Model::Points(4000), 6e-4),
        (Model::Points(600), 6e-4),
    ] {
        let run = runs.get(model, |s| {
            s.gear.backlash_m = backlash;
            s.solver.sample_s = period / f64::from(samples);
            s.solver.duration_s = whole * period;
        })?;
        let torque = part(&run.courses, OUTPUT, (0.0, LONG));
        unlike.push(unlike_before(torque, samples as usize));
        // Every third sample is enough for the page: 8 kHz.
        let thin = |values: &[f64]| values.iter().copied().step_by(3).collect::<Vec<_>>();
        x = thin(&times(&run.courses, (0.0, LONG)));
        curves.push(Curve::line(
            format!("{}, {}", words(backlash), model.words()),
            thin(torque),
        ));
    }
    let random = |share: f64| share > 0.5;
    Ok(Figure {
        id: "fig-16".into(),
        name: "Fig. 16".into(),
        title: "Torque at the output shaft over a longer time".into(),
        says: "The torques are random functions of time with an unpredictable amplitude, which do not reach a steady state.".into(),
        found: format!(
            "In the end one common period (15/16 of an input turn) differs from the one before by {:.1e} of its own variation without backlash and \
             {:.1e} with 0.6 mm; with 4000 points {:.2}, with 600 {:.3}. A random function would differ by 1.4.",
            unlike[0], unlike[1], unlike[2], unlike[3]
        ),
        why: "Frictionless the motion is periodic once the start has died down. 600 points are alike on all 15 lobes; 4000 are not, \
              so that with them a wheel must turn once before its motion repeats."
            .into(),
        numbers: vec![
            number("unlike_0", unlike[0], ""),
            number("unlike_0.6_mm", unlike[1], ""),
            number("unlike_0.6_mm_4000_points", unlike[2], ""),
            number("unlike_0.6_mm_600_points", unlike[3], ""),
        ],
        verdict: verdict(random(unlike[1]), unlike.iter().copied().any(random)),
        plots: vec![Plot {
            key: "fig-16".into(),
            title: "Torque at the output shaft".into(),
            x_label: "Time (s)".into(),
            y_label: "Output torque (N m)".into(),
            y_log: false,
            x,
            curves,
            note: "Drag over the first 0.2 s to see what the paper calls random.".into(),
        }],
    })
}
