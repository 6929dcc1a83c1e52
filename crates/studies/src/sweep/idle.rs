//! Keys without an effect: runs that differ in one axis only and are equal to the bit.

use std::collections::HashMap;

use pinwheel_files::fnv;

use crate::sweep::{Plan, RunRecord};

/// Returns the axes, by their keys, without an effect: all runs finished, and runs that differ in this axis only have equal
/// figures, steps and evaluations. Random samples have none, because all their keys change at once.
pub fn idle(plan: &Plan, records: &[RunRecord]) -> Vec<String> {
    let finished = records.iter().all(|record| record.ending.is_finished());
    if plan.sweep.sample.is_some() || !finished || records.len() != plan.runs.len() {
        return Vec::new();
    }
    let axes = plan.sweep.axes.iter().enumerate();
    let idle = axes.filter(|(place, axis)| {
        let mut lists = axis.keys.iter().map(|(_, list)| list);
        let differs = lists.any(|list| list.iter().any(|value| *value != list[0]));
        let mut groups = HashMap::new();
        differs
            && records.iter().enumerate().all(|(run, record)| {
                let mut others = plan.places(run);
                others[*place] = 0;
                let own = outcome(record);
                *groups.entry(others).or_insert(own) == own
            })
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

/// Returns a hash of all results of a run except its costs.
fn outcome(record: &RunRecord) -> u64 {
    let alone = RunRecord {
        scene: String::new(),
        wall_s: 0.0,
        cpu_s: 0.0,
        ..record.clone()
    };
    fnv(serde_json::to_string(&alone)
        .unwrap_or_default()
        .into_bytes())
}
