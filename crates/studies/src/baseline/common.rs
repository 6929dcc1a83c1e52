//! What the cases that moved have in common, and the others have not: the first question after a check.

use std::collections::{BTreeMap, BTreeSet};

use super::cases::SCENES;
use super::check::{CaseCheck, Check};
use super::judge::Verdict;

/// Traits named at most.
const MOST_NAMED: usize = 3;

/// Sentences on the keys that all cases that moved set alike, and few of the others do; most telling first.
///
/// Empty if nothing moved, if everything did, or if they share nothing.
#[must_use]
pub fn in_common(check: &Check) -> Vec<String> {
    let (moved, others): (Vec<&CaseCheck>, Vec<&CaseCheck>) = check
        .cases
        .iter()
        .partition(|case| case.verdict != Verdict::Same);
    if moved.is_empty() || others.is_empty() {
        return Vec::new();
    }
    let traits = |cases: &[&CaseCheck]| -> Vec<BTreeSet<String>> {
        cases.iter().map(|case| traits(case)).collect()
    };
    let (moved, others) = (traits(&moved), traits(&others));
    let shared = moved
        .iter()
        .skip(1)
        .fold(moved[0].clone(), |shared, one| &shared & one);
    let mut found: Vec<(usize, String)> = shared
        .into_iter()
        .map(|key| (others.iter().filter(|o| o.contains(&key)).count(), key))
        .filter(|(count, _)| 2 * count < others.len())
        .collect();
    found.sort();
    let sentence = |(count, key): (usize, String)| {
        let rest = match count {
            0 => format!("none of the {} others has", others.len()),
            n => format!("{n} of the {} others have", others.len()),
        };
        let who = match moved.len() {
            1 => "the one that moved has".to_owned(),
            n => format!("all {n} that moved have"),
        };
        format!("{who} {key}, {rest}")
    };
    found.into_iter().take(MOST_NAMED).map(sentence).collect()
}

/// Every key of the case's scene with its value, `drive.start = "equilibrium"`; a list that is not empty as such.
fn traits(case: &CaseCheck) -> BTreeSet<String> {
    let known = SCENES.iter().find(|known| known.name == case.scene);
    let scene = known.and_then(|known| {
        let choice = known.choices.iter().find(|c| c.name == case.choice);
        // A solver from outside runs the scene as it is.
        known.scene(choice.map_or(&[], |choice| choice.sets)).ok()
    });
    let table = scene.and_then(|scene| scene.to_toml().parse::<toml::Table>().ok());
    let mut found = BTreeMap::new();
    collect("", table.unwrap_or_default(), &mut found);
    // Names are no reasons.
    found.retain(|key, _| !["name", "description"].contains(&key.as_str()));
    found
        .into_iter()
        .map(|(key, value)| format!("{key} = {value}"))
        .collect()
}

fn collect(prefix: &str, table: toml::Table, found: &mut BTreeMap<String, String>) {
    for (key, value) in table {
        let name = match prefix {
            "" => key,
            prefix => format!("{prefix}.{key}"),
        };
        match value {
            toml::Value::Table(table) => collect(&name, table, found),
            toml::Value::Array(list) if !list.is_empty() => {
                found.insert(name, "[...]".to_owned());
            }
            value => {
                found.insert(name, value.to_string());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baseline::Made;

    fn check(moved: &[&str]) -> Check {
        let made = Made {
            date: String::new(),
            commit: String::new(),
            version: String::new(),
            build: String::new(),
            vectors: String::new(),
            processor: String::new(),
            no_instructions: String::new(),
        };
        let cases = SCENES.iter().flat_map(|scene| {
            scene.choices.iter().map(|choice| CaseCheck {
                scene: scene.name.to_owned(),
                choice: choice.name.to_owned(),
                quantities: Vec::new(),
                costs: Vec::new(),
                time_ratio: None,
                trouble: None,
                verdict: if moved.contains(&scene.name) {
                    Verdict::Changed
                } else {
                    Verdict::Same
                },
            })
        });
        Check {
            before: made.clone(),
            after: made,
            cases: cases.collect(),
            time: None,
            time_is_judged: false,
            verdict: Verdict::Changed,
        }
    }

    #[test]
    fn regress_what_moved_is_told_by_what_it_shares() {
        let found = in_common(&check(&["eleven-pins"]));
        let told = "gear.external_sleeves = 11, none of the";
        assert!(found.iter().any(|one| one.contains(told)), "{found:?}");
        let equilibrium: Vec<&str> = SCENES
            .iter()
            .filter(|case| {
                case.scene(&[])
                    .is_ok_and(|scene| scene.drive.start == pinwheel_scene::Start::Equilibrium)
            })
            .map(|case| case.name)
            .collect();
        assert!(equilibrium.len() > 1);
        let found = in_common(&check(&equilibrium));
        assert!(
            found[0].contains("drive.start = \"equilibrium\", none of the"),
            "{found:?}"
        );
        assert!(in_common(&check(&[])).is_empty());
    }
}
