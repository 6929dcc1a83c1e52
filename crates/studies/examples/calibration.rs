//! Holds stated uncertainties against true errors and prints the table of docs/verdicts.md:
//! `cargo run --release -p pinwheel-studies --example calibration -- 1000..1024 native-reduced,native-lagrange`.

#![allow(clippy::print_stdout, reason = "prints a table")]

#[path = "../tests/suite/calibration/coverage.rs"]
mod coverage;
#[path = "../tests/suite/gears.rs"]
mod gears;

use std::error::Error;
use std::process::ExitCode;
use std::time::Duration;

use pinwheel_scene::{Override, Scene};
use pinwheel_studies::Control;
use pinwheel_studies::comparison::Effort;

/// Presets beside the random gears, each with its duration, s.
const PRESETS: [(&str, &str); 8] = [
    ("paper", "0.05"),
    ("backlash-0.6", "0.05"),
    ("steel", "0.01"),
    ("one-wheel", "0.05"),
    ("eleven-pins", "0.05"),
    ("forty-pins", "0.02"),
    ("paper-friction", "0.01"),
    ("paper-rough", "0.01"),
];
/// Time that the runs of one engine on one gear may take before it is refined no further.
const LONGEST: Duration = Duration::from_secs(2);

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let seeds = arguments.next().unwrap_or_else(|| "1000..1024".to_owned());
    let engines = arguments.next();
    let engines =
        engines.unwrap_or_else(|| "native-reduced,native-lagrange,native-resolved".to_owned());
    let (from, to) = seeds
        .split_once("..")
        .ok_or("write seeds like 1000..1024")?;
    let mut scenes = Vec::new();
    for (name, duration_s) in PRESETS {
        scenes.push(Scene::load(
            name,
            &[Override::new("solver.duration_s", duration_s)],
        )?);
    }
    for seed in from.parse()?..to.parse()? {
        let gear = gears::gear(seed).ok_or_else(|| format!("seed {seed} gives no gear"))?;
        scenes.push(gear.check()?);
    }
    let input = coverage::Input {
        scenes,
        engines: engines.split(',').map(str::to_owned).collect(),
        effort: Effort {
            longest: LONGEST,
            obey: false,
            resolution: 0.01,
        },
    };
    let outcome = coverage::run(&input, &Control::quiet())?;
    for (figures, title) in [(false, "time series"), (true, "their means, peaks and RMS")] {
        println!(
            "| {title} | errors | covered (%) | u / error, median | error / u, largest | not resolved | no truth |"
        );
        println!("|---|---|---|---|---|---|---|");
        for row in outcome.rows(figures) {
            let count = |of: &std::collections::BTreeMap<String, usize>| match row.engine.as_str() {
                _ if figures => 0,
                "all" => of.values().sum(),
                engine => of.get(engine).copied().unwrap_or(0),
            };
            println!(
                "| {} | {} | {:.1} | {:.1} | {:.2} | {} | {} |",
                row.engine,
                row.cases,
                100.0 * row.coverage(),
                row.sharpness,
                row.worst,
                count(&outcome.not_resolved),
                count(&outcome.without_truth),
            );
        }
    }
    println!(
        "{} gears, {} comparisons, {} false alarms",
        outcome.gears,
        outcome.comparisons,
        outcome.alarms.len()
    );
    for alarm in &outcome.alarms {
        println!("false alarm: {alarm:?}");
    }
    for case in outcome.cases.iter().filter(|case| !case.covered()) {
        println!("not covered: {case:?}");
    }
    for left in &outcome.left_out {
        println!("left out: {left}");
    }
    Ok(if outcome.is_honest() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
