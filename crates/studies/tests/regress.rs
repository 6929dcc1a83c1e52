//! The solver against its own accepted results, and proof that the check would find what it is for.

use std::path::{Path, PathBuf};

use pinwheel_faults::{Armed, Fault};
use pinwheel_gearbox::contacts::Kernel;
use pinwheel_studies::Control;
use pinwheel_studies::baseline::{
    self, Baseline, CaseCheck, Check, Made, Options, QuantityCheck, Verdict, across_loops,
    fingerprints, table,
};

fn accepted() -> Baseline {
    let dir: PathBuf =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../reference/baselines/accepted");
    Baseline::read(&dir).unwrap()
}

/// Nothing of the machine counts here: neither times nor instructions.
fn here() -> Made {
    Made {
        date: String::new(),
        commit: String::new(),
        version: String::new(),
        build: String::new(),
        vectors: Kernel::Lanes.vectors().to_owned(),
        processor: String::new(),
        no_instructions: String::new(),
    }
}

fn check(baseline: &Baseline, only: &[&str]) -> Check {
    let options = Options {
        only: only.iter().map(|&name| name.to_owned()).collect(),
        ..Options::default()
    };
    baseline::check(baseline, here(), &options, &Control::quiet()).unwrap()
}

/// `pinwheel baseline check`, as part of the tests.
#[test]
fn regress_accepted_results() {
    let found = check(&accepted(), &[]);
    println!("{}", table::text(&found));
    assert!(
        found.verdict < Verdict::Worse,
        "worse than accepted; see `pinwheel baseline check`, and if it is meant, `pinwheel baseline record --accept REASON`"
    );
}

/// The files are small enough for a review, and every scene is in them.
#[test]
fn regress_baseline_is_small_and_whole() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../reference/baselines/accepted");
    let files = std::fs::read_dir(&dir)
        .unwrap()
        .map(|file| file.unwrap().metadata().unwrap().len());
    let bytes: u64 = files.sum();
    // 46 scenes of about 10 kB, most of it the reference.
    assert!(bytes < 500_000, "{bytes} bytes");
    let baseline = accepted();
    for case in baseline::SCENES {
        let record = baseline
            .scenes
            .iter()
            .find(|record| record.scene == case.name);
        assert!(
            record.is_some_and(|record| record.cases.len() == case.choices.len()),
            "{}",
            case.name
        );
    }
    assert!(!baseline.head.accepted.is_empty());
}

/// One, two and four threads at work on the library at the same time: the same bits.
#[test]
fn regress_same_bits_for_any_number_of_threads() {
    let by = |threads| {
        let options = Options {
            threads,
            ..Options::default()
        };
        fingerprints(&options, &Control::quiet()).unwrap()
    };
    let one = by(1);
    assert!(one.iter().all(|case| case.bits != 0));
    assert_eq!(one, by(2));
    assert_eq!(one, by(4));
}

/// Results by AVX-512, by AVX2, without vector instructions and by the scalar loop, on every case.
#[test]
fn regress_same_results_by_other_vector_instructions() {
    let spreads = across_loops(&Options::default(), &Control::quiet()).unwrap();
    let (mut fixed, mut adaptive) = (0.0_f64, 0.0_f64);
    for spread in &spreads {
        println!(
            "{:50} vectors {:.1e}  scalar {:.1e}  counts {:.4}",
            spread.case, spread.vectors, spread.scalar, spread.counts
        );
        // The scalar loop has no Jacobian in closed form: by differences a Rosenbrock run takes other steps, and an
        // exponential one other steps or another method.
        let own_steps = ["rodas5p", "etd-adams"]
            .iter()
            .any(|name| spread.case.contains(name));
        let far = if own_steps {
            spread.vectors
        } else {
            spread.vectors.max(spread.scalar)
        };
        if ["dopri5", "adaptive", "etd-adams"]
            .iter()
            .any(|name| spread.case.contains(name))
        {
            adaptive = adaptive.max(far);
        } else {
            fixed = fixed.max(far);
        }
        assert!(
            own_steps || spread.counts < 1.03,
            "{}: right-hand sides {}",
            spread.case,
            spread.counts
        );
    }
    println!("largest: fixed steps {fixed:.1e}, with a step control {adaptive:.1e}");
    assert!(fixed < ACROSS_LOOPS, "{fixed:e}");
    assert!(adaptive < ACROSS_STEPS, "{adaptive:e}");
}

/// Shares of a quantity's size. Measured 2e-10 with fixed steps (steel amplifies most) ...
const ACROSS_LOOPS: f64 = 1e-8;
/// ... and 3e-7 where a step control takes another step (two cases; 6e-10 elsewhere).
const ACROSS_STEPS: f64 = 1e-6;

/// Scenes on which a fault is looked for: the main case, and for friction those that have it.
fn hunted(fault: Fault) -> &'static [&'static str] {
    match fault {
        Fault::PassedBreak => &["hard-load-doubled"],
        Fault::FrictionSign => &["paper-friction", "hard-friction-wide"],
        Fault::ForgottenRejection => &[
            "paper",
            "backlash-0.6",
            "hard-backlash-1",
            "paper-adams-friction",
        ],
        _ => &["paper", "eleven-pins"],
    }
}

/// The finding that speaks loudest: what the run says of itself, else the quantity farthest beyond its limit, else a cost.
fn finding(found: &Check) -> String {
    let worse: Vec<&CaseCheck> = found
        .cases
        .iter()
        .filter(|case| case.verdict == Verdict::Worse)
        .collect();
    let by = |case: &CaseCheck| format!("{}, {}", case.scene, case.choice);
    let quantities = worse
        .iter()
        .flat_map(|case| case.quantities.iter().map(move |q| (case, q)));
    let loudest = quantities
        .filter(|(_, q)| q.verdict == Verdict::Worse)
        .max_by(|(_, a), (_, b)| excess(a).total_cmp(&excess(b)));
    let costs = worse
        .iter()
        .flat_map(|case| case.costs.iter().map(move |c| (case, c)));
    let dearest = costs
        .filter(|(_, c)| c.verdict == Verdict::Worse)
        .max_by(|(_, a), (_, b)| (a.after / a.before).total_cmp(&(b.after / b.before)));
    let what = if let Some((case, q)) = loudest {
        format!(
            "{}: error of the {} {:.1e}, was {:.1e}",
            by(case),
            q.label,
            q.error_after,
            q.error_before
        )
    } else if let Some((case, cost)) = dearest {
        format!(
            "{}: {} {:.0}, were {:.0}",
            by(case),
            cost.label,
            cost.after,
            cost.before
        )
    } else if let Some(case) = worse.first() {
        format!("{}: {}", by(case), case.trouble.as_deref().unwrap_or(""))
    } else {
        "nothing".to_owned()
    };
    format!(
        "{} of {} cases worse | {what}",
        worse.len(),
        found.cases.len()
    )
}

fn excess(q: &QuantityCheck) -> f64 {
    (q.error_after - q.error_before) / q.error_limit
}

/// Every known fault is called worse; without one nothing is.
#[test]
fn regress_known_faults_are_found() {
    let baseline = accepted();
    let mut missed = Vec::new();
    for fault in Fault::ALL {
        let scenes = hunted(fault);
        assert!(
            check(&baseline, scenes).verdict < Verdict::Worse,
            "{} is not armed",
            fault.label()
        );
        let found = {
            let _armed = Armed::with(fault);
            check(&baseline, scenes)
        };
        println!("| {} | {} |", fault.label(), finding(&found));
        if std::env::var_os("PINWHEEL_SHOW_FAULTS").is_some() {
            println!("{}", table::text(&found));
        }
        if found.verdict != Verdict::Worse {
            missed.push(fault);
        }
    }
    assert!(missed.is_empty(), "not found: {missed:?}");
}
