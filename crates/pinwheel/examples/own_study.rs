//! A study of one's own: how friction and backlash share the loss, on all cores:
//! `cargo run --release -p pinwheel-dynamics --example own_study`.
#![allow(clippy::print_stdout, reason = "a program that prints its figures")]

use std::error::Error;

use pinwheel::time_series::norms::View;
use pinwheel::{CheckedScene, StudyError};

/// Mean torques of driver and load over the second half, N m.
fn torques(scene: &CheckedScene) -> Result<[f64; 2], StudyError> {
    let found = pinwheel::run(scene, "native-reduced")?;
    let time_series = &found.run.time_series;
    let end = scene.solver.duration_s;
    let steady = time_series.window(0.5 * end, end);
    let mean = |name: &str| {
        let values = time_series.channel(name).unwrap_or(&[]);
        let values = values.get(steady.clone()).unwrap_or(&[]);
        View::new(vec![values]).mean().unwrap_or(f64::NAN)
    };
    Ok([mean("input_torque_n_m"), mean("output_torque_n_m")])
}

fn main() -> Result<(), Box<dyn Error>> {
    let base = pinwheel::load("paper", &["solver.duration_s = 0.04"])?;
    let mut scenes = Vec::new();
    for backlash_m in [0.0, 0.3e-3] {
        for friction in [0.0, 0.02] {
            let scene = base.changed(|scene| {
                scene.gear.backlash_m = backlash_m;
                scene.contact.friction_coefficient = friction;
                // Explicit methods do not resolve friction.
                scene.solver.integrator = "imex2".to_owned();
            })?;
            scenes.push((backlash_m, friction, scene));
        }
    }
    // Every run is a function of its scene alone: threads share nothing.
    let found: Vec<_> = std::thread::scope(|scope| {
        let runs: Vec<_> = scenes
            .iter()
            .map(|(_, _, scene)| scope.spawn(|| torques(scene)))
            .collect();
        runs.into_iter().map(|run| run.join()).collect()
    });
    println!("backlash mm   friction   driver N m   output N m");
    for ((backlash_m, friction, _), torques) in scenes.iter().zip(found) {
        let [driver, output] = torques.map_err(|_| "a run panicked")??;
        println!(
            "{:11.1}   {friction:8}   {driver:10.4}   {output:10.4}",
            1e3 * backlash_m
        );
    }
    // Larger ones need no program: see docs/sweeps.md and pinwheel::studies::sweep.
    Ok(())
}
