//! The study of the paper: what the paper says of figures and in words, reproduced by ours, with the numbers known from independent
//! programs.

#![allow(clippy::print_stdout, reason = "measured figures")]

use std::sync::atomic::AtomicBool;

use pinwheel_studies::paper::{self, ClaimVerdict, Options, PaperFigure, PaperResult, peer};
use pinwheel_studies::{Control, StudyError};

fn number(figure: &PaperFigure, name: &str) -> f64 {
    figure
        .numbers
        .iter()
        .find(|n| n.def.key == name)
        .and_then(|n| n.value)
        .unwrap()
}

fn computed(names: &[&str]) -> PaperResult {
    let control = Control::quiet();
    let options = Options {
        figures: names.iter().map(|n| (*n).to_owned()).collect(),
        peer: names
            .contains(&"10")
            .then(|| peer(None, &control).unwrap().unwrap()),
    };
    let study = paper::run(&options, &control).unwrap();
    assert_eq!(study.figures.len(), names.len());
    for figure in &study.figures {
        println!("{} {:?}: {}", figure.id, figure.verdict, figure.found);
        assert!(!figure.found.contains("NaN") && !figure.why.is_empty());
        assert!(figure.plots.iter().all(|plot| !plot.title.is_empty()));
    }
    study
}

/// Verdict and numbers of every claim that the figures judge, as independent programs measured them; and the row that stands in
/// the documentation. Times are not asserted.
fn claims(study: &PaperResult, expected: &[&str]) {
    let ids: Vec<&str> = study.claims.iter().map(|c| c.claim.id.as_str()).collect();
    assert_eq!(ids, expected);
    let documented = include_str!("../../../../docs/physics.md");
    let rows = study.claims_table();
    for (judged, row) in study.claims.iter().zip(rows.lines().skip(2)) {
        println!("{row}");
        let n = &judged.numbers;
        let near = |k: usize, value: f64, off: f64| (n[k] - value).abs() < off;
        let known = match (judged.claim.id.as_str(), judged.verdict) {
            // After 0.1 s the transient still shows in the peaks; steady they are 100.4 and 156.6 N.
            ("below-200", ClaimVerdict::Conditional) => {
                n[0] < 150.0 && n[1] < 200.0 && n[3] > 200.0 && near(5, 240.0, 5.0)
            }
            ("low-damping", ClaimVerdict::Holds) => n[0] > n[1],
            ("damping-above-8", ClaimVerdict::DoesNotHold) => {
                n[..2] == [12.0, 12.0]
                    && n[2..5].iter().all(|m| (m / 1.4529 - 1.0).abs() < 0.04)
                    && n[5] < 0.03
            }
            ("points-600", ClaimVerdict::Holds) => n[1] > 0.002 && n[0] < 0.5,
            ("backlash-50", ClaimVerdict::Holds) => {
                near(0, 100.4, 0.3) && near(1, 154.1, 0.5) && near(2, 0.54, 0.01)
            }
            // One disc with half the load touches a pin 51, 24 and 20 % of 0.12 s.
            ("backlash-contact-time", ClaimVerdict::Holds) => {
                near(0, 61.0, 2.0) && near(1, 29.0, 1.0) && near(2, 24.0, 1.0)
            }
            // Only while the start-up transient dies: measured 186.8 and 242.2 N there.
            ("backlash-internal-25", ClaimVerdict::Conditional) => {
                near(0, 156.6, 0.3) && near(1, 156.4, 0.5) && near(3, 242.2 / 186.8 - 1.0, 0.03)
            }
            // 600 points are alike on all 15 lobes, 4000 are not: measured 0.023 and 0.07.
            ("random-torque", ClaimVerdict::DoesNotHold) => {
                n[0] < 0.001 && n[1] < 0.04 && n[2] < 0.15
            }
            ("damping-one-per-cent", ClaimVerdict::Meaningless) => n[1] > 1e4 * n[2],
            ("backlash-torque", ClaimVerdict::Conditional) => {
                n[..2].iter().all(|&r| r > 0.03 && r < 0.09) && n[3] > 1.5 * n[2] && n[5] < n[4]
            }
            // Along the equilibria, by statics, a contact begins at 2.27 and 18.84 mm/s.
            ("contact-onset", ClaimVerdict::Holds) => near(0, 2.27, 0.1) && near(1, 18.84, 2.5),
            ("time", ClaimVerdict::Conditional) => continue,
            _ => false,
        };
        assert!(known, "{row}");
        assert!(documented.contains(row), "docs/physics.md lacks {row}");
    }
}

/// Section 7 of the paper: fluctuations "at the beginning of the contact", 0.24 to 0.246 s, and where the curvature
/// changes fast, 0.265 to 0.28 s. Measured: one of our contacts lasts from 0.2403 to 0.3009 s.
///
/// The closed form of the play is the tangent at d = 0; measured 2.2 % above it.
#[test]
fn published_figures() {
    let study = computed(&["5", "7", "11", "12", "13", "17", "18"]);
    let five = &study.figures[0];
    assert!((number(five, "begins") - 0.24).abs() < 1e-3);
    assert!(number(five, "ends") > 0.28);
    // Points make the stiffness oscillate (0.46 and 1.57 % of its range measured), the curve hardly (0.07 %).
    let rough = [
        "oscillation_exact",
        "oscillation_4000_points",
        "oscillation_600_points",
    ]
    .map(|n| number(five, n));
    assert!(
        2.0 * rough[0] < rough[1] && 2.0 * rough[1] < rough[2],
        "{rough:?}"
    );
    assert_eq!(five.verdict, ClaimVerdict::Conditional);
    assert!(
        five.plots[0]
            .curves
            .iter()
            .all(|c| c.y.len() == five.plots[0].x.len())
    );
    claims(
        &study,
        &[
            "low-damping",
            "backlash-50",
            "backlash-contact-time",
            "backlash-internal-25",
            "time",
            "contact-onset",
        ],
    );
    let eleven = study.figures.iter().find(|figure| figure.id == "fig-11");
    let play = number(eleven.unwrap(), "free_play_found_mrad")
        / number(eleven.unwrap(), "free_play_closed_form_mrad");
    assert!((1.0..1.03).contains(&play), "{play}");
}

/// Forces of a second program with the times of both, the torque by points and with backlash, and damping above 8 N s/m.
#[test]
#[ignore = "weekly: 25 s for five figures"]
fn published_dear_figures() {
    let study = computed(&["9", "10", "damping", "14", "16"]);
    assert!(study.costs.len() == 4 && study.runs > 3);
    claims(
        &study,
        &[
            "below-200",
            "damping-above-8",
            "points-600",
            "backlash-torque",
            "random-torque",
            "time",
            "damping-one-per-cent",
        ],
    );
}

#[test]
fn the_study_stops_when_asked() {
    let now = AtomicBool::new(true);
    let control = Control::new(&now, &|_| {});
    assert!(matches!(
        paper::run(&Options::default(), &control),
        Err(StudyError::Cancelled)
    ));
}
