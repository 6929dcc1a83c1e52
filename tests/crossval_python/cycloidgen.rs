//! Statics against the Python package cycloidgen, live: closed forms pose by pose, the recording, and the solver.
//!
//! It runs in a small environment of its own, so that the one of the engines does not grow by what only this test needs.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use pinwheel_engines::python::{Requirements, environment};
use pinwheel_gearbox::statics::{LinearMesh, LinearOutput, Statics};
use pinwheel_gearbox::{Gearbox, Sleeve};
use serde_json::Value;

use super::*;

const CYCLOIDGEN: Requirements = Requirements {
    name: "cycloidgen",
    file: "python/requirements-cycloidgen.txt",
    text: include_str!("../../python/requirements-cycloidgen.txt"),
    only_listed: true,
};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn recording() -> Vec<toml::Table> {
    let text = include_str!("../../reference/published/cycloidgen.toml");
    let table: toml::Table = text.parse().unwrap();
    let gears = table["gear"].as_array().unwrap();
    gears
        .iter()
        .map(|gear| gear.as_table().unwrap().clone())
        .collect()
}

/// What the package says of the recorded gears, computed once.
fn live() -> &'static [Value] {
    static LIVE: OnceLock<Vec<Value>> = OnceLock::new();
    LIVE.get_or_init(|| {
        let environment =
            environment(CYCLOIDGEN, &AtomicBool::new(false)).unwrap_or_else(|e| panic!("{e}"));
        let root = repository();
        let scenes = recording().into_iter().map(|gear| {
            let name = gear["scene"].as_str().unwrap();
            root.join(format!("reference/scenes/{name}.toml"))
        });
        let run = Command::new(environment.python)
            .arg(root.join("python/references/cycloidgen_loads.py"))
            .args(scenes)
            .env("PYTHONPATH", root.join("python"))
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .output()
            .unwrap();
        let complaint = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{complaint}");
        serde_json::from_slice(&run.stdout).unwrap()
    })
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|v| v.as_f64().unwrap()).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The package counts sleeves the other way round: its sleeve k is our zk - k.
fn mirrored(value: &Value) -> Vec<f64> {
    let mut values = numbers(value);
    values[1..].reverse();
    values
}

/// Largest difference over the largest value.
fn off(found: &[f64], wanted: &[f64]) -> f64 {
    assert_eq!(found.len(), wanted.len());
    let size = wanted.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let pairs = found.iter().zip(wanted);
    pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / size
}

/// Today's package on today's numpy gives what was recorded. Measured: equal, but for the last digits.
#[test]
fn crossval_cycloidgen_gives_what_was_recorded() {
    let mut worst = 0.0_f64;
    for (recorded, live) in recording().iter().zip(live()) {
        let live = live.as_object().unwrap();
        assert_eq!(
            recorded.len() + 2,
            live.len(),
            "all but ring and output is recorded"
        );
        for (key, recorded) in recorded {
            let recorded = serde_json::to_value(recorded).unwrap();
            match &live[key] {
                Value::Array(_) => {
                    let error = off(&numbers(&live[key]), &numbers(&recorded));
                    assert!(error < 1e-13, "{key}: {} {recorded}", live[key]);
                    worst = worst.max(error);
                }
                other => assert_eq!(*other, recorded, "{key}"),
            }
        }
    }
    println!("live against recorded: {worst:.1e}");
}

/// Levers, forces, bearing force and torque equivalence of every pose, both stages.
#[test]
fn crossval_cycloidgen_closed_forms() {
    for live in live() {
        let name = live["scene"].as_str().unwrap();
        let gear = scene(name, &[]).gear;
        let (mesh, output) = (LinearMesh::of(&gear), LinearOutput::of(&gear));
        let torque = number(&live["wheel_torque_n_m"]);
        let zk = gear.external_sleeves;
        let mut worst = [0.0_f64; 5];
        let ring = live["ring"].as_array().unwrap();
        assert_eq!(ring.len(), 48);
        for pose in ring {
            let phi = number(&pose["phi"]);
            let levers: Vec<f64> = (0..zk)
                .map(|k| mesh.lever(TAU * k as f64 / zk as f64 - phi))
                .collect();
            let bearing = numbers(&pose["bearing_n"]);
            let ours = mesh.bearing(-phi, torque);
            let across = torque / (gear.eccentricity_m * (zk as f64 - 1.0));
            let found = [
                off(&levers, &mirrored(&pose["levers_m"])),
                off(&mesh.forces(-phi, torque), &mirrored(&pose["forces_n"])),
                off(&[ours[0], -ours[1]], &bearing),
                (bearing[1].abs() / across - 1.0).abs(),
            ];
            for (worst, found) in worst.iter_mut().zip(found) {
                *worst = worst.max(found);
            }
        }
        for pose in live["output"].as_array().unwrap() {
            let turned = number(&pose["phi"]) * zk as f64 / (zk as f64 - 1.0);
            let error = off(
                &output.forces(-turned, torque),
                &mirrored(&pose["forces_n"]),
            );
            worst[4] = worst[4].max(error);
        }
        println!(
            "{name}: levers, forces, bearing, T/(e zs), output forces: {worst:.1e?}"
        );
        assert!(worst.iter().all(|w| *w < 1e-13), "{name}: {worst:?}");
    }
}

/// Our solver knows the curve and the law and nothing of levers. As stiffness grows its forces tend to
/// F = T l^p/sum of l^(p + 1) with the package's levers, p the exponent of the law, and its loaded sleeves to the package's.
#[test]
fn crossval_cycloidgen_levers_carry_the_solver() {
    for live in live() {
        let name = live["scene"].as_str().unwrap();
        let torque = number(&live["wheel_torque_n_m"]);
        let power = 10.0 / 9.0;
        let mut errors = Vec::new();
        for stiffness in ["1", "100"] {
            let text = torque.to_string();
            let scene = scene(
                name,
                &[
                    ("gear.wheels", "1"),
                    ("drive.output_torque_n_m", &text),
                    ("contact.law", "\"line-contact\""),
                    ("contact.stiffness_multiplier", stiffness),
                ],
            );
            let gearbox = Gearbox::new(&scene).unwrap();
            let mut statics = Statics::new(&gearbox).unwrap();
            let mut worst = [0.0_f64; 3];
            for pose in live["ring"].as_array().unwrap().iter().step_by(6) {
                let found = statics.solve(number(&pose["phi"]), torque).unwrap();
                let mut forces = vec![0.0; scene.gear.external_sleeves];
                let mut across = 0.0;
                let (s, c) = number(&pose["phi"]).sin_cos();
                for pair in statics.touching(&found) {
                    if let Sleeve::External(k) = pair.sleeve {
                        forces[k] = pair.normal_force_n;
                        let [fx, fy] = pair.force_on_sleeve();
                        across += fx * s - fy * c;
                    }
                }
                let levers: Vec<f64> = mirrored(&pose["levers_m"]);
                println!("{levers:?} {forces:?}");
                let share: Vec<f64> = levers.iter().map(|l| (-l).max(0.0).powf(power)).collect();
                let sum: f64 = share.iter().zip(&levers).map(|(f, l)| -f * l).sum();
                let wanted: Vec<f64> = share.iter().map(|f| torque * f / sum).collect();
                let theirs = numbers(&pose["bearing_n"])[1].abs();
                let loaded = |forces: &[f64], least: f64| {
                    forces.iter().filter(|f| **f > least).count() as f64
                };
                let count = loaded(&forces, 1e-3) - loaded(&wanted, 1e-3);
                let found = [
                    off(&forces, &wanted),
                    (across.abs() / theirs - 1.0).abs(),
                    count.abs(),
                ];
                for (worst, found) in worst.iter_mut().zip(found) {
                    *worst = worst.max(found);
                }
            }
            println!("{name}, {stiffness}: forces, T/(e zs), count: {worst:.1e?}");
            errors.push(worst);
        }
    }
}
