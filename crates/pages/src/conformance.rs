//! The page and the table of `pinwheel solver check`.

use pinwheel_report::study::{
    Block, Cell, Column, Mark, Section, Study, Table, Tone, Verdict, render,
};
use pinwheel_report::terminal::{self, BAD, GOOD, QUIET, TITLE, lines, styled};
use pinwheel_studies::Provenance;
use pinwheel_studies::conformance::{Outcome, State};

use crate::PageError;

fn word(state: &State) -> &'static str {
    match state {
        State::Passed => "passed",
        State::Failed => "FAILED",
        State::Skipped => "skipped",
    }
}

fn headline(found: &Outcome) -> String {
    let [passed, failed, skipped] =
        [State::Passed, State::Failed, State::Skipped].map(|state| found.count(&state));
    if found.passed() {
        format!("{passed} trials passed, {skipped} skipped")
    } else {
        format!("{failed} trials FAILED, {passed} passed, {skipped} skipped")
    }
}

/// The table for a terminal.
#[must_use]
pub fn text(found: &Outcome) -> String {
    let title = |text: &str| terminal::Cell::text(text).styled(TITLE);
    let mut rows = vec![["trial", "", "seen"].map(title).to_vec()];
    rows.extend(found.findings.iter().map(|finding| {
        let style = match finding.state {
            State::Passed => GOOD,
            State::Failed => BAD,
            State::Skipped => QUIET,
        };
        vec![
            terminal::Cell::text(finding.name),
            terminal::Cell::text(word(&finding.state)).styled(style),
            terminal::Cell::text(match finding.state {
                State::Failed => format!("must: {}. Seen: {}", finding.must, finding.seen),
                _ => finding.seen.clone(),
            }),
        ]
    }));
    let style = if found.passed() { GOOD } else { BAD };
    format!(
        "{}\n{}\n{}",
        styled(
            TITLE,
            &format!(
                "{} {}, {}",
                found.solver,
                found.version,
                found.track.as_str()
            )
        ),
        lines(&rows),
        styled(style, &headline(found))
    )
}

/// The page.
///
/// # Errors
/// It cannot be made.
pub fn page(found: &Outcome, made: &Provenance) -> Result<String, PageError> {
    let rows = found.findings.iter().map(|finding| {
        let mark = match finding.state {
            State::Passed => Mark::Good,
            State::Failed => Mark::Bad,
            State::Skipped => Mark::Muted,
        };
        vec![
            Cell::text(finding.name),
            Cell::text(word(&finding.state)).marked(mark),
            Cell::text(finding.must),
            Cell::text(&finding.seen),
        ]
    });
    let columns = ["trial", "", "must", "seen"].map(Column::text);
    let table = Table {
        caption: "Trials of the solver".to_owned(),
        columns: columns.to_vec(),
        rows: rows.collect(),
    };
    let study = Study {
        title: found.solver.clone(),
        eyebrow: "Conformance of a solver".to_owned(),
        lead: "What every engine must survive before comparisons can rely on it, tried on short runs of the preset \
               `paper`."
            .to_owned(),
        verdict: Some(Verdict {
            tone: Tone::of(found.passed()),
            headline: headline(found),
            detail: format!("{}, {}", found.version, found.track.as_str()),
        }),
        sections: vec![Section {
            id: "trials".to_owned(),
            title: "Trials".to_owned(),
            blocks: vec![Block::Table(table)],
        }],
        command: made.command.clone(),
        versions: made.versions(),
        machine: made.machine.rows(),
        ..Study::default()
    };
    Ok(render(&study)?)
}
