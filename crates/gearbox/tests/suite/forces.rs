//! Contact forces and the load as forces of the mechanism.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::{ContactField, PairContact};
use pinwheel_gearbox::internals::GearForces;
use pinwheel_gearbox::statics::Statics;
use pinwheel_mbs::{BodyState, Coordinates, Evaluation, Forces as _, Jacobian, Structure, Wrench};
use pinwheel_scene::{Layout, Override, Scene};

fn gearbox(sets: &[(&str, &str)]) -> Gearbox {
    let sets: Vec<Override> = sets.iter().map(|&(k, v)| Override::new(k, v)).collect();
    Gearbox::new(&Scene::load("paper", &sets).unwrap()).unwrap()
}

/// Returns the forces of the gear, and its contacts.
fn both(gearbox: &Gearbox) -> (GearForces, ContactField) {
    let forces = GearForces::new(gearbox).unwrap();
    (forces, gearbox.contact_field().unwrap())
}

/// Returns a pose under load, with rates at which contacts slide.
fn pose(gearbox: &Gearbox) -> Vec<BodyState> {
    let mut statics = Statics::new(gearbox).unwrap();
    let mut bodies = statics.solve(0.3, 22.0).unwrap().bodies;
    for (k, body) in bodies.iter_mut().enumerate().skip(1) {
        body.rate += (k % 5) as f64 - 2.0;
    }
    bodies
}

/// Listed friction plus the remaining loads gives the total, pair by pair.
#[test]
fn loads_are_friction_and_the_rest() {
    for law in ["paper", "paper-conservative"] {
        let gearbox = gearbox(&[
            ("contact.friction_coefficient", "0.1"),
            ("contact.law", law),
        ]);
        let bodies = pose(&gearbox);
        let (mut forces, mut field) = both(&gearbox);
        let zeros = vec![Wrench::default(); bodies.len()];
        let (mut loads, mut again, mut rest) = (zeros.clone(), zeros.clone(), zeros);
        let mut contacts = Vec::new();
        forces.apply(0.1, &bodies, &mut loads);
        let mut request = Evaluation::of_loads(&mut again).with_energy();
        forces.evaluate(0.1, &bodies, &mut request);
        let energy = request.energy.unwrap();
        assert_eq!(loads, again);
        let known = field.energy(&bodies);
        assert!((energy.stored_j / known.stored_j - 1.0).abs() < 1e-12);
        assert!((energy.friction_w() / known.friction_w() - 1.0).abs() < 1e-9);
        forces.apply_without_friction(0.1, &bodies, &mut rest, &mut contacts);
        let mut pairs: Vec<PairContact> = Vec::new();
        field.touching(&bodies, &mut |pair| pairs.push(*pair));
        assert!(contacts.len() > 10 && contacts.len() == pairs.len());
        for (k, pair) in pairs.iter().enumerate() {
            let again = forces.normal_force(k, f64::NAN, pair.normal_rate_m_s);
            assert!((again - pair.normal_force_n).abs() < 1e-12 * pair.normal_force_n);
            assert!(forces.normal_force(k, f64::NAN, pair.normal_rate_m_s + 1.0) > again);
        }
        assert_eq!(forces.normal_force(pairs.len(), 7.0, 0.0), 7.0);
        for (contact, pair) in contacts.iter().zip(&pairs) {
            let [nx, ny] = contact.normal;
            let drag = [-pair.friction_force_n * ny, pair.friction_force_n * nx];
            for (body, sign) in contact.bodies.into_iter().zip([1.0, -1.0]) {
                let (at, [fx, fy]) = (bodies[body], drag.map(|f| sign * f));
                let load = &mut rest[body];
                load.fx += fx;
                load.fy += fy;
                load.moment += (contact.point[0] - at.x) * fy - (contact.point[1] - at.y) * fx;
            }
        }
        for (loads, rest) in loads.iter().zip(&rest) {
            let off = (loads.fx - rest.fx).hypot(loads.fy - rest.fy);
            assert!(off < 1e-8, "{law}: {loads:?} {rest:?}");
            assert!(
                (loads.moment - rest.moment).abs() < 1e-9,
                "{law}: {loads:?} {rest:?}"
            );
        }
    }
}

/// The load and its rate are those of the present segment.
#[test]
fn loads_follow_their_leg() {
    let gearbox = gearbox(&[
        ("drive.load_ramp_s", "0.01"),
        ("drive.output_torque_n_m", "20"),
        (
            "drive.load_changes",
            "[{ time_s = 0.03, output_torque_n_m = 5.0, ramp_s = 0.01 }]",
        ),
    ]);
    let bodies = pose(&gearbox);
    let (mut forces, mut field) = both(&gearbox);
    let mut torque = |forces: &mut GearForces, time: f64| {
        let (mut loads, mut idle) = (vec![Wrench::default(); bodies.len()], Vec::new());
        idle.resize(bodies.len(), Wrench::default());
        forces.apply(time, &bodies, &mut loads);
        field.add_loads(&bodies, &mut idle);
        loads[Layout::OUTPUT].moment - idle[Layout::OUTPUT].moment
    };
    assert!((torque(&mut forces, 0.005) - 10.0).abs() < 1e-12);
    assert!((torque(&mut forces, 0.03) - 20.0).abs() < 1e-12);
    assert_eq!(forces.segment_s(), 0.0);
    let structure = Structure::SecondOrder {
        is_leaf: vec![false; 3],
    };
    let derivatives = |forces: &mut GearForces, time: f64| {
        let mut derivatives = Jacobian::new(&structure, 6);
        let coordinates = Coordinates::new(bodies.len(), &[1, 2, 3], &[]);
        let mut request = Evaluation::of_derivatives(&mut derivatives, &coordinates);
        assert!(forces.have_derivatives());
        forces.evaluate(time, &bodies, &mut request);
        derivatives.time
    };
    let (rising, risen) = (
        derivatives(&mut forces, 0.005),
        derivatives(&mut forces, 0.02),
    );
    assert!(
        (rising[0] - risen[0] - 2000.0).abs() < 1e-6,
        "{rising:?} {risen:?}"
    );
    assert_eq!(rising[1..], risen[1..]);
    forces.restart_at(0.03);
    assert!((torque(&mut forces, 0.03) - 20.0).abs() < 1e-12);
    assert!((torque(&mut forces, 0.05) - 5.0).abs() < 1e-12);
    assert_eq!(forces.segment_s(), 0.03);
    let (falling, fallen) = (
        derivatives(&mut forces, 0.031),
        derivatives(&mut forces, 0.05),
    );
    assert!(
        (falling[0] - fallen[0] + 1500.0).abs() < 1e-6,
        "{falling:?}"
    );
}
