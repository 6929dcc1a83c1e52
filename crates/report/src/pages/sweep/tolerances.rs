//! Results of a sample, for the page and a terminal.

use crate::format::{joined, relative, significant};
use crate::study::{Axis, Block, Chart, Mark, Question, Section, Series, Tile, Tone, Verdict};
use crate::table::named;
use pinwheel_studies::sweep::{
    FigureOfSample, Limit, Plan, Quantile, SampleResult, Yield, definition,
};
use pinwheel_timeseries::figure::FigureDef;
use pinwheel_timeseries::table::{Shown, Table, Values};

/// Largest number of figures; summary.json has all.
const MOST_FIGURES: usize = 20;
/// Largest number of charts.
const MOST_CHARTS: usize = 6;
/// Largest number of decisive keys.
const MOST_KEYS: usize = 4;
/// Significant digits of a figure.
const DIGITS: usize = 4;
/// Least share of the variance that a linear fit must explain. Below it, the slopes do not identify decisive keys.
const STRAIGHT: f64 = 0.7;

/// Returns the figures: those of the specification, then balances and means, then the others.
pub(super) fn shown<'a>(plan: &Plan, sample: &'a SampleResult) -> Vec<&'a FigureOfSample> {
    let limits = &plan.sweep.specification;
    let rank = |figure: &&FigureOfSample| {
        let key = &figure.def.key;
        let place = limits.iter().position(|limit| limit.figure == *key);
        let other = ["min_", "max_", "rms_"].iter().any(|p| key.starts_with(p));
        place.unwrap_or(limits.len() + usize::from(other))
    };
    let mut figures: Vec<&FigureOfSample> = sample.figures.iter().collect();
    figures.sort_by_key(rank);
    figures.truncate(MOST_FIGURES);
    figures
}

/// Returns e.g. `94.3 % of 1000 runs keep the specification (with 95 % confidence 92.7 to 95.6 %)`.
pub(super) fn yield_in_words(yielded: &Yield) -> String {
    let [low, high] = yielded.interval.map(|share| 100.0 * share);
    format!(
        "{:.1} % of {} runs keep the specification (with 95 % confidence {low:.1} to {high:.1} %)",
        100.0 * yielded.share,
        yielded.runs
    )
}

/// Returns engine and other varied keys of a sample.
pub(super) fn place(sample: &SampleResult) -> String {
    let varied = sample.varied.iter();
    let varied = varied.map(|(key, value)| format!("{key} = {value}"));
    joined(", ", [sample.engine.clone()].into_iter().chain(varied))
}

/// Returns the decisive keys of a figure with their share of the variance.
pub(super) fn decides(figure: &FigureOfSample) -> String {
    let share = |of: &pinwheel_studies::sweep::Sensitivity| {
        let straight = figure.linear.is_some_and(|linear| linear >= STRAIGHT);
        let slope = of.coefficient.filter(|_| straight).map(|c| c * c);
        slope.or(of.first_order)
    };
    let last = |key| -> &str { str::rsplit(key, '.').next().unwrap_or(key) };
    let keys = figure.sensitivities.iter();
    let keys = keys.filter_map(|of| Some((share(of)?, last(&of.key))));
    let mut keys: Vec<(f64, &str)> = keys.filter(|(share, _)| *share >= 0.005).collect();
    keys.sort_by(|a, b| b.0.total_cmp(&a.0));
    let words = keys.iter().take(MOST_KEYS);
    let words = words.map(|(share, key)| format!("{key} {:.0} %", 100.0 * share.min(1.0)));
    joined(", ", words)
}

/// Least number of runs for tails beyond the outer quantiles.
const TAILS: usize = 20;

/// Returns e.g. `8.2, 90 % of runs from 7.9 to 8.4; backlash_m 86 %`. Few runs show their extremes in place of quantiles,
/// equal runs the value alone.
pub(super) fn in_words(figure: &FigureOfSample) -> String {
    let [low, middle, high] = between(figure).map(|of| of.map_or(f64::NAN, |of| of.value));
    let rounded = |value| significant(value, DIGITS);
    let [low, high] = if figure.count < TAILS {
        figure.range
    } else {
        [low, high]
    };
    let (middle, [from, to]) = (rounded(middle), [low, high].map(rounded));
    let spread = match figure.count {
        count if low == high => format!("in all {count} runs"),
        count if count < TAILS => format!("{count} runs from {from} to {to}"),
        _ => format!("90 % of runs from {from} to {to}"),
    };
    let decides = Some(decides(figure)).filter(|keys| !keys.is_empty());
    let decides = decides.map_or_else(String::new, |keys| format!("; {keys}"));
    format!("{middle}, {spread}{decides}")
}

/// Returns the median and the outer quantiles of a figure.
pub(super) fn between(figure: &FigureOfSample) -> [Option<&Quantile>; 3] {
    [0.05, 0.5, 0.95].map(|share| figure.quantiles.iter().find(|q| q.share == share))
}

pub(super) fn in_full(def: &FigureDef) -> String {
    named(&def.label, &def.unit)
}

/// Returns the verdict of a sweep with a specification, by its worst sample.
pub(super) fn verdict(all: &[SampleResult]) -> Option<Verdict> {
    let yields = all.iter().filter_map(|f| Some((f, f.yielded.as_ref()?)));
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

/// Returns the distribution of the first figure of a sample, with the decisive keys.
pub(super) fn spread(plan: &Plan, samples: &[SampleResult]) -> Option<Verdict> {
    let figure = *shown(plan, samples.first()?).first()?;
    let words = in_words(figure);
    let (headline, keys) = words.split_once("; ").unwrap_or((&words, "no single key"));
    Some(Verdict {
        tone: Tone::Neutral,
        headline: format!("{}: {headline}", in_full(&figure.def)),
        detail: format!("Decisive: {keys}; over {} runs.", figure.count),
    })
}

/// Tile of the yield of the worst sample.
pub(super) fn bears(samples: &[SampleResult]) -> Option<Tile> {
    let verdict = verdict(samples)?;
    let mark = match verdict.tone {
        Tone::Good => Mark::Good,
        _ => Mark::Warn,
    };
    Some(Question::Bears.answered(mark, verdict.headline, "gears that keep the specification"))
}

/// Tile of the confidence in the median of the first figure of a sample.
pub(super) fn sure(plan: &Plan, samples: &[SampleResult]) -> Option<Tile> {
    let figure = *shown(plan, samples.first()?).first()?;
    let median = between(figure)[1]?;
    let off = |end: Option<f64>| Some((end? / median.value - 1.0).abs());
    let [below, above] = median.interval.map(off);
    let answer = format!("to {}", relative(below?.max(above?)));
    let (label, runs) = (&figure.def.label, figure.count);
    let why = format!("median of {label} over {runs} runs, with 95 % confidence");
    Some(Question::Sure.answered(Mark::None, answer, why))
}

/// Returns the section on samples within the tolerances.
pub(super) fn section(plan: &Plan, table: &Table, all: &[SampleResult]) -> Section {
    let mut blocks = Vec::new();
    for sample in all {
        if all.len() > 1 {
            blocks.push(Block::heading(place(sample)));
        }
        if let Some(of) = &sample.yielded {
            blocks.push(limits(&plan.sweep.specification, of));
        }
        blocks.extend(figures(plan, sample));
    }
    if let [one] = all {
        let charts = charts(plan, table, one);
        blocks.splice(0..0, (!charts.is_empty()).then(|| charts.into()));
    }
    Section::new("tolerances", "Tolerances").with(blocks).with(
        "In brackets: where a quantile lies with 95 % confidence. A key's share of the variance is by regression where a \
         straight line explains 70 % of it or more, otherwise by first-order Sobol indices.",
    )
}

fn limits(limits: &[Limit], of: &Yield) -> Block {
    let words = |limit: &Limit| {
        let least = limit.least.map(|x| format!("at least {x}"));
        let most = limit.most.map(|x| format!("at most {x}"));
        joined(", ", least.into_iter().chain(most))
    };
    Table::of(yield_in_words(of), limits.iter().zip(&of.alone))
        .text("", "Figure", |(limit, _)| {
            in_full(&definition(&limit.figure))
        })
        .text("", "Limit", |(limit, _)| words(limit))
        .number("", "Runs that keep it", |(_, share)| 100.0 * **share)
        .unit("%")
        .shown(Shown::Decimals(1))
        .into()
}

fn figures(plan: &Plan, sample: &SampleResult) -> [Block; 2] {
    let quantile = |of: Option<&Quantile>| {
        let of = of?;
        let end = |end: Option<f64>| end.map_or("open".to_owned(), |x| significant(x, DIGITS));
        let ([low, high], value) = (of.interval.map(end), significant(of.value, DIGITS));
        Some(format!("{value} ({low} to {high})"))
    };
    let digits = Shown::Digits(DIGITS as u8);
    let shown = shown(plan, sample);
    let mut spread = Table::of(format!("Figures over {} runs", sample.runs), &shown)
        .text("", "Figure", |figure| in_full(&figure.def))
        .number("", "Mean", |figure| figure.mean)
        .shown(digits)
        .number("", "Deviation", |figure| figure.deviation)
        .shown(digits);
    let labels = ["5 % of runs below", "Half below", "95 % below"];
    for (k, label) in labels.into_iter().enumerate() {
        spread = spread
            .number("", label, |figure| between(figure)[k].map(|of| of.value))
            .display(|figure| quantile(between(figure)[k]));
    }
    let keys = Table::of("What decides: shares of a figure's variance", &shown)
        .text("", "Figure", |figure| in_full(&figure.def))
        .text("", "Keys", |figure| decides(figure))
        .number("", "By a straight line", |figure| {
            figure.linear.map(|x| 100.0 * x)
        })
        .unit("%")
        .shown(Shown::Decimals(0));
    [spread.into(), keys.into()]
}

/// Returns distributions of the first figures, with their limits.
fn charts(plan: &Plan, table: &Table, sample: &SampleResult) -> Vec<Chart> {
    let figures = shown(plan, sample).into_iter().take(MOST_CHARTS);
    let chart = |figure: &FigureOfSample| {
        let Values::Number(values) = &table.column(&figure.def.key)?.values else {
            return None;
        };
        let mut sorted: Vec<f64> = values.iter().copied().flatten().collect();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().saturating_sub(1).max(1) as f64;
        let shares = (0..sorted.len()).map(|k| 100.0 * k as f64 / last);
        let shares: Vec<f64> = shares.collect();
        let mut all = vec![Series::line("runs", sorted, shares)];
        let mut limits = plan.sweep.specification.iter();
        let own = limits
            .find(|limit| limit.figure == figure.def.key)
            .into_iter();
        let ends = own.flat_map(|limit| [limit.least, limit.most]).flatten();
        all.extend(ends.map(|end| Series::line("limit", [end, end], [0.0, 100.0])));
        let x = Axis::linear(in_full(&figure.def));
        let title = &*figure.def.label;
        Some(Chart::new(title, x, Axis::linear("Runs below (%)"), all))
    };
    figures.filter_map(chart).collect()
}
