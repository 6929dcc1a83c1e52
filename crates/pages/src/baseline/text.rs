//! A check on a terminal: what moved, by solver, and what it has in common.

use pinwheel_report::terminal::{BAD, Cell, GOOD, QUIET, TITLE, lines, styled};
use pinwheel_studies::baseline::{Acceptance, Check, Listed, Verdict, in_common, table};

/// The whole text, without the place of the page.
#[must_use]
pub fn text(found: &Check) -> String {
    // The solver's column becomes the heading of its group.
    const SOLVER: usize = 1;
    let rows = table::rows(found);
    let mut solvers: Vec<&str> = rows.iter().map(|(_, row)| row[SOLVER].as_str()).collect();
    solvers.sort_unstable();
    solvers.dedup();
    let without = |row: &[Cell]| {
        let kept = row.iter().enumerate().filter(|(k, _)| *k != SOLVER);
        kept.map(|(_, cell)| cell.clone()).collect::<Vec<_>>()
    };
    let head = table::COLUMNS.map(|title| Cell::text(title).styled(TITLE));
    let (mut text, mut same) = (String::new(), Vec::new());
    for solver in solvers {
        let (still, moved): (Vec<_>, Vec<_>) = rows
            .iter()
            .filter(|(_, row)| row[SOLVER] == solver)
            .partition(|(verdict, _)| *verdict == Verdict::Same);
        if !still.is_empty() {
            same.push(format!("{solver} {}", still.len()));
        }
        if moved.is_empty() {
            continue;
        }
        let title = format!(
            "{solver}: {} of {} moved",
            moved.len(),
            moved.len() + still.len()
        );
        let mut group = vec![without(&head)];
        group.extend(
            moved
                .iter()
                .map(|(verdict, row)| without(&cells(*verdict, row))),
        );
        text.push_str(&format!("{}\n{}\n", styled(TITLE, &title), lines(&group)));
    }
    for sentence in in_common(found) {
        text.push_str(&format!("in common: {sentence}\n"));
    }
    if !same.is_empty() {
        let list = format!("same to rounding: {}", same.join(", "));
        text.push_str(&lines(&[vec![Cell::text(list).styled(QUIET)]]));
    }
    text.push_str(&table::sentence(found));
    text
}

/// The baselines that there are, with the reasons for which they were accepted.
#[must_use]
pub fn list(listed: &[Listed]) -> String {
    let mut text = String::new();
    for Listed { name, head } in listed {
        let made = &head.made;
        text.push_str(&format!(
            "{}  {} scenes, made {} at commit {}, {} build, {}\n",
            styled(TITLE, name),
            head.scenes.len(),
            made.date,
            made.commit,
            made.build,
            made.vectors
        ));
        let row = |a: &Acceptance| {
            ["  ", &a.date, &a.commit, &a.reason]
                .map(Cell::text)
                .to_vec()
        };
        text.push_str(&lines(&head.accepted.iter().map(row).collect::<Vec<_>>()));
    }
    text
}

fn cells(verdict: Verdict, row: &[String]) -> Vec<Cell> {
    let style = match verdict {
        Verdict::Worse => BAD,
        Verdict::Better => GOOD,
        Verdict::Changed | Verdict::New => TITLE,
        Verdict::Same => QUIET,
    };
    let one = |(column, text): (usize, &String)| match column {
        2 => Cell::text(text).styled(style),
        4 => Cell::figure(text),
        _ => Cell::text(text),
    };
    row.iter().enumerate().map(one).collect()
}
