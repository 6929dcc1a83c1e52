//! Evaluating the contact forces allocates no memory, in either loop, with and without friction and points.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::Kernel;
use pinwheel_mbs::Wrench;
use pinwheel_scene::Scene;

#[test]
fn contact_forces_allocate_nothing() {
    for preset in [
        "paper",
        "paper-friction",
        "paper-rough",
        "backlash-0.6",
        "forty-pins",
    ] {
        for kernel in [Kernel::Lanes, Kernel::Scalar] {
            let mut gearbox = Gearbox::new(&Scene::load(preset, &[]).unwrap()).unwrap();
            gearbox.kernel = kernel;
            let mut field = gearbox.contact_field().unwrap();
            let mut bodies = gearbox.initial_states();
            for wheel in gearbox.layout.wheel_bodies() {
                bodies[wheel].angle += 3e-4 + 17.003 * gearbox.scene.gear.backlash_m;
            }
            let mut loads = vec![Wrench::default(); bodies.len()];
            let counted = allocation_counter::measure(|| {
                for _ in 0..100 {
                    loads.fill(Wrench::default());
                    field.add_loads(&bodies, &mut loads);
                }
            });
            assert_eq!(counted.count_total, 0, "{preset}, {kernel:?}");
            assert!(
                loads.iter().any(|load| load.fx != 0.0),
                "{preset}: nothing touches"
            );
        }
    }
}
