//! What every run cost. Wall times are of this machine; counts are not.

use pinwheel_compare::{Comparison, Cost, Track};

use crate::format;

/// The table; columns that would be empty are left out.
pub(super) struct Costs {
    pub(super) rows: Vec<CostRow>,
    pub(super) rejected: bool,
    pub(super) drift: bool,
}

/// One engine's cost; text with the number it is sorted by.
pub(super) struct CostRow {
    pub(super) engine: String,
    pub(super) style: usize,
    pub(super) track: Track,
    pub(super) status: &'static str,
    /// When and why, for a recorded run.
    pub(super) recorded: Option<String>,
    pub(super) wall: (String, String),
    /// Wall time over the longest one's in per cent, for the bar.
    pub(super) bar: String,
    pub(super) cpu: (String, String),
    pub(super) rhs_calls: (String, String),
    pub(super) steps: (String, String),
    pub(super) rejected: String,
    pub(super) step: (String, String),
    pub(super) degrees_of_freedom: String,
    pub(super) bodies: String,
    pub(super) drift: (String, String),
    pub(super) settings: String,
    pub(super) notes: Vec<String>,
}

pub(super) fn table(comparison: &Comparison, styles: &[usize]) -> Costs {
    let any = |of: fn(&Cost) -> bool| comparison.engines.iter().any(|e| of(&e.cost));
    Costs {
        rejected: any(|cost| cost.rejected_steps > 0),
        drift: any(|cost| cost.joint_drift_m.is_some()),
        rows: rows(comparison, styles),
    }
}

fn rows(comparison: &Comparison, styles: &[usize]) -> Vec<CostRow> {
    // A recording's time was another machine's.
    let longest = comparison
        .engines
        .iter()
        .filter(|e| e.cost.recorded.is_none())
        .map(|e| e.cost.wall_s)
        .fold(0.0, f64::max);
    comparison
        .engines
        .iter()
        .zip(styles)
        .map(|(engine, &style)| {
            let cost = &engine.cost;
            // Measured data cost this machine nothing.
            let measured = engine.track == Track::Measured;
            let or_none = |text: String, key: String| {
                if measured {
                    (format::NONE.to_owned(), String::new())
                } else {
                    (text, key)
                }
            };
            let time = |value: f64| or_none(format::seconds(value), value.to_string());
            let count = |value: u64| or_none(format::count(value), value.to_string());
            let number = |value: usize| or_none(value.to_string(), String::new()).0;
            CostRow {
                engine: engine.name.clone(),
                style,
                track: engine.track,
                status: if cost.recorded.is_some() {
                    "recorded"
                } else {
                    engine.status.word()
                },
                recorded: cost.recorded.clone(),
                wall: time(cost.wall_s),
                bar: format!(
                    "{:.1}",
                    100.0
                        * if longest > 0.0 && cost.recorded.is_none() {
                            cost.wall_s / longest
                        } else {
                            0.0
                        }
                ),
                cpu: time(cost.cpu_s),
                rhs_calls: count(cost.rhs_calls),
                steps: count(cost.steps),
                rejected: format::count(cost.rejected_steps),
                step: time(cost.step_s),
                degrees_of_freedom: number(cost.degrees_of_freedom),
                bodies: number(cost.bodies),
                drift: match cost.joint_drift_m {
                    Some(drift) => (format::metres(drift), drift.to_string()),
                    None => (format::NONE.to_owned(), String::new()),
                },
                settings: cost.settings.clone(),
                notes: cost.notes.clone(),
            }
        })
        .collect()
}
