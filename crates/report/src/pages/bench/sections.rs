//! Sections: costs at given errors, work-precision plots, the reference, differences, all points.

use crate::format::{NONE, joined, limit, plain};
use crate::study::{Axis, Block, Chart, Section, Series, Style};
use pinwheel_engines::{AccuracySetting, SharedModel};
use pinwheel_studies::bench::{self, Advantage, CostAt, Errors, Measure, Ranking, WorkPrecision};
use pinwheel_studies::reference::Solution;
use pinwheel_timeseries::table::{Mark, Shown, Table};

use super::figures;
use crate::pages::colours;

/// Returns all sections of the scene.
pub(super) fn all(study: &WorkPrecision, rankings: &[Ranking]) -> Vec<Section> {
    vec![
        plots(study),
        costs(study, rankings),
        reference(study).folded("What errors are measured against, and its own"),
        differences(study).folded("What the figures do not compare"),
        points(study).folded("Every step and tolerance of every series"),
    ]
}

/// Returns the section with the cost of accuracy.
fn costs(study: &WorkPrecision, rankings: &[Ranking]) -> Section {
    let windows = study.windows.len().min(rankings.len());
    let (by_window, by_error) = rankings.split_at(windows);
    let target = study.options.target;
    let entry = |ranking: &Ranking, k: usize| ranking.entries.get(k).and_then(|e| e.cpu_s);
    let caption = format!("Cost of a force error of {}", limit(target));
    let mut table = Table::of(caption, study.series.iter().enumerate())
        .text("", "Engine and method", |(_, series)| series.label())
        .text("", "Shares", |(_, series)| series.track.shares());
    for ranking in by_window {
        let label = format!("CPU, {}", ranking.window);
        table = figures::column(table, &label, figures::cpu, |(k, _)| entry(ranking, *k));
    }
    table = figures::column(table, "RHS calls, whole", figures::count, |(k, _)| {
        by_window.first()?.entries.get(*k)?.rhs_calls
    });
    for ranking in by_error {
        let label = format!("CPU at {}", limit(ranking.error));
        table = figures::column(table, &label, figures::cpu, |(k, _)| entry(ranking, *k));
    }
    let table = table
        .text("", "Series ends", |(_, series)| figures::end(series))
        .marked(|(_, series)| match figures::failure(series) {
            Some(_) => Mark::Warn,
            None => Mark::Muted,
        });
    Section::new("costs", "Costs")
        .with(format!(
            "CPU time at which each series reaches a relative L2 error of {} in all pin forces, window by window; \
             after that, over the whole run, ten times that error and a tenth of it. Costs are interpolated on the \
             front of each series in the log-log plane; `\u{2264}` says that the coarsest run is already better, `>` \
             that the finest is still worse.",
            limit(target)
        ))
        .with(table)
        .with(leads(rankings))
}

/// Returns the native solver's lead over the fastest peer, by window.
fn leads(rankings: &[Ranking]) -> Table {
    let lead = |ranking: &Ranking, side: fn(&Advantage) -> (&String, CostAt)| {
        let side = ranking.advantage.as_ref().map(side);
        let words = side.map(|(name, cost)| format!("{name}, {}", figures::cpu(cost)));
        words.unwrap_or_else(|| NONE.to_owned())
    };
    Table::of("The native solver against the fastest peer", rankings)
        .text("", "Window", |ranking| &ranking.window)
        .number("", "Force error", |ranking| ranking.error)
        .display(|ranking| limit(ranking.error))
        .text("", "Fastest native", |ranking| {
            lead(ranking, |of| (&of.native, of.native_cpu_s))
        })
        .text("", "Fastest peer", |ranking| {
            lead(ranking, |of| (&of.peer, of.peer_cpu_s))
        })
        .number("", "Ratio of CPU times", |ranking| {
            Some(ranking.advantage.as_ref()?.ratio)
        })
        .display(|ranking| {
            let lead = ranking.advantage.as_ref()?;
            Some(format!("{}{:.1}", figures::at_least(lead), lead.ratio))
        })
        .done()
}

/// Returns charts of error against cost, two a window.
fn plots(study: &WorkPrecision) -> Section {
    let mut section = Section::new("plots", "Work and precision").with(
        "Each point is one step or tolerance, its cost the least CPU time of several runs. Lower and further left is \
         better.",
    );
    let charts = |window: usize, saddle_point: bool| {
        let both = [Measure::Cpu, Measure::Rhs];
        Block::Charts(both.map(|of| chart(study, window, of, saddle_point)).into())
    };
    for (k, window) in study.windows.iter().enumerate() {
        let title = format!("{}: {} s to {} s", window.name, window.from_s, window.to_s);
        let charts = charts(k, false);
        // The first pair of charts is unfolded.
        section = section.with(match k {
            0 => charts,
            _ => Block::folded(title, charts),
        });
    }
    if study.series.iter().any(is_saddle_point) {
        let title = "The saddle-point form: all bodies and joints, factored along the joint tree";
        section = section.with(Block::folded(title, charts(0, true)));
    }
    section
}

fn is_saddle_point(series: &bench::Series) -> bool {
    series.engine == "native-lagrange"
}

fn chart(study: &WorkPrecision, window: usize, measure: Measure, saddle_point: bool) -> Chart {
    // An engine and method has one colour on all charts.
    let labels: Vec<String> = study.series.iter().map(bench::Series::label).collect();
    let styles = colours::by_name(labels.iter().map(String::as_str));
    let all = study.series.iter();
    let all = all.filter(|series| is_saddle_point(series) == saddle_point);
    let series = all.filter_map(|series| {
        let (x, y): (Vec<f64>, Vec<f64>) = series.points(window, measure).into_iter().unzip();
        let finished = series.points.iter().filter(|p| !p.errors.is_empty());
        let name = match series.knob {
            AccuracySetting::Step => "step",
            AccuracySetting::Tolerance => "tolerance",
        };
        let tags = finished.map(|p| format!("{name} {}", plain(p.setting)));
        let drawn = Series {
            // Engines that do not count calls have fewer points than settings.
            tags: tags.take(x.len()).collect(),
            colour: styles.get(series.label().as_str()).copied(),
            ..Series::line(series.label(), x, y).styled(Style::Both)
        };
        (!drawn.x.is_empty()).then_some(drawn)
    });
    let mut series: Vec<Series> = series.collect();
    let floor = study.reference_errors[window].force_l2;
    let costs = series.iter().flat_map(|s| s.x.iter().copied());
    let least = costs.clone().fold(f64::INFINITY, f64::min);
    let ends = [least, costs.fold(0.0, f64::max)];
    if floor > 0.0 && !series.is_empty() {
        let own = Series::line("reference's own error", ends, [floor; 2]);
        series.push(own.styled(Style::Dashed));
    }
    let (title, axis, note) = match measure {
        Measure::Cpu => ("Error against CPU time", "CPU time (s)", ""),
        Measure::Rhs => (
            "Error against right-hand sides",
            "right-hand-side calls",
            "These do not depend on the machine, and do not see what an engine spends beside them.",
        ),
    };
    let y = Axis::log("relative L2 force error");
    Chart {
        note: note.to_owned(),
        ..Chart::new(title, Axis::log(axis), y, series)
    }
}

/// Returns the converged run and its error.
fn reference(study: &WorkPrecision) -> Section {
    let reference = &study.reference;
    let named = |solution: &Solution| {
        let (knob, unit) = match AccuracySetting::of(&solution.method) {
            AccuracySetting::Step => ("steps of", " s"),
            AccuracySetting::Tolerance => ("tolerance", ""),
        };
        let (method, setting) = (&solution.method, plain(solution.setting));
        let calls = figures::calls(solution.rhs_calls as f64);
        format!("`{method}`, {knob} {setting}{unit}, {calls} right-hand sides")
    };
    let rows = study.windows.iter().zip(&study.reference_errors);
    let mut table =
        Table::of("Distance of the two", rows).text("", "Window", |(window, _)| &window.name);
    const DISTANCES: [(&str, fn(&Errors) -> f64); 4] = [
        ("Forces, L2", |errors| errors.force_l2),
        ("Forces, L\u{221e}", |errors| errors.force_max),
        ("Driver torque, L2", |errors| errors.torque_l2),
        ("Driver torque, L\u{221e}", |errors| errors.torque_max),
    ];
    for (label, of) in DISTANCES {
        table = table
            .number("", label, |(_, errors)| of(errors))
            .shown(Shown::Relative);
    }
    Section::new("reference", "Reference")
        .with(format!(
                "Everything is measured against the reduced form by {}. A second method, {}, gives the same time \
                 series up to the distances below: the error of the worse of \
                 the two, and so an upper estimate of the reference's. Errors near it say no more than that they are \
                 small.",
                named(&reference.solution),
                named(&reference.second)
            ))
            .with(table)
}

/// Returns the section on differences of the engines outside the figures.
fn differences(study: &WorkPrecision) -> Section {
    let mut points = vec![
        "The native solver integrates the equations of this mechanism, three or so in the reduced form; peers are general \
         engines that carry every body and joint. `native-lagrange` carries them too, and is the fairer comparison \
         of like with like."
            .to_owned(),
        "CPU time is that of the running thread, from the first step to the last sample. Building the model is left \
         out for all."
            .to_owned(),
        "Every engine records the same samples. The native solver also keeps its energy account, which peers do not \
         have; its cost is in the native figures."
            .to_owned(),
    ];
    let mut series = study.series.iter();
    if series.any(|s| s.track == SharedModel::OwnContact) {
        points.push(
            "Own-contact engines resolve contact or friction themselves. Their error here holds the difference of the \
             models, and does not vanish with the step."
                .to_owned(),
        );
    }
    let uncounted = study.series.iter().filter(|s| {
        let mut costs = s.points.iter().filter_map(|p| p.cost).peekable();
        costs.peek().is_some() && costs.all(|cost| cost.rhs_calls.is_none())
    });
    let uncounted = joined(", ", uncounted.map(|s| &s.engine));
    if !uncounted.is_empty() {
        points.push(format!("Right-hand sides are not counted by {uncounted}."));
    }
    let details = study.differences.iter();
    let details = details.map(|(name, text)| format!("`{name}`: {text}").into());
    let details: Vec<Block> = details.collect();
    let title = "How each engine differs, in its own words";
    Section::new("unequal", "What is unequal")
        .with(Block::List(points))
        .with(Block::folded(title, details))
}

/// Returns every point of every series.
fn points(study: &WorkPrecision) -> Section {
    let all = study.table();
    let mut first = 0;
    let tables = study.series.iter().map(|series| {
        let rows = first..first + series.points.len();
        first = rows.end;
        let mut table = all.clone().rows(|row| rows.contains(&row)).without_empty();
        table.caption = series.label();
        let summary = format!("{} ({} settings)", series.label(), series.points.len());
        Block::folded(summary, table)
    });
    Section::new("points", "All runs")
        .with(
            "The same figures, at full precision and with the errors of the driver torque, stand in `bench.csv` beside \
             this page.",
        )
        .with(tables.collect::<Vec<_>>())
}
