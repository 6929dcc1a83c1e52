//! Verdicts as a JUnit file for CI systems.

use std::path::Path;
use std::time::Duration;

use pinwheel_compare::{Assessment, Comparison, Status, Verdict};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use serde::Serialize;

use crate::baseline::{self, CaseCheck, Check};
use crate::file;
use crate::output::OutputError;

/// Result of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// Criterion met.
    Passed,
    /// Criterion violated.
    Failed,
    /// Not judged.
    Skipped,
}

pub(crate) fn passed(holds: bool) -> State {
    if holds { State::Passed } else { State::Failed }
}

/// Creates a case; `why`: reason unless it passed.
pub(crate) fn case(name: impl Into<String>, state: State, why: &str) -> TestCase {
    let mut status = match state {
        State::Passed => TestCaseStatus::success(),
        State::Failed => TestCaseStatus::non_success(NonSuccessKind::Failure),
        State::Skipped => TestCaseStatus::skipped(),
    };
    status.set_message(why);
    TestCase::new(name.into(), status)
}

/// Creates a suite of related cases.
pub(crate) fn suite(name: &str, cases: impl IntoIterator<Item = TestCase>) -> TestSuite {
    let mut suite = TestSuite::new(name);
    for mut case in cases {
        case.set_classname(name);
        suite.add_test_case(case);
    }
    suite
}

/// True for a JUnit file written by [`write`].
fn is_ours(content: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&content[..content.len().min(200)]);
    head.contains("<testsuites name=\"pinwheel ")
}

/// Checks that [`write()`] may write a file, before any long run.
///
/// # Errors
/// A file that cannot be written, or is no earlier JUnit file of this program.
pub fn check(path: &Path) -> Result<(), OutputError> {
    file::check(path, &is_ours)
}

/// Writes suites as one JUnit file.
///
/// # Errors
/// Errors of [`check`].
pub fn write(path: &Path, name: &str, suites: Vec<TestSuite>) -> Result<(), OutputError> {
    let mut report = Report::new(name);
    report.add_test_suites(suites);
    let text = report
        .to_string()
        .map_err(|error| OutputError::new(path, &error))?;
    file::replace(path, text.as_bytes(), &is_ours)
}

/// Returns the findings as a suite, then every engine's run as a case, and every pair's statements. A finding without
/// evidence is a failure.
pub fn of_comparison(comparison: &Comparison) -> Vec<TestSuite> {
    let scene = &comparison.context.scene;
    let findings = comparison.findings.iter();
    let findings = findings.map(|it| case(&it.name, passed(it.status == 0), &it.line));
    let findings = suite(&format!("{scene}: shown"), findings);
    let runs = comparison.engines.iter().map(|engine| {
        let why = engine.status.reason().unwrap_or_default();
        let state = match engine.status {
            Status::Finished => State::Passed,
            Status::Diverged { .. } | Status::Failed { .. } => State::Failed,
            _ => State::Skipped,
        };
        let mut case = case(&engine.name, state, &why);
        if let Ok(time) = Duration::try_from_secs_f64(engine.cost.wall_s) {
            case.set_time(time);
        }
        case
    });
    let runs = suite(&format!("{scene}: runs"), runs);
    let pairs = comparison.pairs.iter().map(|pair| {
        let cases = pair.entries.iter().map(|entry| {
            let name = format!("{} ({})", entry.quantity, entry.window.word());
            let (state, why) = ended(&entry.result);
            case(name, state, &why)
        });
        suite(&format!("{scene}: {} and {}", pair.a, pair.b), cases)
    });
    [findings, runs].into_iter().chain(pairs).collect()
}

/// Returns state and text of a verdict. Verdicts that need action are failures.
fn ended(case: &Assessment) -> (State, String) {
    let word = case.verdict.word();
    let number = |value: Option<f64>| value.map_or("unknown".to_owned(), |v| format!("{v:.2e}"));
    let reason = format!("{word}: {}", case.reason);
    match (case.verdict, case.actionable) {
        (Verdict::Inconclusive, true) => (State::Failed, format!("{reason}; {}", case.remedy)),
        (Verdict::Inconclusive | Verdict::NotCompared, _) => (State::Skipped, reason),
        (Verdict::Differ, true) => {
            let (difference, bound) = (number(case.difference), number(case.bound));
            let against = case.against.word();
            let why = format!("{word}: {difference} against a {against} of {bound}");
            (State::Failed, why)
        }
        (Verdict::Differ | Verdict::Agree, _) => (State::Passed, reason),
    }
}

/// Returns every scene and solver of a baseline as cases.
pub fn of_baseline(name: &str, check: &Check) -> TestSuite {
    let holds = |verdict| !matches!(verdict, baseline::Verdict::Worse | baseline::Verdict::New);
    let cases = check.cases.iter().map(|checked| {
        let nothing = match checked.verdict {
            baseline::Verdict::New => "nothing shown: ",
            _ => "",
        };
        let why = checked.trouble.clone().unwrap_or_else(|| worse(checked));
        let name = format!("{}, {}", checked.scene, checked.choice);
        case(
            name,
            passed(holds(checked.verdict)),
            &format!("{nothing}{why}"),
        )
    });
    let answers = check.answers(name).into_iter();
    let answers = answers.map(|it| case(it.name, passed(holds(it.verdict)), &it.text));
    suite(&format!("baseline {name}"), answers.chain(cases))
}

/// Returns every error and count of a case that increased beyond its limit.
fn worse(case: &CaseCheck) -> String {
    let is_worse = |verdict| verdict == baseline::Verdict::Worse;
    let errors = case.quantities.iter().filter(|it| is_worse(it.verdict));
    let errors = errors.map(|it| {
        let (label, before, after) = (it.label, it.error_before, it.error_after);
        format!("error of {label} {before:.2e}, now {after:.2e}")
    });
    let counts = case.costs.iter().filter(|it| is_worse(it.verdict));
    let counts = counts.map(|it| format!("{} {:.0}, now {:.0}", it.label, it.before, it.after));
    let stage = case.stage.iter().map(|stage| format!("stage {stage}"));
    let all = errors.chain(counts).chain(stage);
    all.collect::<Vec<_>>().join("; ")
}
