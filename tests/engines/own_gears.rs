//! Users' gears of at most 15 lines without `[solver]`, compared at the first attempt.
//!
//! Only the beginning of each run, and the engines of every build; docs/verdicts.md has the complete runs in all engines.

use std::path::{Path, PathBuf};
use std::time::Duration;

use pinwheel_compare::{RESOLUTION, Verdict};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Override, Scene};
use pinwheel_studies::comparison::{self, Effort, Input};
use pinwheel_studies::{Control, choice};

/// Share of each gear's run.
const BEGINNING: f64 = 0.02;

fn gears() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/gears");
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// No gear is refused, no native engine fails, no two differ, and inconclusive verdicts have a reason.
#[test]
fn hard_own_gears_are_compared_at_the_first_try() {
    let gears = gears();
    assert!(gears.len() >= 9, "{gears:?}");
    for path in gears {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(
            text.lines().count() <= 15 && !text.contains("[solver]"),
            "{path:?}"
        );
        let path = path.to_str().unwrap();
        let full = Scene::load(path, &[]).unwrap();
        let duration_s = BEGINNING * full.solver.duration_s;
        let short = Override::new("solver.duration_s", duration_s.to_string());
        let scene = Scene::load(path, &[short]).unwrap();
        if scene.contact.friction_coefficient > 0.0 {
            // rapier's explicit steps take minutes here.
            continue;
        }
        let engines = choice::engines(
            &["native-reduced", "native-lagrange", "rapier-shared-law"],
            &scene,
        )
        .unwrap();
        let input = Input {
            gearbox: &Gearbox::new(&scene).unwrap(),
            engines: &engines,
            data: &[],
        };
        let effort = Effort {
            longest: Duration::from_secs(20),
            ..Effort::of(&scene)
        };
        let outcome = comparison::run_with(&input, effort, &Control::quiet()).unwrap();
        for one in &outcome.participants {
            assert!(
                one.status.is_finished(),
                "{path}: {}: {:?}",
                one.name,
                one.status
            );
        }
        let comparison = &outcome.comparison;
        println!("{path}: {:?}", comparison.counts);
        assert_eq!(
            comparison.counts.exit_status(),
            0,
            "{path}: {:?}",
            comparison.counts
        );
        assert!(comparison.counts.agree > 0, "{path}");
        for pair in &comparison.pairs {
            for entry in &pair.entries {
                let result = &entry.result;
                match result.verdict {
                    // Twice the resolution without a confirmed order.
                    Verdict::Agree => {
                        assert!(
                            result.bound.unwrap() <= 2.0 * RESOLUTION,
                            "{path}: {result:?}"
                        );
                    }
                    Verdict::Inconclusive => {
                        assert!(
                            !result.actionable && !result.reason.is_empty(),
                            "{path}: {result:?}"
                        );
                    }
                    _ => {}
                }
            }
        }
    }
}
