//! Where the energy of each run went.

use pinwheel_compare::Comparison;

use crate::format;

/// One engine and window.
pub(super) struct EnergyRow {
    pub(super) engine: String,
    pub(super) style: usize,
    pub(super) window: String,
    /// Driver, load, kinetic, stored, damping, friction, remainder, its share.
    pub(super) values: Vec<String>,
}

pub(super) fn rows(comparison: &Comparison, styles: &[usize]) -> Vec<EnergyRow> {
    let engines = comparison.engines.iter().zip(styles);
    engines
        .flat_map(|(engine, &style)| {
            engine.cost.energy.iter().map(move |e| {
                let joules = [
                    e.driver_j,
                    e.load_j,
                    e.kinetic_j,
                    e.stored_j,
                    e.damping_j,
                    e.friction_j,
                    e.remainder_j,
                ];
                // Tenths of a millijoule of tens of joules: below that a remainder is rounding.
                let mut values: Vec<String> = joules.iter().map(|x| format!("{x:.4}")).collect();
                let share = e.remainder_share.filter(|share| share.is_finite());
                values.push(share.map_or_else(
                    || "no work".to_owned(),
                    |share| format!("{:.4} %", 100.0 * share),
                ));
                EnergyRow {
                    engine: engine.name.clone(),
                    style,
                    window: format!(
                        "{}\u{2013}{} s",
                        format::plain(e.from_s),
                        format::plain(e.to_s)
                    ),
                    values,
                }
            })
        })
        .collect()
}
