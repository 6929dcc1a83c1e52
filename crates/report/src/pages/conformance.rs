//! Page and table of `pinwheel solver check`.

use crate::pages::comparison::stages::blocks;
use crate::study::{Section, Study, Tone, Verdict};
use crate::terminal::{self, BAD, GOOD, TITLE, styled};
use pinwheel_studies::Provenance;
use pinwheel_studies::conformance::Outcome;
use pinwheel_studies::junit::State;
use pinwheel_timeseries::table::{Mark, Table};

/// Returns a state in a word, and its mark.
fn shown(state: State) -> (&'static str, Mark) {
    match state {
        State::Passed => ("passed", Mark::Good),
        State::Failed => ("FAILED", Mark::Bad),
        State::Skipped => ("skipped", Mark::Muted),
    }
}

fn headline(outcome: &Outcome) -> String {
    let [passed, failed, skipped] =
        [State::Passed, State::Failed, State::Skipped].map(|state| outcome.count(state));
    match outcome.passed() {
        true => format!("{passed} trials passed, {skipped} skipped"),
        false => format!("{failed} trials FAILED, {passed} passed, {skipped} skipped"),
    }
}

/// Returns every trial; on a terminal requirements appear only for failed ones.
fn table(outcome: &Outcome, terminal: bool) -> Table {
    let table = Table::of("Trials of the solver", &outcome.findings)
        .text("", "trial", |finding| finding.name)
        .text("", "result", |finding| shown(finding.state).0)
        .marked(|finding| shown(finding.state).1);
    let table = if terminal {
        table.text("", "seen", |finding| match finding.state {
            State::Failed => format!("must: {}. Seen: {}", finding.must, finding.seen),
            _ => finding.seen.clone(),
        })
    } else {
        table
            .text("", "must", |finding| finding.must)
            .text("", "seen", |finding| &finding.seen)
    };
    table.done()
}

/// Returns the table for a terminal.
pub fn text(outcome: &Outcome) -> String {
    let style = if outcome.passed() { GOOD } else { BAD };
    let title = format!("{} {}, {}", outcome.solver, outcome.version, outcome.track);
    let parts = [
        styled(style, &terminal::paragraph(&outcome.answer)),
        styled(TITLE, &title),
        terminal::table(&table(outcome, true)),
        styled(style, &headline(outcome)),
    ];
    parts.join("\n")
}

/// Returns the page.
pub fn page(outcome: &Outcome, origin: &Provenance) -> String {
    let stages = outcome.stages.iter();
    let stages = stages.map(|located| Section::new("stages", "Stages").with(blocks(located)));
    let trials = Section::new("trials", "Trials").with(table(outcome, false));
    let study = Study {
        title: outcome.solver.clone(),
        eyebrow: "Conformance of a solver".to_owned(),
        lead: "What every engine must survive before comparisons can rely on it, tried on short runs of the preset \
               `paper`."
            .to_owned(),
        verdict: Some(Verdict {
            tone: Tone::of(outcome.passed()),
            headline: outcome.answer.clone(),
            detail: format!("{}; {}, {}", headline(outcome), outcome.version, outcome.track.as_str()),
        }),
        sections: stages.chain([trials]).collect(),
        ..Study::default()
    };
    crate::pages::render(study, origin)
}
