//! Keys without an effect: runs that differ in one axis only and are equal to the bit.

use crate::sweep::{Axis, Plan, Row};

/// Returns the axes, by their keys, without an effect: all runs finished, and runs that differ in this axis only have equal
/// figures, steps and evaluations. Random samples have none, because all their keys change at once.
pub fn idle(plan: &Plan, rows: &[Row<'_>]) -> Vec<String> {
    let finished = rows.iter().all(|row| row.is_finished());
    if plan.sweep.sample.is_some() || !finished || rows.len() != plan.len() {
        return Vec::new();
    }
    let axes = &plan.sweep.axes;
    let idle = axes.iter().enumerate().filter(|(place, axis)| {
        let mut lists = axis.keys.iter().map(|(_, list)| list);
        let differs = lists.any(|list| list.iter().any(|value| *value != list[0]));
        let later: usize = axes[place + 1..].iter().map(Axis::len).product();
        let step = later * plan.sweep.engines.len();
        let first = |run: usize| &rows[run - run / step % axis.len() * step];
        differs && (0..rows.len()).all(|run| first(run).result() == rows[run].result())
    });
    let names = |(key, _): &(String, _)| key.clone();
    idle.map(|(_, axis)| {
        axis.keys
            .iter()
            .map(names)
            .collect::<Vec<_>>()
            .join(" with ")
    })
    .collect()
}
