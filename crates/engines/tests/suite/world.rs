//! Bodies and joints in rapier.

use pinwheel_engines::rapier::world::*;
use pinwheel_gearbox::Gearbox;
use pinwheel_mbs::Wrench;
use pinwheel_scene::Layout;

/// Gearbox without forces: output and discs keep their rates, and joints stay closed.
#[test]
fn coasts_along_the_ideal_motion() {
    let gearbox = Gearbox::new(&pinwheel_scene::Scene::paper().clone().check().unwrap()).unwrap();
    let step_s = 1e-5;
    let mut world = World::new(&gearbox, step_s, 10);
    let loads = vec![Wrench::default(); gearbox.layout.bodies()];
    for _ in 0..2000 {
        world.load(&loads);
        world.advance(&()).unwrap();
    }
    let mut states = Vec::new();
    world.at_node(&mut states);
    let input = gearbox.scene.drive.input_speed_rad_s * 2000.0 * step_s;
    for (i, wheel) in gearbox.layout.wheel_bodies().enumerate() {
        let ideal = gearbox.geometry.ideal_wheel_angle(i, input);
        assert!((states[wheel].angle - ideal).abs() < 1e-9);
        let phase = gearbox.geometry.wheel_phases[i] + input;
        let e = gearbox.scene.gear.eccentricity_m;
        // rapier's joints are slightly soft: their drift in complete runs is 1e-9 m.
        assert!((states[wheel].x - e * phase.cos()).abs() < 2e-9);
        assert!((states[wheel].y - e * phase.sin()).abs() < 2e-9);
    }
    let output = states[Layout::OUTPUT].angle;
    assert!((output - gearbox.geometry.ideal_output_angle(input)).abs() < 1e-9);
    assert!(world.joint_drift() < 2e-9);
}

/// The first step has half of the load, so that positions follow t^2/2 exactly.
#[test]
fn constant_torque_gives_a_parabola_and_a_straight_rate() {
    let gearbox = Gearbox::new(&pinwheel_scene::Scene::paper().clone().check().unwrap()).unwrap();
    let step_s = 1e-4;
    let mut world = World::new(&gearbox, step_s, 10);
    let wheel = gearbox.layout.wheel_bodies().start;
    let start = gearbox.initial_states()[wheel];
    let mut loads = vec![Wrench::default(); gearbox.layout.bodies()];
    let torque = 0.01;
    loads[wheel].moment = torque;
    let acceleration = torque / gearbox.scene.mass.wheel.moment_kg_m2;
    let mut now = Vec::new();
    for step in 0..100 {
        let t = f64::from(step) * step_s;
        world.at_node(&mut now);
        let angle = start.angle + start.rate * t + 0.5 * acceleration * t * t;
        assert!(
            (now[wheel].angle - angle).abs() < 1e-7,
            "angle at step {step}"
        );
        let rate = start.rate + acceleration * t;
        assert!(
            (now[wheel].rate - rate).abs() < 1e-9,
            "extrapolated rate at step {step}"
        );
        world.load(&loads);
        world.advance(&()).unwrap();
        world.centre(&mut now);
        assert!(
            (now[wheel].rate - rate).abs() < 1e-9,
            "centred rate at step {step}"
        );
    }
}

#[test]
fn a_body_put_aside_is_named() {
    let gearbox = Gearbox::new(&pinwheel_scene::Scene::paper().clone().check().unwrap()).unwrap();
    let mut world = World::new(&gearbox, 1e-5, 10);
    let mut loads = vec![Wrench::default(); gearbox.layout.bodies()];
    loads[5].moment = f64::NAN;
    world.load(&loads);
    assert!(world.advance(&()).unwrap_err().contains("body 5"));
}

#[test]
fn angles_do_not_wrap() {
    assert!((unwrapped(-3.0, 3.2) - (std::f64::consts::TAU - 3.0)).abs() < 1e-15);
    assert!((unwrapped(0.1, -12.5) - (0.1 - 2.0 * std::f64::consts::TAU)).abs() < 1e-14);
}
