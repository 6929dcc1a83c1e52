//! Implicit friction of contacts listed in lanes against that of contacts listed one by one.

use pinwheel_gearbox::contacts::Kernel;
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_scene::{Override, Scene};

fn columns(scene: &Scene, kernel: Kernel) -> Vec<Vec<f64>> {
    let mut gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
    gearbox.kernel = kernel;
    let run = native::run(&gearbox, &mut |_| false)
        .unwrap()
        .finished()
        .unwrap();
    let channels = run.time_series.channels().iter();
    channels.map(|channel| channel.values.clone()).collect()
}

/// Two hundred stages with many contacts that begin and cease to slide. Measured: at most 7e-12 of the largest value (rounding
/// of positions and velocities, which the ramps of friction and damping convert to force).
#[test]
fn lanes_equal_contact_by_contact() {
    let none: &[(&str, &str)] = &[];
    let cases = [
        ("paper-friction", "0.002", "2", none),
        ("paper-friction", "0.001", "1", none),
        ("paper-friction", "0.001", "4", none),
        ("forty-pins", "0.001", "2", none),
        ("backlash-0.6", "0.002", "2", none),
        // Complete registers of pins separate and touch again.
        (
            "forty-pins",
            "0.006",
            "2",
            &[("drive.input_speed_rad_s", "600")],
        ),
        // A force along the profile.
        (
            "paper-friction",
            "0.001",
            "2",
            &[("contact.law", "paper-conservative")],
        ),
    ];
    for (preset, duration, wheels, more) in cases {
        let sets = [
            ("solver.integrator", "imex2"),
            ("solver.duration_s", duration),
            ("solver.step_s", "1e-5"),
            ("contact.friction_coefficient", "0.1"),
            ("gear.wheels", wheels),
        ];
        let sets = sets.iter().chain(more);
        let sets: Vec<Override> = sets.map(|&(k, v)| Override::new(k, v)).collect();
        let scene = Scene::load(preset, &sets).unwrap();
        let (fast, slow) = (
            columns(&scene, Kernel::Lanes),
            columns(&scene, Kernel::Scalar),
        );
        let mut worst: f64 = 0.0;
        for (a, b) in fast.iter().zip(&slow) {
            let largest = b.iter().fold(1e-3_f64, |m, x| m.max(x.abs()));
            for (a, b) in a.iter().zip(b) {
                worst = worst.max((a - b).abs() / largest);
            }
        }
        println!("{preset}, {wheels} discs, {more:?}: {worst:.1e}");
        assert!(worst < 1e-10, "{preset}, {wheels} discs: {worst:e}");
    }
}
