//! Runs a gear and reads its figures: `cargo run --release -p pinwheel-dynamics --example run_a_gear`.
#![allow(clippy::print_stdout, reason = "a program that prints its figures")]

use std::error::Error;

use pinwheel::time_series::norms::{Statistics, View};

fn main() -> Result<(), Box<dyn Error>> {
    // A preset, or the path of a scene file, with keys set as on the command line.
    let paper = pinwheel::load("paper", &["solver.duration_s = 0.05"])?;
    // Or changed as data; every change is checked.
    let loose = paper.changed(|scene| scene.gear.backlash_m = 0.3e-3)?;
    for (name, scene) in [("no backlash", &paper), ("0.3 mm of backlash", &loose)] {
        let found = pinwheel::run(scene, "native")?;
        let time_series = &found.run.time_series;
        // The second half: the start has died down.
        let steady = time_series.window(0.025, 0.05);
        let torque = time_series.channel("input_torque_n_m").ok_or("no torque")?;
        let driver =
            Statistics::of(&View::new(vec![&torque[steady.clone()]])).ok_or("no samples")?;
        // One channel a pin: external_sleeve_force_n_1, _2, ...
        let sleeves = time_series.group("external_sleeve_force_n");
        let sleeves = View::new(
            sleeves
                .into_iter()
                .map(|one| &one[steady.clone()])
                .collect(),
        );
        println!(
            "{name}: driver torque {:.3} N m, largest force of a ring pin {:.1} N",
            driver.mean,
            sleeves.peak().ok_or("no forces")?
        );
        if let Some(resolution) = &found.resolution {
            println!("  {}", resolution.sentence());
        }
    }
    Ok(())
}
