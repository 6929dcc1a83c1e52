//! Text of a measurement for a terminal.

use crate::terminal;
use pinwheel_studies::bench::{self, CostAt, WorkPrecision};
use pinwheel_timeseries::table::{Mark, Table};

use super::figures;

/// Returns the cost of the target with every engine and method, without the path of the page.
pub fn text(study: &WorkPrecision) -> String {
    let ranking = study.ranking(0, study.options.target);
    let rows = study.series.iter().zip(&ranking.entries);
    let table = Table::of("", rows).text("", "engine", |(_, entry)| &entry.label);
    let table = figures::column(table, "CPU", figures::cpu, |(_, entry)| entry.cpu_s);
    let table = figures::column(table, "right-hand sides", figures::count, |(_, entry)| {
        entry.rhs_calls
    });
    let table = table
        .text("", "note", |(series, entry)| note(series, entry.cpu_s))
        .marked(|_| Mark::Muted);
    let title = format!(
        "{}: cost of a relative L2 force error of {:e} over {} s",
        study.scene.name, ranking.error, study.scene.solver.duration_s
    );
    let reference = format!(
        "reference: {} against {}, apart {:.1e}\n",
        study.reference.solution.method,
        study.reference.second.method,
        study.reference_errors[0].force_l2
    );
    let lead = ranking.advantage.as_ref().map(|lead| {
        let [words, peer] = match lead.peer_cpu_s.reached() {
            true => ["", "the fastest peer that got there"],
            false => ["no peer got there; ", "which stopped before"],
        };
        let least = if lead.at_least { "at least " } else { "" };
        format!(
            "{words}native ({}) is {least}{:.0} times faster than {}, {peer}",
            lead.native, lead.ratio, lead.peer
        )
    });
    let table = terminal::table(&table.done());
    terminal::titled(&title, [table, reference, terminal::paragraphs(lead)])
}

fn note(series: &bench::Series, cost: Option<CostAt>) -> String {
    match cost {
        Some(cost) if cost.reached() => String::new(),
        _ => figures::end(series),
    }
}
