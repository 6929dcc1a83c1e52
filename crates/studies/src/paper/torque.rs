//! Figs. 14 to 16: torques for several backlashes, and over a longer time.

use std::f64::consts::TAU;

use pinwheel_scene::{Scene, Start};

use super::figure::{Curve, Measured, number};
use super::read::{DRAWN, DYING, INPUT, OUTPUT, STEADY, mean, part, times};
use super::runs::{BACKLASHES, Model, Runs, backlash};
use crate::StudyError;

/// Length of the longer time, s, which the paper does not state.
const LONG: f64 = 1.8;
pub(super) fn figures(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    Ok(vec![
        ripple(runs, "fig-14", INPUT)?,
        ripple(runs, "fig-15", OUTPUT)?,
        sixteen(runs)?,
    ])
}

fn ripple(runs: &Runs<'_>, id: &'static str, channel: &str) -> Result<Measured, StudyError> {
    let mut measured = Measured::new(id, Vec::new(), Vec::new());
    let moving = Start::Kinematic;
    let ends = [BACKLASHES[0], BACKLASHES[2]];
    for (name, model, start, window) in [
        ("range_start", Model::Ours, moving, DYING),
        ("range_steady", Model::Ours, moving, STEADY),
        ("range_equilibrium", Model::Ours, Start::Equilibrium, DYING),
        ("range_steady_4000_points", Model::FINE, moving, STEADY),
        ("range_steady_600_points", Model::ROUGH, moving, STEADY),
    ] {
        let cases = runs.cases(model, &ends, backlash, |s, d| {
            s.gear.backlash_m = d;
            s.drive.start = start;
        })?;
        measured.numbers.extend(cases.ranges(name, channel, window));
    }
    for (letter, model, window) in [
        ("a", Model::Ours, (0.0, 0.24)),
        ("b", Model::Ours, DRAWN),
        ("c", Model::FINE, DRAWN),
    ] {
        let cases = runs.backlashes(model)?;
        let plot = cases.plot(&format!("{id}{letter}"), channel, window);
        measured.plots.push(plot);
    }
    Ok(measured)
}

/// Returns the difference of a signal's last period from the one before, relative to its own variation.
fn unlike_before(values: &[f64], period: usize) -> f64 {
    let [before, last] = [2, 1].map(|periods| values.len().saturating_sub(periods * period));
    let (before, now) = (&values[before..last], &values[last..]);
    let middle = mean(now);
    let off: f64 = now.iter().zip(before).map(|(a, b)| (a - b) * (a - b)).sum();
    let own: f64 = now.iter().map(|a| (a - middle) * (a - middle)).sum();
    (off / own).sqrt()
}

fn sixteen(runs: &Runs<'_>) -> Result<Measured, StudyError> {
    // Common period of both meshes: zs/zk of an input turn.
    let gear = Scene::paper().gear;
    let turn = TAU / Scene::paper().drive.input_speed_rad_s;
    let period = turn * gear.lobes() as f64 / gear.external_sleeves as f64;
    let samples = 1000;
    let periods = (LONG / period).floor();
    let mut curves = Vec::new();
    let mut x = Vec::new();
    let mut measured = Measured::new("fig-16", Vec::new(), Vec::new());
    for (name, model, d) in [
        ("unlike_0", Model::Ours, 0.0),
        ("unlike_0.6_mm", Model::Ours, 6e-4),
        ("unlike_0.6_mm_4000_points", Model::FINE, 6e-4),
        ("unlike_0.6_mm_600_points", Model::ROUGH, 6e-4),
    ] {
        let run = runs.get(model, |s| {
            s.gear.backlash_m = d;
            s.solver.sample_s = period / f64::from(samples);
            s.solver.duration_s = periods * period;
        })?;
        let torque = part(&run.time_series, OUTPUT, (0.0, LONG));
        let unlike = unlike_before(torque, samples as usize);
        measured.numbers.push(number(name, unlike, ""));
        // Every third sample suffices for the page: 8 kHz.
        let thin = |values: &[f64]| values.iter().copied().step_by(3).collect::<Vec<_>>();
        x = thin(&times(&run.time_series, (0.0, LONG)));
        let label = format!("{}, {}", backlash(d), model.words());
        curves.push(Curve::line(label, thin(torque)));
    }
    measured.plots.push(("fig-16".to_owned(), x, curves));
    Ok(measured)
}
