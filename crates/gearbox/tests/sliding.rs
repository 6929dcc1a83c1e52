//! Implicit friction in lanes against the contact-by-contact way through `pinwheel_mbs::sliding`, its oracle.

use pinwheel_gearbox::contacts::{ContactField, Kernel};
use pinwheel_gearbox::statics::Statics;
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_mbs::sliding::RateStage;
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::{Override, Scene};

fn columns(scene: &Scene, kernel: Kernel) -> Vec<Vec<f64>> {
    let mut gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
    gearbox.kernel = kernel;
    let run = native::run(&gearbox, &mut |_| false)
        .unwrap()
        .whole()
        .unwrap();
    let channels = run.courses.channels().iter();
    channels.map(|channel| channel.values.clone()).collect()
}

/// Two hundred stages with many contacts that begin and cease to slide. Measured: at most 7e-12 of the largest value
/// (rounding of positions and velocities, which the ramps of friction and damping turn into force).
#[test]
fn lanes_equal_contact_by_contact() {
    let none: &[(&str, &str)] = &[];
    let cases = [
        ("paper-friction", "0.002", "2", none),
        ("paper-friction", "0.001", "1", none),
        ("paper-friction", "0.001", "4", none),
        ("forty-pins", "0.001", "2", none),
        ("backlash-0.6", "0.002", "2", none),
        // Whole registers of sleeves part and touch again.
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
        println!("{preset}, {wheels} wheels, {more:?}: {worst:.1e}");
        assert!(worst < 1e-10, "{preset}, {wheels} wheels: {worst:e}");
    }
}

/// A stage of `field` at these states: rates and accelerations, and the loads without friction.
fn stage(
    field: &mut dyn ContactField,
    bodies: &[BodyState],
) -> (Vec<f64>, Vec<f64>, Vec<f64>, Vec<Wrench>) {
    let free = &bodies[1..];
    let mut rates: Vec<f64> = free.iter().map(|b| b.rate).collect();
    let inertia = vec![1e-3; free.len()];
    let (mut explicit, mut implicit) = (vec![0.0; free.len()], vec![0.0; free.len()]);
    let mut loads = vec![Wrench::default(); bodies.len()];
    let mut stage = RateStage {
        a: 1e-5,
        rates: &mut rates,
        inertia: &inertia,
        explicit: &mut explicit,
        implicit: &mut implicit,
        newton_steps: 0,
    };
    assert_eq!(
        field.solve_friction(bodies, &mut loads, &mut stage),
        Some(true)
    );
    (rates, explicit, implicit, loads)
}

/// Contacts of the stage before leave nothing behind, those on the other side of the gear neither.
#[test]
fn a_stage_forgets_the_one_before() {
    let sets = ["contact.friction_coefficient=0.1", "gear.wheels=3"];
    let sets = sets.map(|set| set.parse().unwrap());
    let mut gearbox = Gearbox::new(&Scene::load("forty-pins", &sets).unwrap()).unwrap();
    let mut statics = Statics::new(&gearbox).unwrap();
    let mut poses = [0.3, 2.4].map(|phi| statics.solve(phi, 22.0).unwrap().bodies);
    for bodies in &mut poses {
        for (k, body) in bodies.iter_mut().enumerate().skip(1) {
            body.rate += (k % 5) as f64 - 2.0;
        }
    }
    for kernel in [Kernel::Lanes, Kernel::Avx2, Kernel::Portable] {
        gearbox.kernel = kernel;
        let [mut used, mut fresh] = [(); 2].map(|()| gearbox.contact_field().unwrap());
        let first = stage(used.as_mut(), &poses[0]);
        let then = stage(used.as_mut(), &poses[1]);
        let alone = stage(fresh.as_mut(), &poses[1]);
        assert_ne!(first.0, then.0);
        assert_eq!(then, alone, "{kernel:?}");
    }
}
