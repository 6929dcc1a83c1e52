//! Page of `pinwheel bench`: headline, cost of accuracy, the reference, differences, all runs.

use crate::format::{self, limit, significant};
use crate::study::{Decision, Mark, Question, Section, Study, Tone, Verdict};
use crate::terminal::{self, paragraphs, titled};
use pinwheel_engines::SharedModel;
use pinwheel_studies::Provenance;
use pinwheel_studies::bench::{CostAt, Ranking, WorkPrecision};
use pinwheel_timeseries::table::Table;

mod figures;
mod sections;

pub use figures::failure;

/// Returns the page.
pub fn page(measured: &WorkPrecision, origin: &Provenance) -> String {
    let rankings = &measured.rankings();
    let scene = &measured.scene;
    let versions = measured.series.iter();
    let versions = versions.map(|series| (series.engine.clone(), series.version.clone()));
    let mut study = Study {
        title: scene.name.clone(),
        eyebrow: "Speed against error".to_owned(),
        lead: format!(
            "Every engine, integrator and step on the scene {} over {} s, against a converged run, in one session on one machine.",
            scene.name, scene.solver.duration_s
        ),
        verdict: rankings.first().and_then(|first| verdict(measured, first)),
        decision: decision(measured, rankings.first(), origin),
        sections: sections::all(measured, rankings),
        versions: versions.collect(),
        ..Study::default()
    };
    if !measured.complete {
        let text = "The measurement was stopped by the user. What had been measured until then stands here; what is missing is \
                    not a result.";
        let stopped = Section::new("incomplete", "Incomplete").with(text);
        study.sections.insert(0, stopped);
    }
    crate::pages::render(study, origin)
}

fn decision(study: &WorkPrecision, ranking: Option<&Ranking>, origin: &Provenance) -> Decision {
    let entries = ranking.into_iter().flat_map(|ranking| &ranking.entries);
    let there = entries.filter(|entry| {
        entry.track != SharedModel::Native && entry.cpu_s.is_some_and(CostAt::reached)
    });
    let there = there.count();
    let off = limit(study.options.target);
    let why = format!("within {off} of our converged run");
    let mark = if there > 0 { Mark::Good } else { Mark::Warn };
    let apart = format::relative(study.reference.apart.forces);
    let second = "of forces: the converged run, from a second one by another method";
    let answer = format::counted(there, "peer agrees", "peers agree");
    let right = Question::Right.answered(mark, answer, why);
    let sure = Question::Sure.answered(Mark::None, format!("to {apart}"), second);
    let next = crate::pages::next(origin, "compare", "whether engines agree on this scene");
    [Some(right), None, Some(sure), Some(next)]
}

fn verdict(study: &WorkPrecision, ranking: &Ranking) -> Option<Verdict> {
    let lead = ranking.advantage.as_ref()?;
    let factor = significant(lead.ratio, 2);
    let bound = " A bound stands where a series ends before this error.";
    let [least, bound] = match lead.at_least {
        true => ["at least ", bound],
        false => [""; 2],
    };
    let peer = match lead.peer_cpu_s.reached() {
        true => "the fastest peer that got there",
        false => "any peer: none got there",
    };
    Some(Verdict {
        tone: Tone::Neutral,
        headline: format!(
            "At a force error of {} the native solver is {least}{factor} times faster than {peer}",
            limit(ranking.error),
        ),
        detail: format!(
            "{} takes {} of CPU time, {} takes {}; relative L2 error of all pin forces over the whole {} s, \
             start-up included; interpolated between runs in the log-log plane.{}",
            lead.native,
            figures::cpu(lead.native_cpu_s),
            lead.peer,
            figures::cpu(lead.peer_cpu_s),
            study.scene.solver.duration_s,
            bound
        ),
    })
}

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
        .text("", "note", |(series, entry)| match entry.cpu_s {
            Some(cost) if cost.reached() => String::new(),
            _ => figures::end(series),
        })
        .marked(|_| Mark::Muted);
    let (name, error) = (&study.scene.name, ranking.error);
    let over_s = study.scene.solver.duration_s;
    let title = format!("{name}: cost of a relative L2 force error of {error:e} over {over_s} s");
    let both = [&study.reference.solution, &study.reference.second];
    let [first, second] = both.map(|of| &of.method);
    let apart = study.reference_errors[0].force_l2;
    let reference = format!("reference: {first} against {second}, apart {apart:.1e}\n");
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
    titled(&title, [table, reference, paragraphs(lead)])
}
