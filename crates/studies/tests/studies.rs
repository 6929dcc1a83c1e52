//! The studies on scenes short enough for every run of the tests.

use std::sync::atomic::AtomicBool;

use pinwheel_gearbox::scene::{Override, Scene};
use pinwheel_studies::stability::{self, Failure, Options};
use pinwheel_studies::{Control, StudyError, divergence, drift, published};

fn scene(name: &str, sets: &[&str]) -> Scene {
    let sets: Vec<Override> = sets.iter().map(|s| s.parse().unwrap()).collect();
    Scene::load(name, &sets).unwrap()
}

/// Steel at the paper's step: Heun blows up, its largest step is about 1.9e-6 s, RK4's about 8.4e-6 s
/// (measured over 0.05 s; less than a factor of 1.5 apart over 0.01 s).
#[test]
fn atlas_of_steel() {
    let mut options = Options {
        scenes: vec!["hard-steel".to_owned()],
        longest_s: 0.01,
        ..Options::default()
    };
    options.methods.truncate(3);
    let atlas = stability::run(&options, &Control::quiet()).unwrap();
    let cells = &atlas.rows[0].cells;
    assert!(matches!(cells[0].failure, Some(Failure::BlowUp { .. })));
    let (heun, rk4) = (
        cells[0].largest_step_s.unwrap(),
        cells[1].largest_step_s.unwrap(),
    );
    assert!((1.3e-6..4e-6).contains(&heun), "{heun}");
    assert!((6e-6..1.6e-5).contains(&rk4), "{rk4}");
    // Dormand-Prince at 1e-6: measured 2e-4 over 0.05 s.
    assert!(cells[2].failure.is_none() && cells[2].error.unwrap().forces < 2e-3);
    let json = serde_json::to_string(&atlas).unwrap();
    assert!(json.contains("\"kind\":\"blow-up\""));
}

/// An explicit method that would need 1e10 steps is named and not waited for.
#[test]
fn hopeless_runs_are_not_tried() {
    let mut options = Options {
        scenes: vec!["hard-feather-sleeves".to_owned()],
        longest_s: 0.001,
        ..Options::default()
    };
    options.methods.retain(|m| m.integrator == "dopri5");
    let atlas = stability::run(&options, &Control::quiet()).unwrap();
    let failure = atlas.rows[0].cells[0].failure.as_ref().unwrap();
    assert!(matches!(failure, Failure::TooStiff { steps } if *steps > 1e7));
}

#[test]
fn studies_stop_when_asked() {
    let now = AtomicBool::new(true);
    let control = Control {
        cancel: &now,
        progress: &|_| {},
    };
    let outcome = stability::run(&Options::default(), &control);
    assert!(matches!(outcome, Err(StudyError::Cancelled)));
}

/// The paper's gear is not chaotic: a rounding stays a rounding.
#[test]
fn a_rounding_stays_one_on_the_paper() {
    let scene = scene("paper", &["solver.duration_s=0.1"]);
    let found = divergence::horizon(&scene, &Control::quiet()).unwrap();
    assert_eq!(found.horizon_s, None, "{}", found.sentence());
    assert!(
        found.largest_share > 0.0,
        "the change must reach the forces"
    );
    assert!(found.largest_share < 1e-9, "{:e}", found.largest_share);
}

/// The joints of the Lagrange form: rounding with projection, 1e-9 m and more without.
#[test]
fn drift_is_measured() {
    let scene = scene("paper", &["solver.duration_s=0.05"]);
    let found = drift::measure(&scene, &Control::quiet()).unwrap();
    let joint = |k: usize| found[k].joint_m.unwrap();
    assert!(
        joint(0) > 1e-10 && joint(1) < joint(0) && joint(2) < 1e-15,
        "{found:?}"
    );
    assert!(found[2].against_reduced.unwrap().forces < 1e-9);
}

/// At C = 8 nothing of the published model but its points changes much; points are tens of per cent off.
#[test]
fn published_choices_one_at_a_time() {
    let scene = scene("paper", &["solver.duration_s=0.02"]);
    let entries = published::run(&scene, &[8.0], &Control::quiet()).unwrap();
    let error = |switch| {
        let entry = entries.iter().find(|e| e.switch == switch).unwrap();
        entry.error.unwrap().forces
    };
    assert_eq!(error(published::Switch::Converged), 0.0);
    assert!(error(published::Switch::Points) > 0.03);
    for small in [
        published::Switch::Unclamped,
        published::Switch::PrintedVelocity,
    ] {
        assert!(error(small) < 0.01, "{small:?}: {}", error(small));
    }
}
