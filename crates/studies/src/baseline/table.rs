//! A check as plain text, for terminals and logs.

use super::check::{CaseCheck, Check};
use super::judge::Verdict;

/// Headings of [`rows`].
pub const COLUMNS: [&str; 7] = [
    "scene",
    "solver",
    "verdict",
    "moved most",
    "change",
    "error before > after",
    "right-hand sides",
];

/// One row a case.
#[must_use]
pub fn rows(check: &Check) -> Vec<(Verdict, [String; 7])> {
    check
        .cases
        .iter()
        .map(|case| (case.verdict, row(case)))
        .collect()
}

fn row(case: &CaseCheck) -> [String; 7] {
    let mut row: [String; 7] = Default::default();
    row[0].clone_from(&case.scene);
    row[1].clone_from(&case.choice);
    case.verdict.label().clone_into(&mut row[2]);
    if let Some(trouble) = &case.trouble {
        row[3].clone_from(trouble);
    } else if let Some(moved) = case.moved_most().filter(|moved| moved.change > 0.0) {
        moved.label.clone_into(&mut row[3]);
        row[4] = format!("{:.1e}", moved.change);
        row[5] = format!("{:.2e} > {:.2e}", moved.error_before, moved.error_after);
    }
    let costs = case
        .costs
        .iter()
        .filter(|cost| cost.verdict != Verdict::Same);
    if let Some(cost) = costs.max_by_key(|cost| cost.verdict).or(case.costs.first()) {
        row[6] = if cost.before == cost.after {
            format!("{:.0}", cost.after)
        } else {
            format!("{:.0} > {:.0}", cost.before, cost.after)
        };
        if cost.label != "right-hand sides" {
            row[6] = format!("{} {}", cost.label, row[6]);
        }
    }
    row
}

/// One line on the whole.
#[must_use]
pub fn sentence(check: &Check) -> String {
    let count = |verdict| {
        check
            .cases
            .iter()
            .filter(|case| case.verdict == verdict)
            .count()
    };
    let mut parts = Vec::new();
    for verdict in [
        Verdict::Worse,
        Verdict::Better,
        Verdict::New,
        Verdict::Changed,
        Verdict::Same,
    ] {
        let n = count(verdict);
        if n > 0 {
            parts.push(format!("{n} {}", verdict.label()));
        }
    }
    let mut text = format!("{} cases: {}", check.cases.len(), parts.join(", "));
    if let Some(time) = &check.time {
        text.push_str(&format!(
            "; time {:.2} of the accepted",
            time.after / time.before
        ));
        if check.time_is_judged {
            text.push_str(&format!(" ({})", time.verdict.label()));
        }
    }
    text
}

/// The table and the line below it, aligned.
#[must_use]
pub fn text(check: &Check) -> String {
    let rows = rows(check);
    let head = COLUMNS.map(str::to_owned);
    let all: Vec<&[String; 7]> = std::iter::once(&head)
        .chain(rows.iter().map(|(_, row)| row))
        .collect();
    let width = |column: usize| {
        all.iter()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: [usize; 7] = std::array::from_fn(width);
    let mut text = String::new();
    for row in all {
        let cells: Vec<String> = row
            .iter()
            .zip(widths)
            .map(|(cell, width)| format!("{cell:width$}"))
            .collect();
        text.push_str(cells.join("  ").trim_end());
        text.push('\n');
    }
    text.push_str(&sentence(check));
    text.push('\n');
    text
}
