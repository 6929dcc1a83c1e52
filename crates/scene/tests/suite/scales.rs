//! Characteristic sizes of a gear.

use pinwheel_scene::{Scales, Scene};

/// Modes of the paper's gear by an independent eigenvalue solution under its load: 530, 1660 and 1740 Hz.
#[test]
fn the_papers_modes() {
    let scales = Scales::of(&Scene::paper());
    let [slow, fast] = scales.modes_rad_s.map(|rate| rate / std::f64::consts::TAU);
    assert!((slow / 530.0 - 1.0).abs() < 0.3, "{slow}");
    assert!((fast / 1740.0 - 1.0).abs() < 0.3, "{fast}");
    let settled = scales.settling_s(8.0).unwrap();
    assert!((0.1..0.4).contains(&settled), "{settled}");
}

/// A hundred times the Hertzian stiffness, and a law with another stiffness.
#[test]
fn the_law_decides() {
    let mut scene = Scene::paper();
    let [_, soft] = Scales::of(&scene).modes_rad_s;
    scene.contact.stiffness_multiplier = 1.0;
    // k grows with K^(2/3) at a given force.
    let [_, stiff] = Scales::of(&scene).modes_rad_s;
    assert!((stiff / soft - 100.0_f64.powf(1.0 / 3.0)).abs() < 1e-9);
    scene.contact.law = "line-contact".to_owned();
    assert!(Scales::of(&scene).modes_rad_s[1] > 1.5 * stiff);
}

/// Lengths, masses, times and forces of a gear scaled together keep every ratio.
#[test]
fn similar_gears_have_similar_scales() {
    for load in [22.0, 0.0] {
        let mut scene = Scene::paper();
        scene.drive.output_torque_n_m = load;
        let one = Scales::of(&scene);
        let (length, mass, time) = (0.1, 1e-4, 0.5);
        let gear = &mut scene.gear;
        gear.eccentricity_m *= length;
        gear.external_sleeve_radius_m *= length;
        gear.internal_sleeve_radius_m *= length;
        gear.internal_circle_radius_m *= length;
        gear.hole_radius_m *= length;
        let force = mass * length / (time * time);
        scene.mass.wheel.moment_kg_m2 *= mass * length * length;
        scene.mass.output_shaft.moment_kg_m2 *= mass * length * length;
        scene.mass.internal_sleeve.mass_kg *= mass;
        scene.drive.output_torque_n_m *= force * length;
        scene.contact.young_pa *= force / (length * length);
        let other = Scales::of(&scene);
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        near(other.penetration_m, one.penetration_m * length);
        near(other.external_force_n, one.external_force_n * force);
        for k in 0..2 {
            near(other.modes_rad_s[k], one.modes_rad_s[k] / time);
        }
    }
}
