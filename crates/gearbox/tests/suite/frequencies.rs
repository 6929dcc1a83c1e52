//! Frequencies that limit steps.

use std::f64::consts::TAU;

use pinwheel_gearbox::{Frequencies, friction_rate};
use pinwheel_scene::{Scene, scales};

/// Modes of the paper's gear are 1740, 1660 and 530 Hz, by the eigenvalues of its Jacobian at the load.
#[test]
fn the_papers_fastest_mode() {
    let modes = Frequencies::of(&Scene::paper());
    let hertz = modes.contact_rad_s / TAU;
    assert!((hertz / 1740.0 - 1.0).abs() < 0.3, "{hertz}");
    assert!((modes.mesh_rad_s / (52.34 * 16.0) - 1.0).abs() < 1e-12);
    assert_eq!(modes.friction_1_s, 0.0);
}

/// A third of a touch at the contacts' frequency, or an eighth of the time from pin to pin, of the kind that passes more often.
#[test]
fn steps_see_every_sleeve() {
    let mut scene = Scene::paper();
    let modes = Frequencies::of(&scene);
    assert_eq!(modes.longest_step_s(), 1.0 / modes.contact_rad_s);
    scene.drive.input_speed_rad_s *= -100.0;
    scene.gear.internal_sleeves = 30;
    let fast = Frequencies::of(&scene);
    assert!((fast.mesh_rad_s / (5234.0 * 16.0 * 2.0) - 1.0).abs() < 1e-12);
    assert!((fast.longest_step_s() * fast.mesh_rad_s * 8.0 / TAU - 1.0).abs() < 1e-12);
    scene.drive.input_speed_rad_s = 0.0;
    assert_eq!(
        Frequencies::of(&scene).longest_step_s(),
        1.0 / fast.contact_rad_s
    );
}

/// Each disc carries its part of the load, which matters for a law with another power than Hertz'.
#[test]
fn depths_are_those_of_one_wheel() {
    let share = |wheels: usize, load: f64| {
        let mut scene = Scene::paper();
        scene.contact.law = "line-contact".to_owned();
        (scene.gear.wheels, scene.drive.output_torque_n_m) = (wheels, load);
        Frequencies::depth_share(&scene)
    };
    assert_eq!(share(2, 44.0), share(1, 22.0));
    assert!((share(2, 22.0) / share(1, 22.0) - 1.0).abs() > 0.1);
    let hertz = Frequencies::depth_share(&Scene::paper());
    assert!((hertz - 1.0).abs() < 1e-12, "{hertz}");
}

/// By hand: 6.5e5 1/s for a pin of the paper at 100 N; the static 65 N give two thirds of it.
#[test]
fn friction_rate_of_the_paper() {
    let mut scene = Scene::paper();
    scene.contact.friction_coefficient = 0.1;
    let rate = friction_rate(&scene);
    assert!((rate / 6.5e5 - 1.0).abs() < 0.5, "{rate}");
    // Nearly massless pins determine it, of either kind.
    for kind in [true, false] {
        let mut scene = scene.clone();
        let (gear, mass) = (&scene.gear, &mut scene.mass);
        let (body, radius, force) = if kind {
            let force = scales::external_force(gear, 11.0);
            (
                &mut mass.external_sleeve,
                gear.external_sleeve_radius_m,
                force,
            )
        } else {
            let force = scales::internal_force(gear, 11.0);
            (
                &mut mass.internal_sleeve,
                gear.internal_sleeve_radius_m,
                force,
            )
        };
        body.moment_kg_m2 *= 1e-3;
        let wanted =
            0.1 * force * radius * radius / (scene.contact.friction_ramp_m_s * body.moment_kg_m2);
        let rate = friction_rate(&scene);
        assert!((rate / wanted - 1.0).abs() < 1e-12, "{rate} {wanted}");
    }
}
