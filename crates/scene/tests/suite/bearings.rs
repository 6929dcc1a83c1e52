//! Bearings of eccentrics and pins.

use pinwheel_scene::Scene;
use pinwheel_scene::bearings::BearingLaw;

fn with(bearing: &str) -> Scene {
    let mut scene = Scene::paper();
    scene.bearings.eccentric = Some(toml::from_str(bearing).unwrap());
    scene
}

/// Palmgren's formula by hand: 4 kN on 16 rollers of 9 mm give a secant of 5.9e8 N/m, and a tangent of 10/9 of it.
#[test]
fn published_palmgrens_rollers() {
    let law = BearingLaw::of(&with("rollers = 16\nroller_length_m = 0.009")).unwrap();
    let approach_mm = 7.68e-5 * (4.08_f64 * 4000.0 / 16.0).powf(0.9) / 9f64.powf(0.8);
    let offset = law.offset_under(4000.0);
    assert!(
        (offset / (1e-3 * approach_mm) - 1.0).abs() < 1e-12,
        "{offset}"
    );
    assert!((law.elastic(offset) / 4000.0 - 1.0).abs() < 1e-12);
    let secant = 4000.0 / offset;
    assert!((secant / 5.9e8 - 1.0).abs() < 0.01, "{secant}");
    let slope = law.slope_under(4000.0);
    assert!((slope / secant - 10.0 / 9.0).abs() < 1e-12, "{slope}");
}

#[test]
fn nothing_within_the_clearance_and_never_a_pull() {
    let law = BearingLaw::of(&with(
        "stiffness_n_m = 1e8\nclearance_m = 5e-6\ndamping_n_s_m = 100",
    ));
    let law = law.unwrap();
    assert_eq!(law.force(5e-6, 1.0), 0.0);
    assert_eq!(law.force(6e-6, 0.0), 1e8 * (6e-6 - 5e-6));
    assert_eq!(law.force(6e-6, -2.0), 0.0);
    assert!((law.stored(7e-6) / (0.5e8 * 4e-12) - 1.0).abs() < 1e-9);
}

/// By hand: a pin of 12 mm in a sleeve of 20 mm, and in the groove of a roller of 5.3 mm. The disc slides on a sleeve whose
/// contact has less friction, and on a fixed pin.
#[test]
fn regress_a_roller_rubs_on_no_more_than_itself_nor_than_the_disc_on_it() {
    let mut scene = Scene::paper();
    assert_eq!(scene.sleeve_drag(), None);
    let gear = &mut scene.gear;
    (gear.external_sleeve_radius_m, gear.internal_sleeve_radius_m) = (0.01, 0.00265);
    scene.bearings.sleeve_friction_coefficient = Some(0.05);
    scene.bearings.sleeve_bore_m = Some(0.012);
    let [external, internal] = scene.sleeve_drag().unwrap();
    assert!((external - 0.03).abs() < 1e-15);
    assert_eq!(internal, 0.05);
    scene.contact.friction_coefficient = 0.04;
    assert_eq!(scene.sleeve_drag().unwrap(), [external, 0.04]);
    scene.gear.external_sleeves_turn = false;
    assert_eq!(scene.sleeve_drag().unwrap(), [0.0, 0.04]);
}

#[test]
fn bad_input_half_a_bearing_says_what_it_lacks() {
    for (bearing, missing) in [
        ("clearance_m = 1e-6", "stiffness_n_m"),
        ("rollers = 9", "roller_length_m"),
        ("roller_length_m = 0.01", "rollers"),
        (
            "rollers = 9\nroller_length_m = 0.01\nexponent = 1.5",
            "exponent",
        ),
        ("rollers = 9\nstiffness_n_m = 1e8", "stiffness_n_m"),
        ("stiffness_n_m = 1e8\nbore_m = 0.02", "friction_coefficient"),
    ] {
        let fault = with(bearing).check().unwrap_err();
        assert!(fault.to_string().contains(missing), "{bearing}: {fault}");
    }
    assert!(with("stiffness_n_m = 1e8").check().is_ok());
}

/// Rollers so thin that g is nearly the requested ratio: ratings by the formulas of their sources.
#[test]
fn published_ratings_of_rollers() {
    // Factor f of table 7 of ISO 281:2007.
    for (g, factor) in [(0.01, 52.1), (0.02, 60.8), (0.1, 84.2), (0.3, 83.8)] {
        let roller = 0.01;
        let mut scene = with(&format!(
            "rollers = 10\nroller_length_m = 0.02\nroller_diameter_m = {roller}"
        ));
        scene.gear.eccentric_bore_radius_m = Some(0.5 * (roller / g + roller));
        let [still, turning] = scene.roller_ratings_n().unwrap();
        let by_table = factor * 20f64.powf(7.0 / 9.0) * 10f64.powf(0.75) * 10f64.powf(29.0 / 27.0);
        let off = turning / by_table - 1.0;
        assert!(off.abs() < 0.05 / factor * 1.01, "{g}: {off}");
        // 4000 MPa on the inner ring under 5 F/Z, by Hertz, steel of 207 GPa as in ISO/TR 10657.
        let (modulus, pressure) = (2.07e11 / (2.0 * 0.91), 4e9_f64);
        let curvature = 2.0 / roller + 2.0 / (roller / g - roller);
        let carried = pressure * pressure * std::f64::consts::PI * 0.02 / (modulus * curvature);
        let off = still / (10.0 / 5.0 * carried) - 1.0;
        assert!(off.abs() < 5e-3, "{g}: {off}");
    }
    assert_eq!(with("stiffness_n_m = 1e8").roller_ratings_n(), None);
}

#[test]
fn bad_input_rollers_that_do_not_fit() {
    let with = |roller: f64| {
        let text = format!("rollers = 19\nroller_length_m = 0.009\nroller_diameter_m = {roller}");
        let mut scene = with(&text);
        scene.gear.eccentric_bore_radius_m = Some(0.0165);
        scene.check()
    };
    let message = with(0.0047).unwrap_err().to_string();
    assert!(message.contains("give at most 0.004663 m"), "{message}");
    with(0.004_663).unwrap();
}
