//! Runs the targets without a fuzzer: as many inputs as fit in the time, from fixed seeds.
//!
//! ```text
//! PINWHEEL_FUZZ_S=600       time of all targets together, s (1)
//! PINWHEEL_FUZZ_ONLY=scene  one target, or with `scene:123` one of its inputs
//! PINWHEEL_FUZZ_FROM=50000  number of the first input (0), to continue an earlier run
//! ```

mod extremes;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use pinwheel_fuzz::{TARGETS, Target, mutate};

/// Time limit of one input. An input of 64 kB that takes longer hangs for a user; machines under load stay far below.
const HANGS: Duration = Duration::from_secs(60);

fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok()
}

/// Stores an input for a closer look.
fn keep(target: &Target, number: u64, bytes: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
    let path = folder.join(format!("{}-{number}", target.name));
    let _ = std::fs::create_dir_all(&folder);
    let _ = std::fs::write(&path, bytes);
    path
}

/// Activity of a target, for the watchdog.
type Now = Mutex<Option<(Instant, u64)>>;

/// Runs a target; returns a summary line and findings.
fn fuzz(
    target: &Target,
    from: u64,
    count: u64,
    time: Duration,
    now: &Now,
) -> (String, Vec<String>) {
    let seeds = (target.seeds)();
    assert!(!seeds.is_empty(), "{} has no seeds", target.name);
    for seed in &seeds {
        (target.run)(seed);
    }
    let (begin, mut findings) = (Instant::now(), Vec::new());
    let (mut number, mut accepted, mut slowest) = (from, 0, (Duration::ZERO, 0));
    while number - from < count && begin.elapsed() < time && findings.len() < 5 {
        let bytes = mutate::input(&seeds, number);
        let start = Instant::now();
        *now.lock().unwrap() = Some((start, number));
        match catch_unwind(AssertUnwindSafe(|| (target.run)(&bytes))) {
            Ok(taken) => accepted += u64::from(taken),
            Err(_) => {
                let path = keep(target, number, &bytes);
                findings.push(format!(
                    "{}: input {number} panics ({}); again: PINWHEEL_FUZZ_ONLY={}:{number}",
                    target.name,
                    path.display(),
                    target.name
                ));
            }
        }
        slowest = slowest.max((start.elapsed(), number));
        number += 1;
    }
    *now.lock().unwrap() = None;
    let did = format!(
        "{:<12} {:>8} inputs from {from}, {accepted} accepted, slowest {:.3} s (input {})",
        target.name,
        number - from,
        slowest.0.as_secs_f64(),
        slowest.1
    );
    (did, findings)
}

#[test]
fn bad_input_any_bytes_end_in_a_result_or_a_message() {
    let seconds: f64 = variable("PINWHEEL_FUZZ_S").map_or(1.0, |s| s.parse().expect("seconds"));
    let from: u64 = variable("PINWHEEL_FUZZ_FROM").map_or(0, |n| n.parse().expect("a number"));
    let only = variable("PINWHEEL_FUZZ_ONLY");
    let (name, one) = match only
        .as_deref()
        .map(|only| only.split_once(':').unwrap_or((only, "")))
    {
        None => (None, None),
        Some((name, number)) => (Some(name), number.parse::<u64>().ok()),
    };
    let targets: Vec<&Target> = TARGETS
        .iter()
        .filter(|t| name.is_none_or(|name| name == t.name))
        .collect();
    assert!(!targets.is_empty(), "no target is called {name:?}");
    let workers = std::thread::available_parallelism()
        .map_or(1, usize::from)
        .min(targets.len());
    let share = Duration::from_secs_f64(seconds * workers as f64 / targets.len() as f64);
    let (from, count) = one.map_or((from, u64::MAX), |number| (number, 1));
    let (next, done) = (AtomicUsize::new(0), AtomicBool::new(false));
    let now: Vec<Now> = targets.iter().map(|_| Mutex::new(None)).collect();
    let findings = Mutex::new(Vec::new());
    if one.is_none() {
        // Findings are reported below by number; panics that a library catches on purpose are no findings.
        std::panic::set_hook(Box::new(|_| {}));
    }
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(20));
                for (target, now) in targets.iter().zip(&now) {
                    if let Some((start, number)) = *now.lock().unwrap()
                        && start.elapsed() > HANGS
                    {
                        let path = keep(target, number, &mutate::input(&(target.seeds)(), number));
                        eprintln!("{}: input {number} hangs ({})", target.name, path.display());
                        std::process::exit(101);
                    }
                }
            }
        });
        let workers: Vec<_> = (0..workers)
            .map(|_| {
                scope.spawn(|| {
                    while let Some(&target) = targets.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let place = targets.iter().position(|t| t.name == target.name).unwrap();
                        let (did, own) = fuzz(target, from, count, share, &now[place]);
                        println!("{did}");
                        findings.lock().unwrap().extend(own);
                    }
                })
            })
            .collect();
        let ended = workers.into_iter().all(|worker| worker.join().is_ok());
        done.store(true, Ordering::Relaxed);
        if !ended {
            let cause = "a seed makes its target panic; PINWHEEL_FUZZ_ONLY=TARGET:0 shows where";
            findings.lock().unwrap().push(cause.to_owned());
        }
    });
    let _ = std::panic::take_hook();
    let findings = findings.into_inner().unwrap();
    assert!(findings.is_empty(), "{}", findings.join("\n"));
}

/// Published requests that servers took for two: RUSTSEC-2020-0008, 2020-0031, 2020-0093, 2021-0020, 2021-0078, 2021-0079, 2022-0066,
/// 2026-0033 and 2026-0034, and RFC 9112. The listed ones are one question, whatever follows it; all others of the corpus are refused.
#[test]
fn published_requests_are_one_question_or_none() {
    let one = "absolute asterisk authority balances bare-feeds cookie-bytes empty-lines-first get-with-body long-body \
               most-headers old-until-closed padded-length page run save status token upgrade";
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/requests");
    let mut taken: Vec<String> = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if pinwheel_fuzz::targets::requests(&std::fs::read(&path).unwrap()) {
            taken.push(path.file_name().unwrap().to_string_lossy().into_owned());
        }
    }
    taken.sort();
    assert_eq!(taken.join(" "), one);
}
