//! The joint that `pinwheel design` writes, in MuJoCo beside the whole gear: same input, same course of the load.

use std::fmt::Write as _;
use std::process::Command;
use std::sync::atomic::AtomicBool;

use pinwheel_engines::python::{ENGINES, environment};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{LoadChange, Scales, Start};
use pinwheel_studies::{Control, design};
use pinwheel_tests::repository;

use super::*;

/// The load goes from half of the rated one to all of it and, through the free play, to half of it the other way; the input
/// turns. RMS of the joint's output angle less the gear's, over the RMS of the gear's twist. Measured: see docs/design.md.
#[test]
fn crossval_joint_follows_the_gear() {
    let environment =
        environment(ENGINES, &AtomicBool::new(false)).unwrap_or_else(|e| panic!("{e}"));
    for (preset, limit) in [
        ("paper", 1.0),
        ("backlash-0.6", 1.0),
        ("steel", 1.0),
        ("modified", 1.0),
    ] {
        let rated = scene(preset, &[]);
        let period = std::f64::consts::TAU / Scales::of(&rated).modes_rad_s[0];
        let load = rated.drive.output_torque_n_m;
        let mut course = rated.clone();
        let to = |periods: f64, share: f64| LoadChange {
            time_s: periods * period,
            output_torque_n_m: share * load,
            ramp_s: 2.0 * period,
        };
        course.drive.start = Start::Equilibrium;
        course.drive.load_ramp_s = 0.0;
        course.drive.output_torque_n_m = 0.5 * load;
        course.drive.load_changes = vec![to(10.0, 1.0), to(20.0, -0.5)];
        course.solver.duration_s = 40.0 * period;
        course.solver.sample_s = period / 40.0;
        course.solver.integrator = "auto".to_owned();
        let gearbox = |scene: &Scene| Gearbox::new(&scene.clone().check().unwrap()).unwrap();
        let found = design::run(&gearbox(&rated), false, &Control::quiet()).unwrap();
        let joint = found.joint.unwrap();
        let courses = run("native", &course);
        let (gear, speed) = (gearbox(&course), rated.drive.input_speed_rad_s);
        let output = courses.channel("output_angle_rad").unwrap();
        let mut table =
            "time_s,input_angle_rad,input_rate_rad_s,load_n_m,output_angle_rad\n".to_owned();
        for (t, psi) in courses.time_s().iter().zip(output) {
            let torque = gear.load_torque(*t);
            writeln!(table, "{t},{},{speed},{torque},{psi}", speed * t).unwrap();
        }
        let dir = tempfile::tempdir().unwrap();
        let [model, csv] = ["joint_mujoco.xml", "courses.csv"].map(|name| dir.path().join(name));
        std::fs::write(&model, joint.mjcf()).unwrap();
        std::fs::write(&csv, table).unwrap();
        let run = Command::new(&environment.python)
            .arg(repository("python/references/mujoco_joint.py"))
            .args([&model, &csv])
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .output()
            .unwrap();
        let complaint = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{complaint}");
        let answer: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        let angles = answer["output_angle_rad"].as_array().unwrap();
        let twists = output
            .iter()
            .zip(courses.time_s())
            .map(|(psi, t)| psi - speed * t / joint.ratio);
        let rms = |values: &[f64]| {
            (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
        };
        let twist = rms(&twists.collect::<Vec<_>>());
        let apart = angles.iter().zip(output);
        let apart = rms(&apart
            .map(|(a, b)| a.as_f64().unwrap() - b)
            .collect::<Vec<_>>());
        const ARCMIN: f64 = 10_800.0 / std::f64::consts::PI;
        println!(
            "{preset}: MuJoCo {} is {:.3} arcmin off where the gear twists by {:.3} (RMS)",
            answer["version"],
            ARCMIN * apart,
            ARCMIN * twist
        );
        assert_within(preset, apart / twist, limit);
    }
}
