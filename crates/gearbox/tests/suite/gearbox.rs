//! States and scales of a compiled gearbox.

use pinwheel_gearbox::contacts::{Kernel, contacts};
use pinwheel_gearbox::{Gearbox, Geometry};
use pinwheel_scene::scales::least_depth;
use pinwheel_scene::{Detection, Layout, Scene};

/// Every carried body starts with the velocity of its position on input or output.
#[test]
fn carried_bodies_start_with_their_carriers() {
    let sets = ["gear.wheels=3".parse().unwrap()];
    let gearbox = Gearbox::new(&Scene::load("eleven-pins", &sets).unwrap()).unwrap();
    let states = gearbox.kinematic_states();
    let layout = gearbox.layout;
    let pairs = (layout.wheel_bodies().map(|b| (b, Layout::INPUT)))
        .chain(layout.internal_bodies().map(|b| (b, Layout::OUTPUT)));
    for (body, carrier) in pairs {
        let (at, rate) = (states[body], states[carrier].rate);
        assert!((at.x.hypot(at.y)) > 1e-3 && rate != 0.0);
        let off = (at.vx + rate * at.y).hypot(at.vy - rate * at.x);
        assert!(off < 1e-15, "{at:?}");
    }
}

/// Without a load the scale of errors is a pin's penetration under the least force.
#[test]
fn scales_without_a_load_are_those_of_the_least_force() {
    let sets = ["drive.output_torque_n_m=0".parse().unwrap()];
    let gearbox = Gearbox::new(&Scene::load("paper", &sets).unwrap()).unwrap();
    let scales = gearbox.error_scales();
    let depth = least_depth(&gearbox.scene);
    assert!(
        (scales.length / depth - 1.0).abs() < 1e-12,
        "{scales:?} {depth}"
    );
    let gear = &gearbox.scene.gear;
    let lever = gear.eccentricity_m * gear.lobes() as f64;
    assert!((scales.angle * lever / depth - 1.0).abs() < 1e-12);
}

#[test]
fn bad_input_points_have_no_force_along_the_profile() {
    let mut scene = Scene::paper();
    scene.contact.detection = Detection::Points;
    scene.contact.law = "paper-conservative".to_owned();
    let geometry = Geometry::new(&scene).unwrap();
    let message = contacts(&scene, &geometry, Kernel::Lanes).map(|_| ());
    let message = message.unwrap_err().to_string();
    assert!(message.contains("detection = \"exact\""), "{message}");
}
