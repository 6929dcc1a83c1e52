//! Gears driven by an importer.

use pinwheel_gearbox::cosimulation::{CoSimulation, Prescribed, Setup, start};
use pinwheel_gearbox::internals::GearForces;
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_mbs::{Coordinates, Evaluation, Forces as _, Jacobian, Structure};
use pinwheel_scene::Scene;

const SPEED: f64 = 52.34;

fn gearbox(sets: &[&str], channels: &[&str]) -> Gearbox {
    let sets: Vec<_> = sets.iter().map(|set| set.parse().unwrap()).collect();
    let mut scene = Scene::load("paper", &sets).unwrap().into_scene();
    scene.drive.input_speed_rad_s = SPEED;
    scene.output.channels = channels.iter().map(|&c| c.to_owned()).collect();
    Gearbox::new(&scene.check().unwrap()).unwrap()
}

/// Returns the columns of a run's last sample.
fn last(gearbox: &Gearbox) -> Vec<f64> {
    let run = native::run(gearbox, &mut |_| false)
        .unwrap()
        .finished()
        .unwrap();
    let channels = run.time_series.channels().iter();
    channels.map(|c| *c.values.last().unwrap()).collect()
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = b.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs() / largest);
    // A NaN does not count as small.
    off.fold(0.0, |most: f64, off| if off <= most { most } else { off })
}

/// A constant torque from 10 ms on acts like a change of the scene's load, and is reported with it.
#[test]
fn a_held_torque_is_a_change_of_the_load() {
    for method in ["dopri5", "etd-adams"] {
        let integrator = format!("solver.integrator=\"{method}\"");
        let own = [
            "solver.tolerance=1e-9",
            "solver.duration_s=0.02",
            &integrator,
        ];
        let mut sets = own.to_vec();
        sets.push("drive.load_changes=[{ time_s = 0.01, output_torque_n_m = 40.0 }]");
        let expected = last(&gearbox(&sets, &[]));
        let gear = gearbox(&own, &[]);
        let mut unit = CoSimulation::new(&gear, Setup::of(&gear.scene.drive)).unwrap();
        unit.advance(0.01, &|| false).unwrap();
        let steps = unit.counts().steps;
        unit.prescribe([(SPEED, 0.0), (0.0, 0.0)]);
        assert_eq!(unit.counts().steps, steps, "nothing has changed");
        let mut row = Vec::new();
        assert_eq!(unit.observe(&mut row).load_torque_n_m, 22.0);
        unit.prescribe([(SPEED, 0.0), (18.0, 0.0)]);
        assert_eq!(unit.counts().steps, 0, "the method begins anew");
        assert_eq!(unit.observe(&mut row).load_torque_n_m, 40.0);
        unit.advance(0.02, &|| false).unwrap();
        unit.observe(&mut row);
        let off = apart(&row, &expected);
        eprintln!("{method} {off:e}");
        assert!(off < 1e-5, "{method}: {off:e}");
    }
}

/// A ramp of the prescribed speed acts like a change of the scene's speed. The unit uses differences for its derivatives.
#[test]
fn a_ramp_of_the_speed_is_a_change_of_the_scenes() {
    let own = [
        "solver.tolerance=1e-9",
        "solver.duration_s=0.02",
        "solver.integrator=\"dopri5\"",
    ];
    let change =
        "drive.speed_changes=[{ time_s = 0.01, input_speed_rad_s = 72.34, ramp_s = 0.01 }]";
    let changed = gearbox(&[&own[..], &[change]].concat(), &[]);
    let refused = CoSimulation::new(&changed, Setup::of(&changed.scene.drive)).err();
    assert!(refused.is_some_and(|error| error.to_string().contains("the importer prescribes")));
    let gear = gearbox(&own, &[]);
    let mut unit = CoSimulation::new(&gear, Setup::of(&gear.scene.drive)).unwrap();
    unit.advance(0.01, &|| false).unwrap();
    unit.prescribe([(SPEED, 2000.0), (0.0, 0.0)]);
    unit.advance(0.02, &|| false).unwrap();
    let mut row = Vec::new();
    unit.observe(&mut row);
    let expected = last(&changed);
    // At the end of the ramp the run's driver accelerates nothing.
    row[0] -= changed.accelerating_torque_n_m(0.015);
    let off = apart(&row, &expected);
    eprintln!("{off:e}");
    assert!(off < 1e-6, "{off:e}");
}

/// A unit starts with the prescribed load and speed, like a gear with these values.
#[test]
fn starts_are_those_of_the_load_and_the_speed() {
    let gear = gearbox(&["drive.start=equilibrium"], &[]);
    let usual = Setup::of(&gear.scene.drive);
    for (speed, torque) in [(SPEED, 0.0), (SPEED, 10.0), (20.0, 0.0), (20.0, 10.0)] {
        let setup = Setup {
            speeds_rad_s: [speed, 0.0],
            torque_n_m: torque,
            ..usual
        };
        let load = format!("drive.output_torque_n_m={}", 22.0 + torque);
        let mut scene = gearbox(&["drive.start=equilibrium", &load], &[])
            .scene
            .into_scene();
        scene.drive.input_speed_rad_s = speed;
        let other = Gearbox::new(&scene.check().unwrap()).unwrap();
        assert_eq!(start(&gear, &setup).unwrap(), other.initial_states());
    }
}

/// Channels of a unit equal those of a run, including forces of joints; rows without channels are the contract's only.
#[test]
fn channels_are_those_of_a_run() {
    let sets = ["solver.duration_s=0.002", "solver.tolerance=1e-8"];
    for channels in [
        &["eccentric_bearing_*", "transmission_error_arcmin"][..],
        &[],
    ] {
        let gear = gearbox(&sets, channels);
        let mut unit = CoSimulation::new(&gear, Setup::of(&gear.scene.drive)).unwrap();
        let mut row = Vec::new();
        unit.advance(0.002, &|| false).unwrap();
        unit.observe(&mut row);
        let off = apart(&row, &last(&gear));
        assert!(off < 1e-5, "{off:e}");
    }
}

/// Derivatives of constant and rising torques, beside those of the gear.
#[test]
fn held_torques_have_slopes() {
    let gear = gearbox(&[], &[]);
    let structure = Structure::SecondOrder {
        is_leaf: vec![false; 3],
    };
    let bodies = gear.initial_states();
    let by_time = |slope: f64, usual: bool| {
        let mut forces = GearForces::new(&gear).unwrap();
        (forces.held[1].slope, forces.speed_in_torque_out) = (slope, usual);
        let mut derivatives = Jacobian::new(&structure, 6);
        let coordinates = Coordinates::new(bodies.len(), &[1, 2, 3], &[]);
        let known = forces.have_derivatives();
        if known {
            let mut request = Evaluation::of_derivatives(&mut derivatives, &coordinates);
            forces.evaluate(0.1, &bodies, &mut request);
        }
        known.then(|| derivatives.time[0])
    };
    let (level, rising) = (by_time(0.0, true).unwrap(), by_time(500.0, true).unwrap());
    assert!((rising - level - 500.0).abs() < 1e-9, "{level} {rising}");
    assert_eq!(by_time(500.0, false), None);
}

/// An importer's tolerance is used by the method.
#[test]
fn tolerances_are_those_asked_for() {
    let gear = gearbox(&["solver.integrator=auto"], &[]);
    let setup = Setup {
        tolerance: Some(1e-7),
        ..Setup::of(&gear.scene.drive)
    };
    let unit = CoSimulation::new(&gear, setup).unwrap();
    let tolerance = unit.method().1;
    assert!((tolerance / 1e-7 - 1.0).abs() < 1e-9, "{tolerance:e}");
}

/// States of equal length for other shafts are refused without a change.
#[test]
fn bad_input_states_of_other_shafts_are_refused() {
    let two = gearbox(&[], &[]);
    let three = gearbox(&["gear.wheels=3"], &[]);
    let mut usual = CoSimulation::new(&two, Setup::of(&two.scene.drive)).unwrap();
    let both = Setup {
        output: Prescribed::BySpeed,
        speeds_rad_s: [SPEED, -SPEED / 15.0],
        ..Setup::of(&three.scene.drive)
    };
    let mut prescribed = CoSimulation::new(&three, both).unwrap();
    let (of_usual, of_held) = (usual.save(), prescribed.save());
    // The number of states follows the time.
    assert_eq!(of_usual[..9], of_held[..9]);
    assert!(!usual.restore(&of_held) && !prescribed.restore(&of_usual));
    assert_eq!((usual.save(), prescribed.save()), (of_usual, of_held));
}
