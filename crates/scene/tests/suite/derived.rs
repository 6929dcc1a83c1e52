//! Figures that follow from a scene.

use std::f64::consts::TAU;

use pinwheel_scene::{Scene, derived};

/// Figures of an independent program for the gear of the paper.
#[test]
fn the_papers_figures() {
    let mut scene = Scene::paper();
    scene.drive.input_speed_rad_s = 500.0 / 60.0 * TAU;
    scene.gear.backlash_m = 1e-3;
    let figures = derived(&scene);
    let near = |value: f64, wanted: f64, digits: f64| {
        assert!(
            (value - wanted).abs() <= 0.5 * digits,
            "{value} is not {wanted}"
        );
    };
    near(figures.pitch_radius_m, 0.064, 1e-12);
    near(figures.tip_curvature_radius_m, 9.1607e-3, 1e-7);
    near(figures.pit_curvature_radius_m, -6.5647e-3, 1e-7);
    near(figures.smallest_convex_radius_m, 13.122_58e-3, 1e-8);
    near(figures.free_play_rad, 17.003e-3, 1e-6);
    near(figures.ideal_input_torque_n_m, 1.466_67, 1e-5);
    near(figures.external_force_estimate_n, 65.5, 0.1);
    let hertz: Vec<f64> = figures.frequencies.iter().map(|f| f.hertz).collect();
    for (value, wanted) in hertz.into_iter().zip([8.333, 8.889, 71.111, 133.333]) {
        near(value, wanted, 1e-3);
    }
    assert!(figures.external_ripple_in_phase && figures.internal_ripple_in_phase);
}
