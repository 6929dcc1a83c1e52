//! Instruction counts of a run, an evaluation, balances, and of writing and reading time series, against accepted counts.
//!
//! Times depend on the machine and its load. Instructions of this project's code hardly do: callgrind counts them on its
//! own processor, which has AVX2 and never AVX-512, without system libraries. After an intended change of counts, this
//! renews them:
//!
//! ```text
//! PINWHEEL_RENEW_COUNTS=1 cargo test --features crossval --test engines instructions
//! ```

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use pinwheel_gearbox::contacts::Kernel;
use pinwheel_gearbox::statics::Statics;
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_scene::{Override, Scene};
use pinwheel_tests::repository;
use pinwheel_timeseries::TimeSeries;

/// File with the accepted instructions of one unit of each piece of work.
const COUNTS: &str = "tests/data/instructions.toml";
/// Largest relative change of a count, up or down: two runs differ by 1e-5, builds of equal sources not at all.
const MOST: f64 = 0.01;
/// Number of units of a piece of work.
const EVALUATIONS: u32 = 1000;
const BALANCES: u32 = 60;
/// Pieces of work in order, with the number of units of each.
const WORK: [(&str, u32); 7] = [
    ("run", 1),
    ("write", 1),
    ("read", 1),
    ("evaluation", EVALUATIONS),
    ("balance_rigid", BALANCES),
    ("balance_floating", BALANCES),
    ("balance_on_cranks", BALANCES),
];

/// Ends a piece of work: callgrind writes the counts since the last end before it.
#[inline(never)]
fn end_of_piece(name: &str) {
    std::hint::black_box(name);
}

fn balances(statics: &mut Statics<'_>) {
    let load = statics.gearbox().scene.drive.output_torque_n_m;
    let mut last = None;
    for k in 0..BALANCES {
        let balance = statics.track(&mut last, 0.01 * f64::from(k), load);
        balance.expect("a balance");
    }
}

fn gearbox(preset: &str, sets: &[Override]) -> Gearbox {
    Gearbox::new(&Scene::load(preset, sets).expect("a preset")).expect("a gearbox")
}

#[test]
#[ignore = "work for the test below, which has it counted"]
fn the_work() {
    println!("vectors: {}", Kernel::Lanes.vectors());
    let paper = gearbox("paper", &[Override::new("solver.duration_s", "0.03")]);
    let others = ["needle-bearings", "rv-40e-like"].map(|name| gearbox(name, &[]));
    let mut rigid = Statics::new(&paper).expect("statics");
    let [mut floating, mut cranks] = others
        .each_ref()
        .map(|one| Statics::new(one).expect("statics"));
    let (mut series, mut text) = (TimeSeries::default(), Vec::new());
    end_of_piece("preparation");
    for (piece, _) in WORK {
        match piece {
            "run" => {
                series = native::run(&paper, &mut |_| false)
                    .expect("a run")
                    .time_series
            }
            "write" => series.write_csv(&mut text).expect("text"),
            "read" => drop(TimeSeries::read_csv(&text[..]).expect("time series")),
            "evaluation" => {
                let bodies = paper.kinematic_states();
                let mut loads = vec![Default::default(); bodies.len()];
                for _ in 0..EVALUATIONS {
                    rigid.field.add_loads(&bodies, &mut loads);
                }
            }
            "balance_rigid" => balances(&mut rigid),
            "balance_floating" => balances(&mut floating),
            _ => balances(&mut cranks),
        }
        end_of_piece(piece);
    }
}

/// Returns the instructions of one program's own code in a file of callgrind.
fn own(text: &str, program: &Path) -> f64 {
    let mut names = BTreeMap::new();
    let (mut is_own, mut of_callee, mut sum) = (false, false, 0.0);
    for line in text.lines() {
        let object = line.strip_prefix("ob=").or(line.strip_prefix("cob="));
        if let Some(object) = object {
            let (number, name) = object.split_once(' ').unwrap_or((object, ""));
            if !name.is_empty() {
                names.insert(number, Path::new(name) == program);
            }
            if line.starts_with('o') {
                is_own = names[number];
            }
        } else if line.starts_with("calls=") {
            of_callee = true;
        } else if line.starts_with(|c: char| c.is_ascii_digit() || "+-*".contains(c)) {
            let cost = line
                .split_whitespace()
                .nth(1)
                .map_or(0.0, |n| n.parse().expect("a count"));
            if is_own && !of_callee {
                sum += cost;
            }
            of_callee = false;
        }
    }
    sum
}

/// Returns the instructions of one unit of each piece of work; `Err`: the reason for missing counts.
fn counted() -> Result<BTreeMap<String, f64>, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("counts");
    let program = std::env::current_exe().expect("this program");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--dump-before=*end_of_piece*"])
        .arg(format!("--callgrind-out-file={}", file.display()))
        .arg(&program)
        .args([
            "--ignored",
            "--exact",
            "instructions::the_work",
            "--nocapture",
        ])
        .output()
        .map_err(|error| format!("valgrind does not start: {error}"))?;
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{stdout}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    if !stdout.contains("vectors: avx2") {
        return Err("this processor has no AVX2, for which the accepted counts are".to_owned());
    }
    // The first part is the preparation.
    let of_piece = |(k, (name, units)): (usize, &(&str, u32))| {
        let part = format!("{}.{}", file.display(), k + 2);
        let text = std::fs::read_to_string(part).expect("counts");
        let one = own(&text, &program) / f64::from(*units);
        ((*name).to_owned(), one.round())
    };
    Ok(WORK.iter().enumerate().map(of_piece).collect())
}

#[test]
fn regress_instructions_stay() {
    let counts = match counted() {
        Ok(counts) => counts,
        Err(why) if std::env::var_os("PINWHEEL_REQUIRE_VALGRIND").is_none() => {
            println!("skipped: {why}");
            return;
        }
        Err(why) => panic!("{why}"),
    };
    let path = repository(COUNTS);
    if std::env::var_os("PINWHEEL_RENEW_COUNTS").is_some() {
        let lines = counts
            .iter()
            .map(|(name, count)| format!("{name} = {count:.0}\n"));
        std::fs::write(&path, lines.collect::<String>()).expect("a file");
    }
    let text = std::fs::read_to_string(&path).expect("accepted counts");
    let accepted: BTreeMap<String, f64> = text
        .parse::<toml::Table>()
        .expect("TOML")
        .into_iter()
        .map(|(name, count)| (name, count.as_integer().expect("a count") as f64))
        .collect();
    let moved = counts.iter().filter_map(|(name, count)| {
        let before = accepted.get(name).copied().unwrap_or(f64::NAN);
        let share = count / before - 1.0;
        println!(
            "{name}: {count:.0} instructions, accepted {before:.0}, {:+.2} %",
            100.0 * share
        );
        (share.is_nan() || share.abs() > MOST).then(|| format!("{name} {:+.1} %", 100.0 * share))
    });
    let moved: Vec<String> = moved.collect();
    assert_eq!(counts.len(), accepted.len(), "pieces of work: {counts:?}");
    assert!(
        moved.is_empty(),
        "instructions moved by more than {} %: {}. If this is meant: PINWHEEL_RENEW_COUNTS=1 cargo test --features \
         crossval --test engines instructions",
        100.0 * MOST,
        moved.join(", ")
    );
}
