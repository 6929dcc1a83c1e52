//! Small faults that a comparison must detect: a slightly wrong gear against the correct one.

use std::time::Duration;

use pinwheel_compare::{Evidence, Participant, Rules, Verdict, compare};
use pinwheel_engines::{Engine, Native};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Override, Scene};

use pinwheel_studies::comparison::{Effort, context, refine};
use pinwheel_studies::{Control, Progress};

/// Required resolution, a tenth of the faults.
const RESOLUTION: f64 = 1e-4;

type Fault = (&'static str, fn(&mut Scene), fn(&mut Gearbox));

const FAULTS: [Fault; 6] = [
    (
        "stiffness 0.1 % larger",
        |scene| scene.contact.young_pa *= 1.001,
        |_| {},
    ),
    (
        "damping 10 % larger",
        |scene| scene.contact.damping_n_s_m *= 1.1,
        |_| {},
    ),
    (
        "no damping",
        |scene| scene.contact.damping_n_s_m = 0.0,
        |_| {},
    ),
    (
        "eccentricity 0.1 % smaller",
        |scene| {
            scene.gear.eccentricity_m *= 0.999;
            scene.gear.shortening *= 0.999;
        },
        |_| {},
    ),
    (
        "one pin 1 um smaller",
        |_| {},
        |gearbox| gearbox.geometry.external_radii_m[0] -= 1e-6,
    ),
    (
        "a disc 0.1 mrad out of phase",
        |_| {},
        |gearbox| *gearbox.geometry.wheel_phases.last_mut().unwrap() += 1e-4,
    ),
];

fn ran(engine: &dyn Engine, gearbox: &Gearbox) -> (Participant, Evidence) {
    let effort = Effort {
        longest: Duration::from_secs(20),
        obey: false,
        resolution: RESOLUTION,
    };
    let (at, context) = (Progress::new(0, 1, ""), context(&gearbox.scene));
    refine(engine, gearbox, &context, effort, at, &Control::quiet()).unwrap()
}

#[test]
fn crossval_small_faults_are_told() {
    let short = Override::new("solver.duration_s", "0.003");
    let scene = Scene::load("paper", &[short]).unwrap();
    let right = Gearbox::new(&scene).unwrap();
    let (own, of_own) = ran(&Native::REDUCED, &right);
    let differs = |gearbox: &Gearbox| {
        let (other, of_other) = ran(&Native::LAGRANGE, gearbox);
        let rules = Rules {
            evidence: &[of_own.clone(), of_other],
            resolution: RESOLUTION,
            ..Rules::default()
        };
        let report = compare(&context(&scene), &[own.clone(), other], &rules).unwrap();
        let entries = &report.pairs[0].entries;
        entries
            .iter()
            .any(|entry| entry.result.verdict == Verdict::Differ)
    };
    assert!(!differs(&right), "a false alarm");
    for (what, of_scene, of_gearbox) in FAULTS {
        let mut wrong = Gearbox::new(&scene.changed(of_scene).unwrap()).unwrap();
        of_gearbox(&mut wrong);
        assert!(differs(&wrong), "{what}");
    }
}
