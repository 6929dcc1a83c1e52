//! A measurement on a terminal.

use pinwheel_report::terminal::{Cell, QUIET, TITLE, lines, styled};
use pinwheel_studies::bench::Outcome;
use pinwheel_studies::precision::{self, CostAt};

use super::figures;

/// What the target costs every engine and method, without the place of the page.
#[must_use]
pub fn text(measured: &Outcome) -> String {
    let rankings = &measured.rankings();
    let mut text = String::new();
    if let (Some(study), Some(ranking)) = (&measured.study, rankings.first()) {
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
        text.push_str(&format!(
            "{}\n{}",
            styled(
                TITLE,
                &format!(
                    "{}: cost of a relative L2 force error of {:e} over {} s",
                    study.scene, ranking.error, study.duration_s
                )
            ),
            lines(&rows)
        ));
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
    }
    if let Some(fit) = measured.scaling.as_ref().and_then(|s| s.reduced_fit) {
        text.push_str(&format!(
            "cost of a call grows with (wheels x sleeves)^{:.2}\n",
            fit.exponent
        ));
    }
    for method in measured.batch.iter().flat_map(|batch| &batch.methods) {
        text.push_str(&format!(
            "batch by {}: {:.0} gears a second and core, set-up {:.1} % of a run\n",
            method.method,
            method.gears_per_s,
            100.0 * method.set_up_share()
        ));
    }
    text
}

fn note(series: &precision::Series, cost: Option<CostAt>) -> String {
    match cost {
        Some(cost) if cost.reached() => String::new(),
        _ => figures::failure(series).unwrap_or_else(|| series.stopped.words().to_owned()),
    }
}
