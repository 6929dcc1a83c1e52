//! The static balance: Newton's method against the brackets, over gears nobody tuned to.

use std::f64::consts::TAU;

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::catalogue::{Catalogue, MATERIALS};
use proptest::prelude::*;

fn catalogue(ratio: usize, wheels: usize, backlash: f64, friction: f64) -> Catalogue {
    let plain = Catalogue {
        name: "random".to_owned(),
        ratio,
        pin_circle_diameter_m: 0.1,
        torque_n_m: 60.0,
        speed_rad_s: 100.0,
        material: MATERIALS[0],
        pin_diameter_m: None,
        eccentricity_m: None,
        wheels: Some(wheels),
        output_pins: None,
        output_pin_diameter_m: None,
        output_circle_diameter_m: None,
        face_width_m: None,
        backlash_m: None,
        friction_coefficient: Some(friction),
    };
    let eccentricity = plain.draft().unwrap().scene.gear.eccentricity_m;
    Catalogue {
        backlash_m: Some(backlash * eccentricity),
        ..plain
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Both find the same angles. A contact of 1e-6 m penetration carries its load to 1e-15 rad: the angles meet to
    /// 1.2e-14 rad at worst in 400 gears; three times that is allowed.
    #[test]
    fn newton_finds_what_the_brackets_find(
        ratio in 5..80_usize, wheels in 1..5_usize, backlash in 0.0..0.3_f64, friction in 0.0..0.2_f64,
        turn in 0.0..1.0_f64, share in prop::sample::select(vec![1.0, -1.0, 0.03, -0.03, 1e-4]),
        law in prop::sample::select(vec!["paper", "paper-conservative", "constant", "line-contact"]),
    ) {
        let scene = catalogue(ratio, wheels, backlash, friction).draft().unwrap().scene;
        let scene = scene.changed(|scene| scene.contact.law = law.to_owned()).unwrap();
        let gearbox = Gearbox::new(&scene).unwrap();
        let mut statics = Statics::new(&gearbox).unwrap();
        let load = share * 60.0;
        for phi in [TAU * turn, TAU * turn + 0.01] {
            let (before, found) = (statics.evaluations(), statics.solve(phi, load).unwrap());
            let newton = statics.evaluations() - before;
            let slow = Statics::new(&gearbox).unwrap().solve_by_brackets(phi, load).unwrap();
            let pairs = found.wheels.iter().zip(&slow.wheels);
            let apart = pairs.map(|(a, b)| (a - b).abs()).fold((found.output - slow.output).abs(), f64::max);
            eprintln!("{apart:e} {:e} {newton}", found.residual / load);
            prop_assert!(apart < 4e-14, "{apart:e} rad");
            prop_assert!(found.residual < 1e-8 * load.abs(), "{:e}", found.residual);
            // 45 evaluations at most in 400 gears, where the brackets take thousands.
            prop_assert!(newton < 150, "{newton} evaluations");
        }
    }
}

/// Without a load and with backlash only holes without clearance touch: the brackets find a place.
#[test]
fn without_a_load() {
    let scene = catalogue(20, 2, 0.1, 0.0).draft().unwrap().scene;
    let gearbox = Gearbox::new(&scene).unwrap();
    let mut statics = Statics::new(&gearbox).unwrap();
    let left = statics.solve(0.3, 0.0).unwrap().residual;
    assert!(left < 1e-9, "{left:e} N m");
    // A load beyond what the teeth carry has no balance, by either way.
    assert!(statics.solve(0.3, 1e9).is_err());
}
