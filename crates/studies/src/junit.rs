//! Verdicts as a JUnit file, by which CI systems show them one by one.

use std::path::Path;
use std::time::Duration;

use pinwheel_compare::{Assessment, Comparison, Status, Verdict};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use crate::baseline::{self, CaseCheck, Check};
use crate::file;
use crate::output::OutputError;

/// How a case ended.
pub(crate) enum Ended {
    /// It holds.
    Passed,
    /// It does not, and why.
    Failed(String),
    /// It was not judged, and why.
    Skipped(String),
}

/// A case.
pub(crate) fn case(name: impl Into<String>, ended: Ended) -> TestCase {
    let (mut status, why) = match ended {
        Ended::Passed => return TestCase::new(name.into(), TestCaseStatus::success()),
        Ended::Failed(why) => (TestCaseStatus::non_success(NonSuccessKind::Failure), why),
        Ended::Skipped(why) => (TestCaseStatus::skipped(), why),
    };
    status.set_message(why);
    TestCase::new(name.into(), status)
}

/// Cases that belong together.
pub(crate) fn suite(name: &str, cases: impl IntoIterator<Item = TestCase>) -> TestSuite {
    let mut suite = TestSuite::new(name);
    for mut case in cases {
        case.set_classname(name);
        suite.add_test_case(case);
    }
    suite
}

/// Returns true for a JUnit file that [`write`] wrote.
fn is_ours(content: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&content[..content.len().min(200)]);
    head.contains("<testsuites name=\"pinwheel ")
}

/// Checks that [`write()`] may write a file, before anything long is run.
///
/// # Errors
/// It cannot be written, or is not an earlier JUnit file of ours.
pub fn check(path: &Path) -> Result<(), OutputError> {
    file::check(path, &is_ours)
}

/// Writes suites as one JUnit file.
///
/// # Errors
/// As of [`check`].
pub fn write(path: &Path, name: &str, suites: Vec<TestSuite>) -> Result<(), OutputError> {
    let mut report = Report::new(name);
    report.add_test_suites(suites);
    let text = report
        .to_string()
        .map_err(|error| OutputError::new(path, &error))?;
    file::replace(path, text.as_bytes(), &is_ours)
}

/// Findings as a suite, then every engine's run as a case, and every pair's statements. A finding of which nothing was shown is
/// a failure.
#[must_use]
pub fn of_comparison(comparison: &Comparison) -> Vec<TestSuite> {
    let scene = &comparison.context.scene;
    let findings = comparison.findings.iter().map(|finding| {
        let ended = match finding.status {
            0 => Ended::Passed,
            _ => Ended::Failed(finding.line.clone()),
        };
        case(&finding.name, ended)
    });
    let findings = suite(&format!("{scene}: shown"), findings);
    let runs = comparison.engines.iter().map(|engine| {
        let why = engine.status.reason().unwrap_or_default();
        let ended = match engine.status {
            Status::Finished => Ended::Passed,
            Status::Diverged { .. } | Status::Failed { .. } => Ended::Failed(why),
            _ => Ended::Skipped(why),
        };
        let mut case = case(&engine.name, ended);
        if let Ok(time) = Duration::try_from_secs_f64(engine.cost.wall_s) {
            case.set_time(time);
        }
        case
    });
    let runs = suite(&format!("{scene}: runs"), runs);
    let pairs = comparison.pairs.iter().map(|pair| {
        let cases = pair.entries.iter().map(|entry| {
            let name = format!("{} ({})", entry.quantity, entry.window.word());
            case(name, ended(&entry.result))
        });
        suite(&format!("{scene}: {} and {}", pair.a, pair.b), cases)
    });
    [findings, runs].into_iter().chain(pairs).collect()
}

/// A verdict's word, with what it rests on. What asks for something is a failure.
fn ended(found: &Assessment) -> Ended {
    let word = found.verdict.word();
    let number = |value: Option<f64>| value.map_or("unknown".to_owned(), |v| format!("{v:.2e}"));
    match found.verdict {
        Verdict::Inconclusive if found.actionable => {
            Ended::Failed(format!("{word}: {}; {}", found.reason, found.remedy))
        }
        Verdict::Inconclusive | Verdict::NotCompared => {
            Ended::Skipped(format!("{word}: {}", found.reason))
        }
        Verdict::Differ if found.actionable => Ended::Failed(format!(
            "{word}: {} against a {} of {}",
            number(found.difference),
            found.against.word(),
            number(found.bound)
        )),
        Verdict::Differ | Verdict::Agree => Ended::Passed,
    }
}

/// Every scene and solver of a baseline.
#[must_use]
pub fn of_baseline(name: &str, check: &Check) -> TestSuite {
    let cases = check.cases.iter().map(|found| {
        let why = || found.trouble.clone().unwrap_or_else(|| worse(found));
        let ended = match found.verdict {
            baseline::Verdict::Worse => Ended::Failed(why()),
            baseline::Verdict::New => Ended::Failed(format!("nothing shown: {}", why())),
            _ => Ended::Passed,
        };
        case(format!("{}, {}", found.scene, found.choice), ended)
    });
    let answers = check.answers(name).into_iter().map(|answer| {
        let ended = match answer.verdict {
            baseline::Verdict::Worse | baseline::Verdict::New => Ended::Failed(answer.text),
            _ => Ended::Passed,
        };
        case(answer.name, ended)
    });
    suite(&format!("baseline {name}"), answers.chain(cases))
}

/// Every error and count of a case that rose beyond its limit.
fn worse(case: &CaseCheck) -> String {
    let is_worse = |verdict| verdict == baseline::Verdict::Worse;
    let errors = case.quantities.iter().filter(|q| is_worse(q.verdict));
    let errors = errors.map(|q| {
        let (label, before, after) = (q.label, q.error_before, q.error_after);
        format!("error of {label} {before:.2e}, now {after:.2e}")
    });
    let counts = case.costs.iter().filter(|cost| is_worse(cost.verdict));
    let counts =
        counts.map(|cost| format!("{} {:.0}, now {:.0}", cost.label, cost.before, cost.after));
    errors.chain(counts).collect::<Vec<_>>().join("; ")
}
