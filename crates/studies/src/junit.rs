//! Verdicts as a JUnit file, by which CI systems show them one by one.

use std::path::Path;

use pinwheel_compare::{Assessment, Comparison, Status, Verdict};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use crate::baseline::{self, CaseCheck, Check};
use crate::folder::replace;
use crate::output::OutputError;

/// How a case ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ended {
    /// It holds.
    Passed,
    /// It does not, and why.
    Failed(String),
    /// It was not judged, and why.
    Skipped(String),
}

/// One statement.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// What is stated.
    pub name: String,
    /// What it took, s.
    pub time_s: Option<f64>,
    /// How it ended.
    pub ended: Ended,
}

/// Statements that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Suite {
    /// Its name.
    pub name: String,
    /// In their order.
    pub cases: Vec<Case>,
}

/// Writes suites as one JUnit file.
///
/// # Errors
/// It cannot be written.
pub fn write(path: &Path, name: &str, suites: &[Suite]) -> Result<(), OutputError> {
    let mut report = Report::new(name);
    for suite in suites {
        let mut written = TestSuite::new(&*suite.name);
        for case in &suite.cases {
            let status = match &case.ended {
                Ended::Passed => TestCaseStatus::success(),
                Ended::Failed(why) => {
                    let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
                    status.set_message(&**why);
                    status
                }
                Ended::Skipped(why) => {
                    let mut status = TestCaseStatus::skipped();
                    status.set_message(&**why);
                    status
                }
            };
            let mut written_case = TestCase::new(&*case.name, status);
            written_case.set_classname(&*suite.name);
            if let Some(time) = case
                .time_s
                .and_then(|s| std::time::Duration::try_from_secs_f64(s).ok())
            {
                written_case.set_time(time);
            }
            written.add_test_case(written_case);
        }
        report.add_test_suite(written);
    }
    let text = report
        .to_string()
        .map_err(|error| OutputError::new(path, &error))?;
    replace(path, text.as_bytes())
}

/// Every engine's run as a case, and every pair's statements.
#[must_use]
pub fn of_comparison(comparison: &Comparison) -> Vec<Suite> {
    let scene = &comparison.context.scene;
    let runs = comparison.engines.iter().map(|engine| Case {
        name: engine.name.clone(),
        time_s: Some(engine.cost.wall_s),
        ended: match (&engine.status, engine.status.reason()) {
            (Status::Finished, _) => Ended::Passed,
            (Status::Unsupported { .. } | Status::Absent { .. } | Status::TimedOut { .. }, why) => {
                Ended::Skipped(why.unwrap_or_default())
            }
            (_, why) => Ended::Failed(why.unwrap_or_default()),
        },
    });
    let mut suites = vec![Suite {
        name: format!("{scene}: runs"),
        cases: runs.collect(),
    }];
    for pair in &comparison.pairs {
        let cases = pair.entries.iter().map(|entry| Case {
            name: format!("{} ({})", entry.quantity, entry.window.word()),
            time_s: None,
            ended: ended(&entry.result),
        });
        suites.push(Suite {
            name: format!("{scene}: {} and {}", pair.a, pair.b),
            cases: cases.collect(),
        });
    }
    suites
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
pub fn of_baseline(name: &str, check: &Check) -> Vec<Suite> {
    let cases = check.cases.iter().map(|case| Case {
        name: format!("{}, {}", case.scene, case.choice),
        time_s: None,
        ended: match case.verdict {
            baseline::Verdict::Worse => {
                Ended::Failed(case.trouble.clone().unwrap_or_else(|| worse(case)))
            }
            _ => Ended::Passed,
        },
    });
    vec![Suite {
        name: format!("baseline {name}"),
        cases: cases.collect(),
    }]
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
