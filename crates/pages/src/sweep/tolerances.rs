//! What a sample says, on the page and on a terminal.

use pinwheel_compare::quantities::label_and_unit;
use pinwheel_report::format::significant;
use pinwheel_report::study::{
    Axis, Block, Cell, Chart, Column as Heading, Section, Series, Table, Tone, Verdict,
};
use pinwheel_studies::sweep::{Column, Figure, Found, Limit, Plan, Quantile, Results, Yield};

/// Figures that are shown at most; summary.json has all.
const MOST_FIGURES: usize = 20;
/// Charts at most.
const MOST_CHARTS: usize = 6;
/// Keys that are named as what decides.
const MOST_KEYS: usize = 4;
/// Digits of a figure.
const DIGITS: usize = 4;
/// Of the variance: less of it that a straight line explains, and its slopes do not say what decides.
const STRAIGHT: f64 = 0.7;

/// Figures that are shown: those of the specification, then balances and means, which say most.
pub(super) fn shown<'a>(plan: &Plan, found: &'a Found) -> Vec<&'a Figure> {
    let limits = &plan.sweep.specification;
    let rank = |figure: &&Figure| {
        let place = limits.iter().position(|limit| limit.figure == figure.name);
        let plain = !["min_", "max_", "rms_"]
            .iter()
            .any(|p| figure.name.starts_with(p));
        place.unwrap_or(limits.len() + usize::from(!plain))
    };
    let mut figures: Vec<&Figure> = found.figures.iter().collect();
    figures.sort_by_key(rank);
    figures.truncate(MOST_FIGURES);
    figures
}

/// `94.3 % (92.7 to 95.6 %) of 1000`.
pub(super) fn yield_in_words(found: &Yield) -> String {
    let [low, high] = found.interval.map(|share| 100.0 * share);
    format!(
        "{:.1} % of {} runs keep the specification (with 95 % confidence {low:.1} to {high:.1} %)",
        100.0 * found.share,
        found.runs
    )
}

/// Where a sample stands: its engine and what else is varied.
pub(super) fn place(found: &Found) -> String {
    let varied = found
        .varied
        .iter()
        .map(|(key, value)| format!("{key} = {value}"));
    let words: Vec<String> = [found.engine.clone()].into_iter().chain(varied).collect();
    words.join(", ")
}

/// What decides, in words: keys with their share of the variance.
pub(super) fn decides(figure: &Figure) -> String {
    let share = |of: &pinwheel_studies::sweep::Sensitivity| {
        let straight = figure.linear.is_some_and(|linear| linear >= STRAIGHT);
        let slope = of.coefficient.filter(|_| straight).map(|c| c * c);
        slope.or(of.first_order)
    };
    let mut keys: Vec<(f64, &str)> = figure
        .sensitivities
        .iter()
        .filter_map(|of| Some((share(of)?, of.key.rsplit('.').next().unwrap_or(&of.key))))
        .filter(|(share, _)| *share >= 0.005)
        .collect();
    keys.sort_by(|a, b| b.0.total_cmp(&a.0));
    let words = keys.iter().take(MOST_KEYS);
    let words = words.map(|(share, key)| format!("{key} {:.0} %", 100.0 * share.min(1.0)));
    words.collect::<Vec<_>>().join(", ")
}

/// The middle quantile and the outer ones of a figure.
pub(super) fn between(figure: &Figure) -> [Option<&Quantile>; 3] {
    [0.05, 0.5, 0.95].map(|share| figure.quantiles.iter().find(|q| q.share == share))
}

pub(super) fn named(name: &str) -> String {
    let (label, unit) = label_and_unit(name);
    super::named(&label, &unit)
}

/// The verdict of a sweep with a specification, of its worst sample.
pub(super) fn verdict(found: &[Found]) -> Option<Verdict> {
    let yields = found.iter().filter_map(|f| Some((f, f.yielded.as_ref()?)));
    let (worst, of) = yields.min_by(|a, b| a.1.share.total_cmp(&b.1.share))?;
    let [low, high] = of.interval.map(|share| 100.0 * share);
    Some(Verdict {
        tone: Tone::of(of.kept == of.runs),
        headline: format!("Yield {:.1} %", 100.0 * of.share),
        detail: format!(
            "{} of {} runs keep the specification; with 95 % confidence {low:.1} to {high:.1} % of all gears do ({}).",
            of.kept,
            of.runs,
            place(worst)
        ),
    })
}

/// The section of a sample.
pub(super) fn section(plan: &Plan, table: &Results, all: &[Found]) -> Section {
    let mut blocks = Vec::new();
    for found in all {
        if all.len() > 1 {
            blocks.push(Block::Heading(place(found)));
        }
        if let Some(of) = &found.yielded {
            blocks.push(limits(&plan.sweep.specification, of));
        }
        blocks.extend(figures(plan, found));
    }
    if let [_] = all {
        let charts = charts(plan, table, &all[0]);
        if !charts.is_empty() {
            blocks.insert(0, Block::Charts(charts));
        }
    }
    blocks.push(Block::Text(
        "In brackets: where a quantile lies with 95 % confidence. A key's share of the variance is by \
         regression where a straight line explains 70 % of it or more, otherwise by first-order Sobol indices."
            .to_owned(),
    ));
    Section {
        id: "tolerances".to_owned(),
        title: "Tolerances".to_owned(),
        blocks,
    }
}

fn limits(limits: &[Limit], of: &Yield) -> Block {
    let words = |limit: &Limit| {
        let least = limit.least.map(|x| format!("at least {x}"));
        let most = limit.most.map(|x| format!("at most {x}"));
        least.into_iter().chain(most).collect::<Vec<_>>().join(", ")
    };
    let rows = limits.iter().zip(&of.alone).map(|(limit, share)| {
        vec![
            Cell::text(named(&limit.figure)),
            Cell::text(words(limit)),
            Cell::number(format!("{:.1}", 100.0 * share), 100.0 * share),
        ]
    });
    Block::Table(Table {
        caption: yield_in_words(of),
        columns: vec![
            Heading::text("Figure"),
            Heading::text("Limit"),
            Heading::number("Runs that keep it (%)"),
        ],
        rows: rows.collect(),
    })
}

fn figures(plan: &Plan, found: &Found) -> [Block; 2] {
    let quantile = |of: Option<&Quantile>| match of {
        None => Cell::text(""),
        Some(of) => {
            let end = |end: Option<f64>| {
                end.map_or_else(|| "open".to_owned(), |x| significant(x, DIGITS))
            };
            let [low, high] = of.interval.map(end);
            let text = format!("{} ({low} to {high})", significant(of.value, DIGITS));
            Cell::number(text, of.value)
        }
    };
    let shown = shown(plan, found);
    let rows = shown.iter().map(|figure| {
        let [low, middle, high] = between(figure);
        vec![
            Cell::text(named(&figure.name)),
            Cell::number(significant(figure.mean, DIGITS), figure.mean),
            Cell::number(significant(figure.deviation, DIGITS), figure.deviation),
            quantile(low),
            quantile(middle),
            quantile(high),
        ]
    });
    let spread = Block::Table(Table {
        caption: format!("Figures over {} runs", found.runs),
        columns: vec![
            Heading::text("Figure"),
            Heading::number("Mean"),
            Heading::number("Deviation"),
            Heading::number("5 % of runs below"),
            Heading::number("Half below"),
            Heading::number("95 % below"),
        ],
        rows: rows.collect(),
    });
    let share = |share: Option<f64>| {
        share.map_or_else(
            || Cell::text(""),
            |x| Cell::number(format!("{:.0}", 100.0 * x), 100.0 * x),
        )
    };
    let rows = shown.iter().map(|figure| {
        vec![
            Cell::text(named(&figure.name)),
            Cell::text(decides(figure)),
            share(figure.linear),
        ]
    });
    let keys = Block::Table(Table {
        caption: "What decides: shares of a figure's variance".to_owned(),
        columns: vec![
            Heading::text("Figure"),
            Heading::text("Keys"),
            Heading::number("By a straight line (%)"),
        ],
        rows: rows.collect(),
    });
    [spread, keys]
}

/// How the first figures are distributed, with their limits.
fn charts(plan: &Plan, table: &Results, found: &Found) -> Vec<Chart> {
    let figures = shown(plan, found).into_iter().take(MOST_CHARTS);
    let chart = |figure: &Figure| {
        let Some(Column::Number(values)) = table.column(&figure.name) else {
            return None;
        };
        let mut sorted: Vec<f64> = values.iter().copied().flatten().collect();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().saturating_sub(1).max(1) as f64;
        let shares = (0..sorted.len()).map(|k| 100.0 * k as f64 / last).collect();
        let series = |label: &str, x: Vec<f64>, y: Vec<f64>| Series {
            label: label.to_owned(),
            x,
            y,
            ..Series::default()
        };
        let mut all = vec![series("runs", sorted, shares)];
        let own = plan
            .sweep
            .specification
            .iter()
            .find(|l| l.figure == figure.name);
        for end in own
            .into_iter()
            .flat_map(|limit| [limit.least, limit.most])
            .flatten()
        {
            all.push(series("limit", vec![end, end], vec![0.0, 100.0]));
        }
        Some(Chart {
            title: label_and_unit(&figure.name).0,
            x: Axis::linear(named(&figure.name)),
            y: Axis::linear("Runs below (%)"),
            series: all,
            note: String::new(),
        })
    };
    figures.filter_map(chart).collect()
}
