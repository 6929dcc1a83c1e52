//! A measurement on a terminal.

use pinwheel_report::terminal::{Cell, QUIET, TITLE, lines, styled};
use pinwheel_studies::bench::{self, CostAt, WorkPrecision};

use super::figures;

/// What the target costs every engine and method, without the place of the page.
#[must_use]
pub fn text(study: &WorkPrecision) -> String {
    let ranking = study.ranking(0, study.options.target);
    let title = |text: &str| Cell::text(text).styled(TITLE);
    let right = |text: &str| Cell::figure(text).styled(TITLE);
    let mut rows = vec![vec![
        title("engine"),
        right("CPU"),
        right("right-hand sides"),
        title(""),
    ]];
    for (series, entry) in study.series.iter().zip(&ranking.entries) {
        rows.push(vec![
            Cell::text(entry.label.clone()),
            Cell::figure(entry.cpu_s.map_or("-".into(), figures::plain_seconds)),
            Cell::figure(entry.rhs_calls.map_or("-".into(), figures::plain_count)),
            Cell::text(note(series, entry.cpu_s)).styled(QUIET),
        ]);
    }
    let mut text = format!(
        "{}\n{}",
        styled(
            TITLE,
            &format!(
                "{}: cost of a relative L2 force error of {:e} over {} s",
                study.scene.name, ranking.error, study.scene.solver.duration_s
            )
        ),
        lines(&rows)
    );
    text.push_str(&format!(
        "reference: {} against {}, apart {:.1e}\n",
        study.reference.solution.method,
        study.reference.second.method,
        study.reference.error(0).force_l2
    ));
    if let Some(lead) = &ranking.advantage {
        text.push_str(&format!(
            "native ({}) is {}{:.0} times faster than {}\n",
            lead.native,
            if lead.at_least { "at least " } else { "" },
            lead.ratio,
            lead.peer
        ));
    }
    text
}

fn note(series: &bench::Series, cost: Option<CostAt>) -> String {
    match cost {
        Some(cost) if cost.reached() => String::new(),
        _ => figures::failure(series).unwrap_or_else(|| series.stopped.words().to_owned()),
    }
}
