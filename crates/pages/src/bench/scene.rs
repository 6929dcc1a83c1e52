//! The scene's sections: costs at given errors, work-precision plots, the reference, what is unequal, all points.

use pinwheel_courses::Ending;
use pinwheel_engines::Track;
use pinwheel_report::colours;
use pinwheel_report::format::{limit, relative, seconds};
use pinwheel_report::study::{
    Axis, Block, Cell, Chart, Column, Mark, Section, Series, Style, Table,
};
use pinwheel_studies::bench::{
    self, Errors, Knob, Measure, Point, Ranking, Solution, WorkPrecision,
};

use super::figures;

/// All sections of the scene.
pub(super) fn sections(study: &WorkPrecision, rankings: &[Ranking]) -> Vec<Section> {
    vec![
        plots(study),
        costs(study, rankings),
        reference(study).folded("What errors are measured against, and its own"),
        differences(study).folded("What the figures do not compare"),
        points(study).folded("Every step and tolerance of every series"),
    ]
}

/// What errors cost.
fn costs(study: &WorkPrecision, rankings: &[Ranking]) -> Section {
    let windows = study.windows.len().min(rankings.len());
    let (by_window, by_error) = rankings.split_at(windows);
    let target = study.options.target;
    let mut columns = vec![Column::text("Engine and method"), Column::text("Track")];
    for ranking in by_window {
        columns.push(Column::number(format!("CPU, {}", ranking.window)));
    }
    columns.push(Column::number("RHS calls, whole"));
    for ranking in by_error {
        columns.push(Column::number(format!("CPU at {}", limit(ranking.error))));
    }
    columns.push(Column::text("Series ends"));
    let rows = study.series.iter().enumerate().map(|(k, series)| {
        let entry = |ranking: &Ranking| ranking.entries.get(k).and_then(|entry| entry.cpu_s);
        let mut row = vec![
            Cell::text(series.label()),
            Cell::text(series.track.as_str()),
        ];
        row.extend(
            by_window
                .iter()
                .map(|r| figures::cell(entry(r), figures::cpu)),
        );
        let calls = by_window.first().and_then(|r| r.entries.get(k)?.rhs_calls);
        row.push(figures::cell(calls, figures::count));
        row.extend(
            by_error
                .iter()
                .map(|r| figures::cell(entry(r), figures::cpu)),
        );
        let end = figures::failure(series).map_or_else(
            || Cell::text(series.stopped.words()).marked(Mark::Muted),
            |reason| Cell::text(reason).marked(Mark::Warn),
        );
        row.push(end);
        row
    });
    let mut blocks = vec![
        Block::Text(format!(
            "CPU time at which each series reaches a relative L2 error of {} in all sleeve forces, window by window; \
             after that, over the whole run, ten times that error and a tenth of it. Costs are interpolated on the \
             front of each series in the log-log plane; `\u{2264}` says that the coarsest run is already better, `>` \
             that the finest is still worse.",
            limit(target)
        )),
        Block::Table(Table {
            caption: format!("Cost of a force error of {}", limit(target)),
            columns,
            rows: rows.collect(),
        }),
    ];
    blocks.push(leads(rankings));
    Section {
        id: "costs".to_owned(),
        title: "Costs".to_owned(),
        blocks,
    }
}

/// The native solver against the fastest peer, window by window.
fn leads(rankings: &[Ranking]) -> Block {
    let rows = rankings.iter().map(|ranking| {
        let mut row = vec![
            Cell::text(ranking.window.clone()),
            Cell::number(limit(ranking.error), ranking.error),
        ];
        match &ranking.advantage {
            None => row.extend(["\u{2013}", "\u{2013}", "\u{2013}"].map(Cell::text)),
            Some(lead) => row.extend([
                Cell::text(format!(
                    "{}, {}",
                    lead.native,
                    figures::cpu(lead.native_cpu_s)
                )),
                Cell::text(format!("{}, {}", lead.peer, figures::cpu(lead.peer_cpu_s))),
                Cell::number(
                    format!(
                        "{}{:.1}",
                        if lead.at_least {
                            "\u{2265}\u{202f}"
                        } else {
                            ""
                        },
                        lead.ratio
                    ),
                    lead.ratio,
                ),
            ]),
        }
        row
    });
    Block::Table(Table {
        caption: "The native solver against the fastest peer".to_owned(),
        columns: vec![
            Column::text("Window"),
            Column::number("Force error"),
            Column::text("Fastest native"),
            Column::text("Fastest peer"),
            Column::number("Ratio of CPU times"),
        ],
        rows: rows.collect(),
    })
}

/// Error against cost, two charts a window.
fn plots(study: &WorkPrecision) -> Section {
    let mut blocks = vec![Block::Text(
        "Each point is one step or tolerance, its cost the least CPU time of several runs. Lower and further left is \
         better. Right-hand-side calls do not depend on the machine, and do not see what an engine spends beside \
         them."
            .to_owned(),
    )];
    let reduced = |series: &bench::Series| series.engine != "native-lagrange";
    for (k, window) in study.windows.iter().enumerate() {
        let title = format!("{}: {} s to {} s", window.name, window.from_s, window.to_s);
        let charts = Block::Charts(vec![
            chart(study, k, Measure::Cpu, &reduced),
            chart(study, k, Measure::Rhs, &reduced),
        ]);
        // One pair is read first.
        blocks.push(match k {
            0 => charts,
            _ => Block::Details {
                summary: title,
                blocks: vec![charts],
            },
        });
    }
    let lagrange = |series: &bench::Series| series.engine == "native-lagrange";
    if study.series.iter().any(lagrange) {
        blocks.push(Block::Details {
            summary: "The saddle-point form: all bodies and joints, factored along the joint tree"
                .to_owned(),
            blocks: vec![Block::Charts(vec![
                chart(study, 0, Measure::Cpu, &lagrange),
                chart(study, 0, Measure::Rhs, &lagrange),
            ])],
        });
    }
    Section {
        id: "plots".to_owned(),
        title: "Work and precision".to_owned(),
        blocks,
    }
}

fn chart(
    study: &WorkPrecision,
    window: usize,
    measure: Measure,
    take: &dyn Fn(&bench::Series) -> bool,
) -> Chart {
    // An engine and method has one colour on all charts.
    let labels: Vec<String> = study.series.iter().map(bench::Series::label).collect();
    let names: Vec<&str> = labels.iter().map(String::as_str).collect();
    let styles = colours::styles(&names);
    let colour = |label: &str| Some(styles[names.iter().position(|name| *name == label)?]);
    let series = study
        .series
        .iter()
        .filter(|series| take(series))
        .filter_map(|series| {
            let points = series.points(window, measure);
            if points.is_empty() {
                return None;
            }
            let finished = series.points.iter().filter(|p| !p.errors.is_empty());
            let name = match series.knob {
                Knob::StepS => "step",
                Knob::Tolerance => "tolerance",
            };
            Some(Series {
                label: series.label(),
                style: Style::Both,
                x: points.iter().map(|p| p.0).collect(),
                y: points.iter().map(|p| p.1).collect(),
                tags: finished
                    .map(|p| format!("{name} {}", figures::setting(p.setting)))
                    .collect(),
                colour: colour(&series.label()),
            })
        });
    let mut series: Vec<Series> = series.collect();
    for one in &mut series {
        // Engines that do not count calls have fewer points than settings.
        one.tags.truncate(one.x.len());
        if one.tags.len() < one.x.len() {
            one.tags.clear();
        }
    }
    let floor = study.reference.error(window).force_l2;
    let most = |get: fn(f64, f64) -> f64, start: f64| {
        series
            .iter()
            .flat_map(|s| s.x.iter().copied())
            .fold(start, get)
    };
    let ends = vec![most(f64::min, f64::INFINITY), most(f64::max, 0.0)];
    if floor > 0.0 && !series.is_empty() {
        series.push(Series {
            label: "reference's own error".to_owned(),
            style: Style::Dashed,
            y: vec![floor; 2],
            x: ends,
            ..Series::default()
        });
    }
    let (title, axis) = match measure {
        Measure::Cpu => ("Error against CPU time", "CPU time (s)"),
        Measure::Rhs => ("Error against right-hand sides", "right-hand-side calls"),
    };
    Chart {
        title: title.to_owned(),
        x: Axis::log(axis),
        y: Axis::log("relative L2 force error"),
        series,
        note: String::new(),
    }
}

/// The converged run and its error.
fn reference(study: &WorkPrecision) -> Section {
    let found = &study.reference;
    let named = |solution: &Solution| {
        let knob = match solution.knob {
            Knob::StepS => "steps of",
            Knob::Tolerance => "tolerance",
        };
        let unit = match solution.knob {
            Knob::StepS => " s",
            Knob::Tolerance => "",
        };
        format!(
            "`{}`, {knob} {}{unit}, {} right-hand sides",
            solution.method,
            figures::setting(solution.setting),
            figures::calls(solution.rhs_calls as f64)
        )
    };
    let row = |name: &str, what: &str, errors: &Errors| {
        vec![
            Cell::text(name),
            Cell::text(what),
            Cell::number(relative(errors.force_l2), errors.force_l2),
            Cell::number(relative(errors.force_max), errors.force_max),
            Cell::number(relative(errors.torque_l2), errors.torque_l2),
            Cell::number(relative(errors.torque_max), errors.torque_max),
        ]
    };
    let coarser = format!(
        "{}, coarser: {}",
        found.solution.method,
        figures::setting(found.coarser_setting)
    );
    let mut rows = Vec::new();
    for (k, window) in study.windows.iter().enumerate() {
        rows.push(row(
            &window.name,
            &found.second.method,
            &found.between_methods[k],
        ));
        rows.push(row(&window.name, &coarser, &found.to_coarser[k]));
    }
    Section {
        id: "reference".to_owned(),
        title: "Reference".to_owned(),
        blocks: vec![
            Block::Text(format!(
                "Everything is measured against the reduced form by {}. A second method that shares nothing with the \
                 first but the forces, {}, gives the same courses up to the distances below: the error of the worse of \
                 the two, and so an upper estimate of the reference's. Errors near it say no more than that they are \
                 small.",
                named(&found.solution),
                named(&found.second)
            )),
            Block::Table(Table {
                caption: "Distance from the reference".to_owned(),
                columns: vec![
                    Column::text("Window"),
                    Column::text("Run"),
                    Column::number("Forces, L2"),
                    Column::number("Forces, L\u{221e}"),
                    Column::number("Driver torque, L2"),
                    Column::number("Driver torque, L\u{221e}"),
                ],
                rows,
            }),
        ],
    }
}

/// What the figures do not compare.
fn differences(study: &WorkPrecision) -> Section {
    let has = |name: &str| study.series.iter().any(|s| s.engine.starts_with(name));
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
    if has("rapier") {
        points.push(
            "rapier is made for games: fixed steps, impulse joints found by sweeps, and a first-order method, \
             semi-implicit Euler, that is driven here as leapfrog to be of second order. It gets the same compiled \
             contact law as the native solver, once a step."
                .to_owned(),
        );
    }
    if has("mujoco") {
        points.push(
            "MuJoCo is driven from Python, with the contact law as a compiled callback in every stage of its \
             Runge-Kutta method: the loop over steps costs Python time, the law does not. It carries joint angles \
             and needs no constraints."
                .to_owned(),
        );
    }
    if has("exudyn") {
        points.push(
            "exudyn calls its force functions through Python at every evaluation, which is part of its CPU time, \
             though the law behind them is compiled; its own solvers are compiled as well."
                .to_owned(),
        );
    }
    if study.series.iter().any(|s| s.track == Track::OwnContact) {
        points.push(
            "Own-contact engines resolve contact or friction themselves. Their error here holds the difference of the \
             models, and does not vanish with the step."
                .to_owned(),
        );
    }
    let uncounted: Vec<&str> = study
        .series
        .iter()
        .filter(|s| {
            let mut costs = s.points.iter().filter_map(|p| p.cost).peekable();
            costs.peek().is_some() && costs.all(|cost| cost.rhs_calls.is_none())
        })
        .map(|s| s.engine.as_str())
        .collect();
    if !uncounted.is_empty() {
        points.push(format!(
            "Right-hand sides are not counted by {}.",
            uncounted.join(", ")
        ));
    }
    let details = study
        .differences
        .iter()
        .map(|(name, text)| Block::Text(format!("`{name}`: {text}")))
        .collect();
    Section {
        id: "unequal".to_owned(),
        title: "What is unequal".to_owned(),
        blocks: vec![
            Block::List(points),
            Block::Details {
                summary: "How each engine differs, in its own words".to_owned(),
                blocks: details,
            },
        ],
    }
}

/// Every point of every series.
fn points(study: &WorkPrecision) -> Section {
    let mut columns = vec![
        Column::text("Step or tolerance"),
        Column::number("CPU, minimum"),
        Column::number("CPU, median"),
        Column::number("Runs"),
        Column::number("RHS calls"),
        Column::number("Steps"),
    ];
    for window in &study.windows {
        columns.push(Column::number(format!("{}: forces L2", window.name)));
        columns.push(Column::number(format!("{}: forces L\u{221e}", window.name)));
    }
    columns.push(Column::text("Ended"));
    let tables = study.series.iter().map(|series| {
        let table = Table {
            caption: series.label(),
            columns: columns.clone(),
            rows: series
                .points
                .iter()
                .map(|point| row(point, series.knob, study.windows.len()))
                .collect(),
        };
        Block::Details {
            summary: format!("{} ({} settings)", series.label(), series.points.len()),
            blocks: vec![Block::Table(table)],
        }
    });
    let mut blocks = vec![Block::Text(
        "The same figures, at full precision and with the errors of the driver torque, stand in `bench.csv` beside \
         this page."
            .to_owned(),
    )];
    blocks.extend(tables);
    Section {
        id: "points".to_owned(),
        title: "All runs".to_owned(),
        blocks,
    }
}

fn row(point: &Point, knob: Knob, windows: usize) -> Vec<Cell> {
    let unit = match knob {
        Knob::StepS => " s",
        Knob::Tolerance => "",
    };
    let mut row = vec![Cell::number(
        format!("{}{unit}", figures::setting(point.setting)),
        point.setting,
    )];
    match point.cost {
        Some(cost) => row.extend([
            Cell::number(seconds(cost.cpu_min_s), cost.cpu_min_s),
            Cell::number(seconds(cost.cpu_median_s), cost.cpu_median_s),
            Cell::number(cost.runs.to_string(), cost.runs as f64),
            cost.rhs_calls.map_or_else(
                || Cell::text("\u{2013}"),
                |n| Cell::number(n.to_string(), n as f64),
            ),
            Cell::number(cost.steps.to_string(), cost.steps as f64),
        ]),
        None => row.extend(std::iter::repeat_n(Cell::text("\u{2013}"), 5)),
    }
    for errors in &point.errors {
        row.push(Cell::number(relative(errors.force_l2), errors.force_l2));
        row.push(Cell::number(relative(errors.force_max), errors.force_max));
    }
    let missing = 2 * (windows - point.errors.len());
    row.extend(std::iter::repeat_n(Cell::text("\u{2013}"), missing));
    row.push(match &point.ending {
        Ending::Finished => Cell::text("finished").marked(Mark::Muted),
        Ending::Diverged { time_s, quantity } => {
            Cell::text(format!("diverged at {time_s:.4} s: {quantity}")).marked(Mark::Bad)
        }
        Ending::TimedOut { time_s, .. } => {
            Cell::text(format!("given up at {time_s:.4} s of simulated time")).marked(Mark::Warn)
        }
        Ending::Failed { reason } | Ending::Unsupported { reason } | Ending::Absent { reason } => {
            Cell::text(reason.clone()).marked(Mark::Bad)
        }
    });
    row
}
