//! Figs. 7 and 8, and section 5: torques and pin forces at several contact dampings.

use pinwheel_scene::{Scene, scales};

use super::figure::{Curve, Measured, Plot, number, numbers};
use super::read::{EXTERNAL, INPUT, INTERNAL, OUTPUT, STEADY, mean, part, peak, range};
use super::runs::{Model, Runs};
use crate::StudyError;

/// Dampings drawn, N s/m: the paper's 8 and lower ones, which it does not name.
const DAMPINGS: [f64; 4] = [0.5, 2.0, 4.0, 8.0];
/// As numbers name them.
const NAMES: [&str; 4] = ["c_0.5", "c_2", "c_4", "c_8"];
/// Shown from where the first swings are over, s.
const SHOWN: (f64, f64) = (0.1, 0.6);
/// The paper's damping and those tried above it, N s/m.
const ABOVE: [f64; 4] = [8.0, 16.0, 64.0, 512.0];

pub(super) fn figures(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let label = |damping| format!("C = {damping} N s/m");
    let cases = runs.cases(Model::Ours, &DAMPINGS, label, |s, damping| {
        s.contact.damping_n_s_m = damping;
    })?;
    let ranges = |what: &str, channel: &str| {
        let values = cases.each(|time_series| range(part(time_series, channel, STEADY)));
        numbers(what, &NAMES, &values, "N m")
    };
    let peaks = |what: &str, group: &str| {
        let values = cases.each(|time_series| peak(time_series, group, STEADY));
        numbers(what, &NAMES, &values, "N")
    };
    let plot = |words: [&str; 3], channel: &str| cases.plot(words, channel, SHOWN);
    let input = ["fig-07a", "Torque at the input shaft", "Input torque (N m)"];
    let title = "Torque at the output shaft";
    let output = ["fig-07b", title, "Output torque (N m)"];
    let internal = ["fig-08a", "Force on output pin 0", "Force (N)"];
    let external = ["fig-08b", "Force on ring pin 0", "Force (N)"];
    let [i, e] = [INTERNAL, EXTERNAL].map(|group| format!("{group}_0"));
    let mut seven = ranges("input_range", INPUT);
    seven.extend(ranges("output_range", OUTPUT));
    let mut eight = peaks("internal_peak", INTERNAL);
    eight.extend(peaks("external_peak", EXTERNAL));
    let torques = vec![plot(input, INPUT), plot(output, OUTPUT)];
    let forces = vec![plot(internal, &i), plot(external, &e)];
    Ok(vec![
        Measured::new("fig-07", seven, torques),
        Measured::new("fig-08", eight, forces),
    ])
}

/// By the method and step of the paper: as ours, with its 600 points, with its law as printed, which may pull, and with both.
pub(super) fn above(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let mut found = Measured::new("damping-above-8", Vec::new(), Vec::new());
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
            found.numbers.push(number(name, *value, "N m"));
            // Not a number: the run diverged.
            let off = (value / means[0] - 1.0).abs();
            furthest = furthest.max(if off.is_nan() { f64::INFINITY } else { off });
            ended += i32::from(!off.is_nan());
        }
        curves.push(Curve::line(label, means));
    }
    let scene = Scene::paper();
    let (gear, hertz) = (&scene.gear, scales::hertz(&scene));
    let stiffness = hertz.of_hole(gear.internal_sleeve_radius_m, gear.hole_radius_m);
    found.numbers.extend([
        number("furthest", furthest, ""),
        number("runs_ended", ended.into(), ""),
        number("runs", (curves.len() * (ABOVE.len() - 1)) as f64, ""),
        number("hole_stiffness", stiffness, "N/m^1.5"),
        number("one_per_cent", 0.01 * stiffness, "N/m^1.5"),
        number("damping_used", scene.contact.damping_n_s_m, "N s/m"),
    ]);
    let words = [
        "damping-above-8",
        "Mean input torque, 0.2 to 0.4 s",
        "Contact damping (N s/m)",
        "Input torque (N m)",
    ];
    found.plots.push(Plot::new(words, ABOVE.to_vec(), curves));
    Ok(vec![found])
}
