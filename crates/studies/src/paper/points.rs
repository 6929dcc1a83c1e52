//! Fig. 9: 600 against 4000 points on a wheel.

use super::figure::{Curve, Figure, Plot, number, verdict};
use super::read::{DRAWN, EXTERNAL, INTERNAL, STEADY, all, off, part, roughness, times};
use super::runs::{Model, Runs};
use crate::StudyError;

/// Samples (0.1 ms each) to both sides of the running mean: slower than contact, faster than a sleeve's load cycle.
const HALF: usize = 10;

pub(super) fn figure(runs: &Runs<'_>) -> Result<Figure, StudyError> {
    let models = [Model::Points(600), Model::Points(4000), Model::Ours];
    let mut found = Vec::new();
    for model in models {
        found.push((model, runs.get(model, |_| {})?));
    }
    let exact = &found[2].1.courses;
    let errors = |group: &str| {
        let of = |k: usize| {
            off(
                &all(&found[k].1.courses, group, STEADY),
                &all(exact, group, STEADY),
            )
        };
        [of(0), of(1)]
    };
    let (internal, external) = (errors(INTERNAL), errors(EXTERNAL));
    let rough: Vec<f64> = found
        .iter()
        .map(|(_, run)| roughness(part(&run.courses, &format!("{INTERNAL}_0"), STEADY), HALF))
        .collect();
    let plot = |key: &str, title: &str, name: &str| Plot {
        key: key.into(),
        title: title.into(),
        x_label: "Time (s)".into(),
        y_label: "Force (N)".into(),
        y_log: false,
        x: times(exact, DRAWN),
        curves: found
            .iter()
            .map(|(model, run)| Curve::line(model.words(), part(&run.courses, name, DRAWN)))
            .collect(),
        note: String::new(),
    };
    Ok(Figure {
        id: "fig-09".into(),
        name: "Fig. 9".into(),
        title: "Sleeve forces with 600 and with 4000 points on a wheel".into(),
        says: "600 points give marked oscillation of the internal sleeve force against 4000.".into(),
        found: format!(
            "Against the exact profile the internal forces are {:.1} % off with 600 points and {:.1} % with 4000, the external \
             ones {:.1} % and {:.1} %. The internal force oscillates by {:.1} N RMS with 600, {:.1} N with 4000, {:.1} N with the exact profile.",
            100.0 * internal[0],
            100.0 * internal[1],
            100.0 * external[0],
            100.0 * external[1],
            rough[0],
            rough[1],
            rough[2]
        ),
        why: "The contact normal jumps from point to point, which kicks the wheel at every jump. 4000 points are not the \
              limit either: the exact profile has no such error, at a lower cost."
            .into(),
        numbers: vec![
            number("internal_error_600_points", internal[0], ""),
            number("internal_error_4000_points", internal[1], ""),
            number("external_error_600_points", external[0], ""),
            number("external_error_4000_points", external[1], ""),
            number("internal_oscillation_600_points", rough[0], "N"),
            number("internal_oscillation_4000_points", rough[1], "N"),
            number("internal_oscillation_exact", rough[2], "N"),
        ],
        // "Marked": twice as rough as the refined one.
        verdict: verdict(rough[0] > 2.0 * rough[1], rough[0] > rough[1]),
        plots: vec![
            plot("fig-09a", "Force on internal sleeve 0", &format!("{INTERNAL}_0")),
            plot("fig-09b", "Force on external sleeve 0", &format!("{EXTERNAL}_0")),
        ],
    })
}
