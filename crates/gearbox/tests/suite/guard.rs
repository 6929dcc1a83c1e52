//! Guard of states: free play passes, a quarter of a pitch beyond it fails.

use pinwheel_gearbox::{Gearbox, guard};
use pinwheel_mbs::BodyState;
use pinwheel_scene::{Layout, Override, Scene};

fn gearbox(preset: &str, sets: &[&str]) -> Gearbox {
    let sets: Vec<Override> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Gearbox::new(&Scene::load(preset, &sets).unwrap()).unwrap()
}

/// Returns all bodies on their ideal mesh with the input at 0.3 rad.
fn ideal(gearbox: &Gearbox) -> Vec<BodyState> {
    let mut bodies: Vec<BodyState> = gearbox.mechanism().bodies.iter().map(|b| b.start).collect();
    let input = 0.3;
    bodies[Layout::INPUT].angle = input;
    for (i, body) in gearbox.layout.wheel_bodies().enumerate() {
        bodies[body].angle = gearbox.geometry.ideal_wheel_angle(i, input);
    }
    bodies[Layout::OUTPUT].angle = gearbox.geometry.ideal_output_angle(input);
    bodies
}

/// Free play by hand: a disc rotates by d sqrt(1 - m^2)/(e zs) within its backlash d, the output additionally by the clearance
/// of its holes over their circle's radius.
#[test]
fn hard_free_play_is_allowed_and_a_quarter_pitch_more() {
    for sets in [
        &[][..],
        &["gear.backlash_m=0"],
        &["gear.hole_radius_m=0.0094"],
    ] {
        let gearbox = gearbox("backlash-0.6", sets);
        let gear = &gearbox.scene.gear;
        let teeth = gear.external_sleeves as f64 - 1.0;
        let root = (1.0 - gear.shortening * gear.shortening).sqrt();
        let wheel = gear.backlash_m * root / (gear.eccentricity_m * teeth);
        let clearance = gear.hole_radius_m - gear.internal_sleeve_radius_m - gear.eccentricity_m;
        let output = wheel + clearance / gear.internal_circle_radius_m;
        let quarter = std::f64::consts::TAU / teeth / 4.0;
        // The play exceeds the 1 % below.
        let play = sets.iter().all(|set| !set.contains("backlash"));
        assert!(!play || wheel > 0.05 * quarter, "{wheel} {quarter}");
        let wheel_body = gearbox.layout.wheel_bodies().last().unwrap();
        for (body, name, most) in [
            (wheel_body, "disc 1", wheel + quarter),
            (Layout::OUTPUT, "output shaft", output + quarter),
        ] {
            for sign in [1.0, -1.0] {
                let mut bodies = ideal(&gearbox);
                bodies[body].angle += sign * 0.99 * most;
                assert_eq!(guard::check(&gearbox, &bodies), Ok(()), "{name} {sets:?}");
                bodies[body].angle += sign * 0.02 * most;
                let line = guard::check(&gearbox, &bodies).unwrap_err();
                assert!(
                    line.contains(name) && line.contains("off its ideal"),
                    "{line}"
                );
            }
            let mut bodies = ideal(&gearbox);
            bodies[body].angle = f64::NAN;
            let line = guard::check(&gearbox, &bodies).unwrap_err();
            assert!(line.contains(name) && line.contains("not finite"), "{line}");
        }
    }
}
