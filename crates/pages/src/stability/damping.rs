//! Why the published model does not converge above C = 8 N s/m and ours does: the answer, from the figures of this run.

use pinwheel_report::format;
use pinwheel_report::study::{
    Axis, Block, Cell, Chart, Column, Mark, Section, Series, Style, Table,
};
use pinwheel_studies::published::{Entry, LEAST_DAMPING, Limit, MOST_DAMPING, SWITCHES, Switch};
use pinwheel_studies::survey::Survey;

/// Above this the published model did not converge, N s/m.
const PUBLISHED: f64 = 8.0;

/// The section; `None` where the study had no part of it.
pub(super) fn section(survey: &Survey) -> Option<Section> {
    let entries: Vec<&Entry> = survey.published.iter().flatten().flatten().collect();
    let limits: Vec<&Limit> = survey.limits.iter().flatten().collect();
    if entries.is_empty() && limits.is_empty() {
        return None;
    }
    let mut blocks = vec![
        Block::Text(
            "The paper reports that its model stops converging when the contact damping is raised above 8 N s/m. Its choices are \
             switched on here one at a time, on the preset `paper`."
                .to_owned(),
        ),
        Block::List(answer(&entries, &limits)),
    ];
    let mut tables = Vec::new();
    if !limits.is_empty() {
        tables.push(limit_table(&limits));
    }
    if !entries.is_empty() {
        tables.push(error_table(survey, &entries));
        blocks.push(Block::Charts(vec![chart(survey, &entries)]));
    }
    blocks.push(Block::Details {
        summary: "Limits and errors in figures".to_owned(),
        blocks: tables,
    });
    Some(Section {
        id: "damping".to_owned(),
        title: "Above C = 8".to_owned(),
        blocks,
    })
}

/// What the figures say; every sentence is there only if they do.
fn answer(entries: &[&Entry], limits: &[&Limit]) -> Vec<String> {
    let mut said = Vec::new();
    let above: Vec<&&Entry> = entries
        .iter()
        .filter(|e| e.damping_n_s_m > PUBLISHED)
        .collect();
    let failed: Vec<String> = above
        .iter()
        .filter_map(|e| {
            let how = e.failure.as_ref()?;
            Some(format!(
                "{} at C = {}: {how}",
                e.switch.words(),
                e.damping_n_s_m
            ))
        })
        .collect();
    if !above.is_empty() {
        said.push(if failed.is_empty() {
            format!(
                "None of the {} runs above C = 8 failed, whatever was switched on.",
                above.len()
            )
        } else {
            format!(
                "Of {} runs above C = 8 these failed: {}.",
                above.len(),
                failed.join("; ")
            )
        });
    }
    let steps: Vec<f64> = limits.iter().map(|l| l.step_s).collect();
    let coarsest = steps.iter().copied().fold(0.0, f64::max);
    let find = |switch: Switch, step: f64| {
        limits
            .iter()
            .find(|l| l.switch == switch && l.step_s == step)
    };
    let printed = limits
        .iter()
        .filter(|l| l.switch != Switch::Millimetres && l.step_s == coarsest);
    if let Some(lowest) = printed.min_by(|a, b| a.damping_n_s_m.total_cmp(&b.damping_n_s_m)) {
        let ours = find(Switch::Step, coarsest).map_or_else(String::new, |ours| {
            format!(" Ours, with nothing switched on, stands {}.", damping(ours))
        });
        said.push(format!(
            "At the paper's method and a step of {} the lowest of the limits is C = {} ({}), {} than 8.{ours}",
            format::seconds(coarsest),
            damping(lowest),
            lowest.switch.words(),
            if lowest.damping_n_s_m > PUBLISHED {
                format!("{:.0} times higher", lowest.damping_n_s_m / PUBLISHED)
            } else {
                "not higher".to_owned()
            }
        ));
        said.push(if lowest.damping_n_s_m > PUBLISHED {
            "So none of the choices that the paper prints, alone or together, explains why it stopped at 8: what stopped it is \
             something it does not print."
                .to_owned()
        } else {
            format!("So {} explains it.", lowest.switch.words())
        });
    }
    let finest = steps.iter().copied().fold(f64::INFINITY, f64::min);
    if let (Some(coarse), Some(fine)) = (
        find(Switch::Unclamped, coarsest),
        find(Switch::Unclamped, finest),
    ) && finest < coarsest
        && coarse.damping_n_s_m > 0.0
    {
        said.push(format!(
            "Without the clamp the limit grows {:.1} times when the step is divided by {:.0}: an explicit method on a viscous damper, \
             h C = {:.3} kg. At C = 8 that would be a step of {}.",
            fine.damping_n_s_m / coarse.damping_n_s_m,
            coarsest / finest,
            coarse.damping_n_s_m * coarsest,
            format::seconds(coarse.damping_n_s_m * coarsest / PUBLISHED),
        ));
    }
    if let Some(wrong) = find(Switch::Millimetres, coarsest) {
        said.push(format!(
            "A guess outside the print, Eq. 17 computed in millimetres: its factor 1 - R is then -5, and the damping feeds energy in. \
             Its limit is C = {}, but the paper finds that more damping, up to 8, gives smoother courses, which contradicts it.",
            damping(wrong)
        ));
    }
    let points = |c: fn(&Entry) -> Option<f64>| {
        let values: Vec<f64> = entries
            .iter()
            .filter(|e| e.switch == Switch::Points)
            .filter_map(|e| c(e))
            .collect();
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        (!values.is_empty()).then(|| (low, values.iter().copied().fold(0.0, f64::max)))
    };
    if let (Some((low, high)), Some((smooth, rough))) = (
        points(|e| e.error.map(|e| e.forces)),
        points(|e| e.roughness),
    ) {
        said.push(format!(
            "What is wrong with the published model at every C is its 600 points: {} to {} of the forces. More damping does smooth them \
             (change of the driver torque from sample to sample {} at worst, {} at best), as the paper observes.",
            format::relative(low),
            format::relative(high),
            format::relative(rough),
            format::relative(smooth),
        ));
    }
    said
}

fn damping(limit: &Limit) -> String {
    if limit.failure.is_none() {
        format!("above {MOST_DAMPING:.0}")
    } else if limit.damping_n_s_m == 0.0 {
        format!("below {LEAST_DAMPING}")
    } else {
        // Found to 10 %: two digits.
        let unit = 10_f64.powf(limit.damping_n_s_m.log10().floor() - 1.0);
        let rounded = (limit.damping_n_s_m / unit).round() * unit;
        format!("{:.*}", if unit < 1.0 { 2 } else { 0 }, rounded)
    }
}

/// A row a choice, a column a step, and how it ends above the limit at the coarsest.
fn limit_table(limits: &[&Limit]) -> Block {
    let mut steps: Vec<f64> = Vec::new();
    let mut switches: Vec<Switch> = Vec::new();
    for limit in limits {
        if !steps.contains(&limit.step_s) {
            steps.push(limit.step_s);
        }
        if !switches.contains(&limit.switch) {
            switches.push(limit.switch);
        }
    }
    steps.sort_by(|a, b| b.total_cmp(a));
    let rows = switches.iter().map(|&switch| {
        let at = |step: f64| {
            limits
                .iter()
                .find(|l| l.switch == switch && l.step_s == step)
        };
        let mut row = vec![Cell::text(switch.words())];
        row.extend(steps.iter().map(|&step| match at(step) {
            Some(limit) => Cell::number(damping(limit), limit.damping_n_s_m),
            None => Cell::text("-").marked(Mark::Muted),
        }));
        let how = steps.iter().find_map(|&step| at(step)?.failure.clone());
        row.push(Cell::text(how.map_or_else(|| "-".to_owned(), shortened)));
        row
    });
    let mut columns = vec![Column::text("Switched on")];
    columns.extend(
        steps
            .iter()
            .map(|&step| Column::number(format!("C at {}", format::seconds(step)))),
    );
    columns.push(Column::text("How it fails above"));
    Block::Table(Table {
        caption: "Largest damping (N s/m) with forces below twice those of the converged run at C = 8: Heun, 0.05 s, to 10 %"
            .to_owned(),
        columns,
        rows: rows.collect(),
    })
}

/// An error's time without its reason, which is in summary.json.
fn shortened(how: String) -> String {
    match how.split_once(": ") {
        Some((when, _)) => format!("stopped with an error {when}"),
        None => how,
    }
}

fn error_table(survey: &Survey, entries: &[&Entry]) -> Block {
    let dampings = &survey.plan.dampings;
    let mut columns = vec![Column::text("Switched on")];
    columns.extend(dampings.iter().map(|c| Column::number(format!("C = {c}"))));
    let rows = SWITCHES
        .iter()
        .filter(|&&s| s != Switch::Converged)
        .map(|&switch| {
            let mut row = vec![Cell::text(switch.words())];
            row.extend(dampings.iter().map(|&c| {
                let entry = entries
                    .iter()
                    .find(|e| e.switch == switch && e.damping_n_s_m == c);
                match entry.map(|e| (&e.error, &e.failure)) {
                    Some((Some(error), _)) => {
                        Cell::number(format::relative(error.forces), error.forces)
                    }
                    Some((None, Some(how))) => Cell::text(how).marked(Mark::Bad),
                    _ => Cell::text("-").marked(Mark::Muted),
                }
            }));
            row
        });
    Block::Table(Table {
        caption: format!(
            "Forces in the second half of {} s, against our converged run at the same damping",
            survey.plan.published_s
        ),
        columns,
        rows: rows.collect(),
    })
}

fn chart(survey: &Survey, entries: &[&Entry]) -> Chart {
    let series = SWITCHES
        .iter()
        .filter(|&&s| s != Switch::Converged)
        .map(|&switch| {
            let found = survey.plan.dampings.iter().filter_map(|&c| {
                let entry = entries
                    .iter()
                    .find(|e| e.switch == switch && e.damping_n_s_m == c)?;
                Some((c, entry.error?.forces))
            });
            let (x, y) = found.unzip();
            Series {
                label: switch.words().to_owned(),
                style: Style::Both,
                x,
                y,
                ..Series::default()
            }
        });
    Chart {
        title: "What each choice costs".to_owned(),
        x: Axis::log("C (N s/m)"),
        y: Axis::log("relative L2 error of the forces"),
        series: series.collect(),
        note: "Points are wrong at every damping; the other choices are small at 8 and stay so."
            .to_owned(),
    }
}
