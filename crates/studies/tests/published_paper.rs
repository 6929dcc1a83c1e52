//! The study of the paper: what the paper says of single figures, found in ours.

use std::sync::atomic::AtomicBool;

use pinwheel_studies::paper::claims::Verdict;
use pinwheel_studies::paper::{self, Figure, Options};
use pinwheel_studies::{Control, StudyError};

fn number(figure: &Figure, name: &str) -> f64 {
    figure
        .numbers
        .iter()
        .find(|n| n.name == name)
        .map(|n| n.value)
        .unwrap()
}

fn options(names: &[&str]) -> Options {
    Options {
        figures: names.iter().map(|n| (*n).to_owned()).collect(),
        peer: None,
    }
}

/// Section 7 of the paper: fluctuations "at the beginning of the contact", 0.24 to 0.246 s, and where the curvature
/// changes fast, 0.265 to 0.28 s. Measured: one of our contacts lasts from 0.2403 to 0.3009 s.
#[test]
fn published_contact_of_figures_5_and_6() {
    let found = paper::run(&options(&["5", "11"]), &Control::quiet()).unwrap();
    let [five, eleven] = &found.figures[..] else {
        panic!("{} figures", found.figures.len());
    };
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
    assert_eq!(five.verdict, Verdict::Conditional);
    assert!(
        five.plots[0]
            .curves
            .iter()
            .all(|c| c.y.len() == five.plots[0].x.len())
    );
    // The closed form is the tangent at d = 0; found 2.2 % above it.
    let play =
        number(eleven, "free_play_found_mrad") / number(eleven, "free_play_closed_form_mrad");
    assert!((1.0..1.03).contains(&play), "{play}");
    assert!(found.claims.is_empty() && found.costs.len() == 3 && found.runs > 3);
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
