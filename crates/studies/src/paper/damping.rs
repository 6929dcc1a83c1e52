//! Figs. 7 and 8: torques and sleeve forces at several contact dampings.

use super::figure::{Curve, Figure, Plot, number, verdict};
use super::read::{EXTERNAL, INPUT, INTERNAL, OUTPUT, STEADY, all, largest, part, range, times};
use super::runs::{Model, Runs};
use crate::StudyError;

/// Dampings drawn, N s/m: the paper's 8 and lower ones, which it does not name.
const DAMPINGS: [f64; 4] = [0.5, 2.0, 4.0, 8.0];
/// Shown from where the first swings are over, s.
const SHOWN: (f64, f64) = (0.1, 0.6);

pub(super) fn figures(runs: &Runs<'_>) -> Result<Vec<Figure>, StudyError> {
    let mut found = Vec::new();
    for damping in DAMPINGS {
        let run = runs.get(Model::Ours, |s| s.contact.damping_n_s_m = damping)?;
        found.push((damping, run));
    }
    let x = found
        .first()
        .map(|(_, run)| times(&run.courses, SHOWN))
        .unwrap_or_default();
    let curves = |name: &str| -> Vec<Curve> {
        let course = |(damping, run): &(f64, std::rc::Rc<super::runs::Run>)| {
            Curve::line(
                format!("C = {damping} N s/m"),
                part(&run.courses, name, SHOWN),
            )
        };
        found.iter().map(course).collect()
    };
    let plot = |key: &str, title: &str, y_label: &str, name: &str| Plot {
        key: key.to_owned(),
        title: title.to_owned(),
        x_label: "Time (s)".to_owned(),
        y_label: y_label.to_owned(),
        y_log: false,
        x: x.clone(),
        curves: curves(name),
        note: String::new(),
    };
    let ranges = |name: &str| -> Vec<f64> {
        let of = |(_, run): &(f64, std::rc::Rc<super::runs::Run>)| {
            range(part(&run.courses, name, STEADY))
        };
        found.iter().map(of).collect()
    };
    let (input, output) = (ranges(INPUT), ranges(OUTPUT));
    let peaks = |group: &str| -> Vec<f64> {
        let of = |(_, run): &(f64, std::rc::Rc<super::runs::Run>)| {
            largest(&all(&run.courses, group, STEADY))
        };
        found.iter().map(of).collect()
    };
    let (internal, external) = (peaks(INTERNAL), peaks(EXTERNAL));
    let falling = |values: &[f64]| values.windows(2).all(|pair| pair[1] < pair[0]);
    let listed = |values: &[f64], digits: usize| {
        let words: Vec<String> = values.iter().map(|v| format!("{v:.digits$}")).collect();
        words.join(", ")
    };
    let numbered = |what: &str, values: &[f64], unit: &str| {
        let of =
            |(damping, value): (&f64, &f64)| number(format!("{what}_c_{damping}"), *value, unit);
        DAMPINGS.iter().zip(values).map(of).collect::<Vec<_>>()
    };
    let why = "What low damping leaves is the start: at 0.3 s the transient has not died down (its decay time is \
               proportional to 1/C). In the steady motion itself the ripple hardly depends on C.";
    Ok(vec![
        Figure {
            id: "fig-07".into(),
            name: "Fig. 7".into(),
            title: "Torques at the shafts for several contact dampings".into(),
            says: "Torques oscillate with high amplitude at low damping; C = 8 N s/m gives smooth courses.".into(),
            found: format!(
                "From 0.3 to 0.6 s the input torque ranges over {} N m and the output torque over {} N m at C = 0.5, 2, 4, 8 N s/m.",
                listed(&input, 3),
                listed(&output, 2)
            ),
            why: why.into(),
            numbers: [numbered("input_range", &input, "N m"), numbered("output_range", &output, "N m")].concat(),
            // "High amplitude" against "smooth": at least three times.
            verdict: verdict(falling(&input) && input[0] > 3.0 * input[DAMPINGS.len() - 1], falling(&input)),
            plots: vec![
                plot("fig-07a", "Torque at the input shaft", "Input torque (N m)", INPUT),
                plot("fig-07b", "Torque at the output shaft", "Output torque (N m)", OUTPUT),
            ],
        },
        Figure {
            id: "fig-08".into(),
            name: "Fig. 8".into(),
            title: "Sleeve forces for several contact dampings".into(),
            says: "Forces on the sleeves oscillate with high amplitude at low damping, and are smooth at C = 8 N s/m.".into(),
            found: format!(
                "The largest internal force from 0.3 to 0.6 s is {} N, the largest external {} N at C = 0.5, 2, 4, 8 N s/m.",
                listed(&internal, 1),
                listed(&external, 1)
            ),
            why: why.into(),
            numbers: [numbered("internal_peak", &internal, "N"), numbered("external_peak", &external, "N")].concat(),
            verdict: verdict(
                falling(&internal) && falling(&external) && external[0] > 1.2 * external[DAMPINGS.len() - 1],
                falling(&external),
            ),
            plots: vec![
                plot("fig-08a", "Force on internal sleeve 0", "Force (N)", &format!("{INTERNAL}_0")),
                plot("fig-08b", "Force on external sleeve 0", "Force (N)", &format!("{EXTERNAL}_0")),
            ],
        },
    ])
}
