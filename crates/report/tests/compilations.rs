//! Checks that a comparison compiles its gearbox only once. The count is that of the process, so this is its only test.

use pinwheel_faults::compilations;
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Override, Scene};
use pinwheel_studies::comparison::{self, Input};
use pinwheel_studies::{Control, Provenance, choice};

#[test]
fn regress_a_comparison_compiles_its_gearbox_once() {
    let sets = ["solver.duration_s=0.004", "drive.start=equilibrium"];
    let sets: Vec<Override> = sets.iter().map(|set| set.parse().unwrap()).collect();
    let scene = Scene::load("paper", &sets).unwrap();
    // Both forms, a law and contacts in another program, and one in Python or its recording.
    let names = "reduced lagrange rapier-shared-law rapier-colliders mujoco-shared-law";
    let names: Vec<&str> = names.split(' ').collect();
    let engines = choice::engines(&names, &scene).unwrap();
    let gearbox = Gearbox::new(&scene).unwrap();
    let input = Input {
        gearbox: &gearbox,
        engines: &engines,
        data: &[],
    };
    let outcome = comparison::run(&input, &Control::quiet()).unwrap();
    assert!(outcome.comparison.context.divergence.is_some());
    let made = Provenance::here("pinwheel compare paper".to_owned());
    let page = pinwheel_report::pages::comparison::page(&outcome, &made);
    assert!(page.contains("native solver"), "the motion");
    // Matched runs use other gears.
    assert_eq!(compilations(), 1 + outcome.twins.len() as u64);
}
