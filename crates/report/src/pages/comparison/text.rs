//! Text of `pinwheel compare` on stdout: figures of every engine, verdicts of every pair.

use crate::figure::tile;
use crate::format::{self, significant};
use crate::study::{Fact, Tone};
use crate::terminal::{self, BAD, GOOD, OPEN, QUIET, TITLE, paragraph, styled};
use pinwheel_compare::comparison::{EngineSummary, Pair, PairEntry};
use pinwheel_compare::metrics::PairMetrics;
use pinwheel_compare::quantities::{self, INPUT_TORQUE};
use pinwheel_compare::{Comparison, Counts, SharedModel, Verdict};
use pinwheel_scene::Scene;
use pinwheel_studies::comparison::Outcome;
use pinwheel_timeseries::columns::{EXTERNAL_FORCE, INTERNAL_FORCE};
use pinwheel_timeseries::table::{Mark, Shown, Table};

use super::answer::{self, Answer};
use super::common::mark;
use super::figures::{figures, window};
use super::words;
use crate::pages::band;

/// Returns the answer on at most one screen, without the path of the page. Notes on measured data are shortened until it
/// fits, then the reasons of excluded engines. [`details`] has every note and reason.
pub fn text(scene: &Scene, outcome: &Outcome) -> String {
    let answer = Answer::new(outcome, share);
    let trust = answer.trust();
    let notes = trust.iter().filter(|fact| is_note(fact)).count();
    let fewer = (0..answer::MOST).rev().map(|reasons| (0, reasons));
    let room = (0..=notes).rev().map(|kept| (kept, answer::MOST));
    let rooms = room.chain(fewer);
    let mut texts = rooms.map(|room| with_notes(scene, &answer, &trust, room));
    let shortest = texts.next_back().unwrap_or_default();
    // The path of the page takes one more line.
    texts
        .find(|text| text.lines().count() < SCREEN)
        .unwrap_or(shortest)
}

/// True for a note on measured data.
fn is_note(fact: &Fact) -> bool {
    fact.label == answer::DATA
}

/// Returns the answer, limited to these numbers of notes on measured data and of reasons of excluded engines.
fn with_notes(
    scene: &Scene,
    answer: &Answer<'_>,
    trust: &[Fact],
    (kept, reasons): (usize, usize),
) -> String {
    let title = paragraph(&crate::pages::title(scene));
    let mut text = format!("{}\n\n", styled(TITLE, &title));
    text += &format!("{}\n", terminal::facts(&answer.shown()));
    text += &terminal::pairs(figures(answer.outcome).iter().map(tile).map(|one| {
        let value = format!("{} {}", one.value, one.unit);
        // Shortened to fit on one line.
        let bounds = one.detail.replace("by contact law", "by law");
        let value = match one.value.as_str() {
            format::NONE => one.value,
            _ => format!("{value:12}"),
        };
        (one.label, format!("{value} {bounds}"))
    }));
    let facts = |title: &str, facts: &[Fact]| match facts {
        [] => String::new(),
        facts => format!("\n{}\n{}", styled(TITLE, title), terminal::facts(facts)),
    };
    let (notes, mut checks): (Vec<Fact>, Vec<Fact>) = trust.iter().cloned().partition(is_note);
    let more = notes.len() - kept;
    checks.extend(notes.into_iter().take(kept));
    if more > 0 {
        let more =
            format!("{more} more on what was done to it: `--verbose`, or Measured on the page");
        checks.push(Fact::new(answer::DATA, Mark::None, more));
    }
    text += &facts("can I trust it", &checks);
    let mut unchecked = answer.unchecked(reasons);
    // The last line counts these.
    unchecked.retain(|fact| fact.label != answer::UNRESOLVED);
    text += &facts("not checked", &unchecked);
    text += &terminal::facts(&answer.next());
    text += &total(answer);
    match text.lines().count() < SCREEN {
        true => text,
        false => text.replace("\n\n", "\n"),
    }
}

/// Number of lines of a screen.
const SCREEN: usize = 30;

/// Returns the text with every figure and every verdict.
pub fn details(outcome: &Outcome) -> String {
    let comparison = &outcome.comparison;
    let mut text = format!("\n{}", terminal::table(&engines(comparison)));
    text += &terminal::facts(&answer::left_out_facts(&answer::left_out(comparison)));
    let tables = [measured(comparison), pairs(comparison)].into_iter();
    let tables = tables.filter(|table| !table.is_empty());
    let bands = outcome
        .bands
        .iter()
        .map(|bands| terminal::pairs(band::rows(bands)));
    for part in tables.map(|table| terminal::table(&table)).chain(bands) {
        text += &format!("\n{part}");
    }
    let remarks = words::of_windows(comparison).chain(budgets(comparison));
    let remarks = remarks.chain(words::of_measured(comparison));
    let twins = outcome.twins.iter().filter_map(super::twins::line);
    text + &terminal::paragraphs(remarks.chain(twins))
}

/// Returns the verdict in a sentence.
pub fn verdict(outcome: &Outcome) -> String {
    let (_, word, why) = Answer::new(outcome, share).judged();
    format!("{word}: {why}")
}

/// Formats a share for a terminal.
fn share(value: f64) -> String {
    match value.abs() >= 1e-3 {
        true => format!("{}\u{202f}%", significant(100.0 * value, 2)),
        false => brief_number(value),
    }
}

/// Returns the last lines, a summary of all verdicts.
fn total(answer: &Answer<'_>) -> String {
    let (tone, word, _) = answer.judged();
    let style = match tone {
        Tone::Good => GOOD,
        Tone::Bad => BAD,
        Tone::Open => OPEN,
        Tone::Neutral => QUIET,
    };
    let (word, counts) = (word.to_uppercase(), words::counts(answer.comparison()));
    styled(style, &paragraph(&format!("{word}  {counts}")))
}

/// Text on an engine or a pair in a row, and its mark.
type Said = (String, Mark);

fn engines(comparison: &Comparison) -> Table {
    let window = window(comparison);
    let statistics = |engine: &EngineSummary, quantity: &str| {
        let figures = engine.figures_in(window?)?;
        figures.quantities.get(quantity).copied()
    };
    let peak = |engine: &EngineSummary, quantity| Some(statistics(engine, quantity)?.peak);
    Table::of("", &comparison.engines)
        .text("", "engine", |engine| &engine.name)
        .number("", "torque N m", |engine| {
            Some(statistics(engine, INPUT_TORQUE)?.mean)
        })
        .shown(Shown::Decimals(4))
        .number("", "ext N", |engine| peak(engine, EXTERNAL_FORCE))
        .shown(Shown::Decimals(1))
        .number("", "int N", |engine| peak(engine, INTERNAL_FORCE))
        .shown(Shown::Decimals(1))
        .number("", "wall s", |engine| {
            Some(engine.cost.wall_s).filter(|wall| *wall > 0.0)
        })
        .shown(Shown::Decimals(2))
        .display(|engine| {
            let kept = engine.cost.kept.as_ref().map(|_| "kept");
            let word = engine.cost.recorded.as_ref().map(|_| "recorded").or(kept);
            word.map(str::to_owned)
        })
        .text("", "load", |engine| own_verdict(engine).0)
        .marked(|engine| own_verdict(engine).1)
        .done()
}

/// Returns the verdict on a single engine: its balance with the load, or without figures the reason in a word, explained
/// below the table.
fn own_verdict(engine: &EngineSummary) -> Said {
    if engine.status.reason().is_some() {
        return match engine.status.is_broken() {
            true => (engine.status.word().to_owned(), Mark::Bad),
            false => ("left out".to_owned(), Mark::Muted),
        };
    }
    let verdicts = engine.judged.iter().map(|entry| &entry.result);
    let mut compared = verdicts.filter(|one| one.verdict != Verdict::NotCompared);
    let last = compared.next_back();
    last.map_or_else(Said::default, |one| {
        (one.verdict.word().to_owned(), mark(one))
    })
}

/// Returns the distances of measured data from each engine, by quantity.
fn measured(comparison: &Comparison) -> Table {
    let pairs = comparison.pairs.iter();
    let entries = words::entries(pairs.filter(|p| p.track == SharedModel::Measured));
    let rows = entries.filter_map(|(pair, entry)| Some((pair, entry, entry.metrics.as_ref()?)));
    const SHARES: [(&str, fn(&PairMetrics) -> Option<f64>); 3] = [
        ("L2", |metrics| metrics.relative_l2),
        ("mean", |metrics| metrics.mean_difference),
        ("peak", |metrics| metrics.peak_difference),
    ];
    let mut table = Table::of("", rows)
        .text("", "measured", |(pair, ..)| name(pair))
        .text("", "quantity", |(_, entry, _)| place(entry));
    for (label, of) in SHARES {
        table = table
            .number("", label, |(.., metrics)| of(metrics))
            .unit("%")
            .shown(Shown::Percent);
    }
    let verdict = |entry: &PairEntry| words::verdict(&entry.result, brief_number);
    table
        .text("", "verdict", |(_, entry, _)| verdict(entry))
        .done()
}

/// Number of pairs listed one by one. Pairs that differ come before those with a possible action.
const LISTED: usize = 5;

/// Returns a table of pairs: shared parts, counts of verdicts, and the gravest one; then pairs with a possible action.
fn pairs(comparison: &Comparison) -> Table {
    let mut rows: Vec<(String, Option<Counts>, Said)> = Vec::new();
    for (track, shares) in [
        (SharedModel::Native, "equations"),
        (SharedModel::SharedLaw, "contact law"),
        (SharedModel::OwnContact, "nothing"),
        (SharedModel::Measured, "measured data"),
    ] {
        let of_track = || comparison.pairs.iter().filter(|pair| pair.track == track);
        if of_track().next().is_none() {
            continue;
        }
        let mut counts = Counts::default();
        words::entries(of_track()).for_each(|(_, entry)| counts.add(&entry.result));
        let known = of_track().filter_map(|pair| Some((pair, words::gravest(pair)?)));
        // Unresolvable verdicts rank below agreements.
        let rank = |entry: &PairEntry| match entry.result.rank() {
            2 => 0,
            rank => rank,
        };
        let worst = known.max_by(|a, b| {
            let graver = rank(a.1).cmp(&rank(b.1));
            graver.then(a.1.result.share().total_cmp(&b.1.result.share()))
        });
        let verdict = worst.map_or_else(Said::default, |(pair, entry)| {
            let verdict = words::verdict(&entry.result, brief_number);
            (format!("{}: {verdict}", name(pair)), mark(&entry.result))
        });
        rows.push((shares.to_owned(), Some(counts), verdict));
    }
    let known = comparison.pairs.iter();
    let known = known.filter_map(|pair| Some((pair, words::gravest(pair)?)));
    let mut open: Vec<(&Pair, &PairEntry)> = known.filter(|(_, e)| e.result.actionable).collect();
    open.sort_by_key(|(_, entry)| std::cmp::Reverse(entry.result.rank()));
    for (pair, entry) in open.into_iter().take(LISTED) {
        let verdict = words::verdict(&entry.result, brief_number);
        let verdict = format!("{verdict}; {}", place(entry));
        rows.push((name(pair), None, (verdict, mark(&entry.result))));
    }
    Table::of("", &rows)
        .text("", "pairs that share", |(shares, ..)| shares)
        .integers("", "agree", |(_, counts, _)| Some((*counts)?.agree))
        .integers("", "differ", |(_, counts, _)| Some((*counts)?.differ))
        .integers("", "inconcl.", |(_, counts, _)| {
            Some((*counts)?.inconclusive)
        })
        .text("", "at worst", |(.., (verdict, _))| verdict)
        .marked(|(.., (_, mark))| *mark)
        .done()
}

/// Returns a quantity and a window.
fn place(entry: &PairEntry) -> String {
    let (label, _) = quantities::label_and_unit(&entry.quantity);
    format!("{}, {}", label.to_lowercase(), entry.window.word())
}

fn name(pair: &Pair) -> String {
    format!("{} / {}", words::short(&pair.a), words::short(&pair.b))
}

fn brief_number(value: f64) -> String {
    format!("{value:.0e}")
}

/// Length of a bar, characters.
const BAR: usize = 20;

/// Returns the shares of numerics, inputs and data in the uncertainty of a comparison with measured data, as bars.
fn budgets(comparison: &Comparison) -> Vec<String> {
    let budget = |(pair, entry): (&Pair, &PairEntry)| {
        let deciding = entry.assessments.iter().find(|one| one.decides)?;
        let budget = deciding.budget?;
        let shares = budget.shares()?;
        let signs = |share: f64| (share * BAR as f64).round() as usize;
        let parts = shares.iter().zip(["n", "i", "d"]);
        let bar: String = parts
            .map(|(share, sign)| sign.repeat(signs(*share)))
            .collect();
        let [numerical, input, data] = shares.map(|share| 100.0 * share);
        Some(format!(
            "{}, {}: u_val = {:.1e} [{bar:BAR$}] numerics {numerical:.0} %, inputs {input:.0} %, data {data:.0} %",
            name(pair),
            place(entry),
            budget.validation()
        ))
    };
    words::entries(&comparison.pairs)
        .filter_map(budget)
        .collect()
}
