//! Figs. 7 and 8, and section 5: torques and pin forces at several contact dampings.

use pinwheel_scene::{Scene, scales};

use super::figure::{Curve, Measured, number};
use super::read::{EXTERNAL, INPUT, INTERNAL, OUTPUT, STEADY, mean, part};
use super::runs::{Model, Runs};
use crate::StudyError;

/// Dampings in the plots, N s/m, with their names in numbers: the paper's 8 and lower ones, which it does not name.
const DAMPINGS: [(&str, f64); 4] = [("c_0.5", 0.5), ("c_2", 2.0), ("c_4", 4.0), ("c_8", 8.0)];
/// Window of the plots, after the first oscillations, s.
const SHOWN: (f64, f64) = (0.1, 0.6);
/// The paper's damping and higher ones, N s/m.
const ABOVE: [f64; 4] = [8.0, 16.0, 64.0, 512.0];

pub(super) fn figures(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let label = |damping| format!("C = {damping} N s/m");
    let cases = runs.cases(Model::Ours, &DAMPINGS, label, |s, damping| {
        s.contact.damping_n_s_m = damping;
    })?;
    let plot = |key: &str, channel: &str| cases.plot(key, channel, SHOWN);
    let mut seven = cases.ranges("input_range", INPUT, STEADY);
    seven.extend(cases.ranges("output_range", OUTPUT, STEADY));
    let mut eight = cases.peaks("internal_peak", INTERNAL, STEADY);
    eight.extend(cases.peaks("external_peak", EXTERNAL, STEADY));
    let torques = vec![plot("fig-07a", INPUT), plot("fig-07b", OUTPUT)];
    let forces = vec![plot("fig-08a", INTERNAL), plot("fig-08b", EXTERNAL)];
    Ok(vec![
        Measured::new("fig-07", seven, torques),
        Measured::new("fig-08", eight, forces),
    ])
}

/// Runs by the paper's method and step: with Pinwheel's model, with 600 points, with the law as printed, which may pull, and
/// with both.
pub(super) fn above(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let mut measured = Measured::new("damping-above-8", Vec::new(), Vec::new());
    let mut curves = Vec::new();
    let (mut ended, mut furthest) = (0, 0.0_f64);
    for (model, printed, name, label) in [
        (Model::Ours, false, "", "ours"),
        (Model::ROUGH, false, "_600_points", "600 points"),
        (Model::Ours, true, "_as_printed", "the law as printed"),
        (Model::ROUGH, true, "_600_points_as_printed", "both"),
    ] {
        let mut means = Vec::new();
        for damping in ABOVE {
            let run = runs.get(model, |s| {
                s.contact.damping_n_s_m = damping;
                "rk2".clone_into(&mut s.solver.integrator);
                s.solver.duration_s = 0.4;
                if printed {
                    "paper-printed".clone_into(&mut s.contact.law);
                }
            });
            means.push(match run {
                Ok(run) => mean(part(&run.time_series, INPUT, (0.2, 0.4))),
                Err(StudyError::Reference { .. }) => f64::NAN,
                Err(other) => return Err(other),
            });
        }
        for (damping, value) in ABOVE.into_iter().zip(&means).skip(1) {
            let name = format!("mean_torque{name}_c_{damping}");
            measured.numbers.push(number(name, *value, "N m"));
            // NaN: the run diverged.
            let off = (value / means[0] - 1.0).abs();
            furthest = furthest.max(if off.is_nan() { f64::INFINITY } else { off });
            ended += i32::from(!off.is_nan());
        }
        curves.push(Curve::line(label, means));
    }
    let scene = Scene::paper();
    let (gear, hertz) = (&scene.gear, scales::hertz(&scene));
    let stiffness = hertz.of_hole(gear.internal_sleeve_radius_m, gear.hole_radius_m);
    measured.numbers.extend([
        number("furthest", furthest, ""),
        number("runs_ended", ended.into(), ""),
        number("runs", (curves.len() * (ABOVE.len() - 1)) as f64, ""),
        number("hole_stiffness", stiffness, "N/m^1.5"),
        number("one_per_cent", 0.01 * stiffness, "N/m^1.5"),
        number("damping_used", scene.contact.damping_n_s_m, "N s/m"),
    ]);
    let plot = ("damping-above-8".to_owned(), ABOVE.to_vec(), curves);
    measured.plots.push(plot);
    Ok(vec![measured])
}
