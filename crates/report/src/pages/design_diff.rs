//! Comparison of two designs: page and text.

use crate::figure::{cell, number};
use crate::format::{self, NONE, joined, significant};
use crate::study::{Block, Decision, Question, Section, Study, Tile, Tone, Verdict};
use crate::table::named;
use crate::terminal::{self, TITLE, paragraph, styled};
use pinwheel_scene::keys::key;
use pinwheel_studies::Provenance;
use pinwheel_studies::design_diff::{DesignDiff, KeyDiff};
use pinwheel_studies::stages::{Located, Stage};
use pinwheel_timeseries::figure::{Diff, Judged};
use pinwheel_timeseries::table::{Mark, Table, TableOf};
use serde_json::Value;

use crate::pages::comparison::stages::blocks as stages;
use crate::pages::design::{self, is_headline};
use crate::pages::{animation, time_series};

/// Largest number of unfolded keys.
const MANY: usize = 12;

/// Figures of the time series for the short list.
const SERIES: [&str; 3] = [
    "input_torque_n_m mean",
    "external_sleeve_force_n peak",
    "internal_sleeve_force_n peak",
];

/// Returns the page.
pub fn page(diff: &DesignDiff, origin: &Provenance) -> String {
    let [a, b] = &diff.names;
    let mut sections = vec![scene(diff), figures(diff)];
    sections.extend(diff.stages.iter().map(|located| {
        let about = format!("The model of `{b}` at the states of `{a}`.");
        Section::new("stages", "Stages")
            .with(about)
            .with(stages(located))
    }));
    sections.extend(over_time(diff));
    sections.push(curves(diff));
    sections.extend(motion(diff));
    let study = Study {
        title: format!("{a} and {b}"),
        eyebrow: "Pinwheel, two designs side by side".to_owned(),
        lead: format!(
            "What changed from `{a}` to `{b}`, in the scene, in every figure of a design and over time. Statics and runs as `pinwheel design`; \
             time series by {}, each refined until its uncertainty is known.",
            diff.engine
        ),
        verdict: Some(verdict(diff)),
        decision: decision(diff, origin),
        tiles: tiles(diff),
        sections,
        ..Study::default()
    };
    crate::pages::render(study, origin)
}

/// Returns the text for a terminal.
pub fn text(diff: &DesignDiff) -> String {
    let [a, b] = &diff.names;
    let mut text = styled(TITLE, &format!("{a} and {b}")) + "\n";
    let stated = || diff.changed.iter().filter(|change| !change.follows);
    if stated().next().is_some() {
        text.push_str(&terminal::table(&keys(diff, "", stated()).done()));
    }
    let followed = diff.changed.len() - stated().count();
    if followed > 0 {
        let keys = format::counted(followed, "key that follows", "keys that follow");
        text.push_str(&format!("and {keys} from them\n"));
    }
    let off = diff.stages.as_ref().map_or_else(String::new, Located::off);
    if !off.is_empty() {
        text.push_str(&format!("{}\n", paragraph(&format!("stage {off}"))));
    }
    let derived = diff.derived.iter().filter(|r| r.judged != Judged::Same);
    let means = steady(diff).filter(|row| SERIES.contains(&&*row.def.key));
    let all = derived.chain(&diff.figures).chain(means);
    let figures = both(diff, "", all)
        .display(|row| match row.judged {
            Judged::BelowUncertainty => "not shown".to_owned(),
            _ => change(row),
        })
        .marked(|row| match row.judged {
            Judged::Differ => Mark::None,
            _ => Mark::Muted,
        });
    let mut all = diff.figures.iter();
    let below = all.any(|row| row.judged == Judged::BelowUncertainty);
    let note = "not shown: the difference is below the uncertainty of both together (after \u{b1})";
    let note = paragraph(if below { note } else { "" });
    let (figures, headline) = (figures.done(), verdict(diff).headline);
    text = format!("{text}\n{}{note}\n", terminal::table(&figures));
    text + &paragraph(&headline)
}

/// Returns means and peaks of the first window.
fn steady(diff: &DesignDiff) -> impl Iterator<Item = &Diff> {
    let first = diff.time_series.first();
    first.into_iter().flat_map(|(_, rows)| rows)
}

fn verdict(diff: &DesignDiff) -> Verdict {
    let all = || diff.figures.iter().chain(steady(diff));
    let count = |judged: Judged| all().filter(|row| row.judged == judged).count();
    let (same, below) = (count(Judged::Same), count(Judged::BelowUncertainty));
    let (differ, total) = (count(Judged::Differ), all().count());
    let unknown = total - same - below - differ;
    // `torsional stiffness × 43.5`
    let most = most(diff).into_iter();
    let most = most.map(|row| format!("{} {}", row.def.label, change(row)));
    let headline = match (differ, joined("; ", most).as_str()) {
        _ if diff.identical() => {
            "The designs are identical: every key has the same value".to_owned()
        }
        (0, _) => format!(
            "No difference was shown: none of {total} figures differs by more than its uncertainty"
        ),
        (_, "") => format!("{differ} of {total} figures differ by more than their uncertainty"),
        (_, most) => format!("{differ} of {total} figures differ, most: {most}"),
    };
    let [one, many] = ["key of the scene differs", "keys of the scene differ"];
    let mut detail = format::counted(diff.changed.len(), one, many);
    let counts = [
        (same, "the same"),
        (below, "with a difference below the uncertainty"),
        (unknown, "with an unknown difference"),
    ];
    for (count, what) in counts.into_iter().filter(|(count, _)| *count > 0) {
        let figures = format::counted(count, "figure", "figures");
        detail.push_str(&format!(", {figures} {what}"));
    }
    if let Some((name, reason)) = diff.broken() {
        detail.push_str(&format!(". {name}: {reason}"));
    }
    Verdict {
        tone: diff.broken().map_or(Tone::Neutral, |_| Tone::Bad),
        headline,
        detail: format!("{detail}."),
    }
}

/// Returns the headline figures that differ, largest change first.
fn most(diff: &DesignDiff) -> Vec<&Diff> {
    const MOST: usize = 3;
    let differs = |row: &&Diff| row.judged == Judged::Differ && row.change().is_some();
    let rows = diff.figures.iter().filter(|row| is_headline(&row.def));
    let mut rows: Vec<&Diff> = rows.filter(differs).collect();
    // Size of the factor in either direction.
    let size = |share: f64| (1.0 + share).abs().ln().abs();
    let factor = |row: &Diff| row.change().map_or(0.0, size);
    rows.sort_by(|a, b| factor(b).total_cmp(&factor(a)));
    rows.truncate(MOST);
    rows
}

/// Returns a value of a scene file as text, with more than six digits only where both values need them.
fn value(change: &KeyDiff, of: usize) -> String {
    let short = |value: &Option<Value>| match value {
        None => NONE.to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Number(number)) => number.as_f64().map_or(number.to_string(), format::plain),
        Some(other) => other.to_string(),
    };
    let both = change.values.each_ref().map(short);
    match &change.values[of] {
        Some(value) if both[0] == both[1] => value.to_string(),
        _ => both[of].clone(),
    }
}

fn change(row: &Diff) -> String {
    match row.change() {
        _ if row.judged == Judged::Same => "0".to_owned(),
        Some(share) if share >= 9.0 => format!("\u{d7} {}", significant(1.0 + share, 3)),
        Some(share) if share.abs() >= 1e-4 => {
            let sign = if share > 0.0 { "+" } else { "" };
            format!("{sign}{}\u{202f}%", significant(100.0 * share, 3))
        }
        Some(share) => significant(share, 1),
        None => NONE.to_owned(),
    }
}

/// Returns unit and factor for both values of a row: the readable unit of the larger value.
fn scaled(row: &Diff) -> (String, f64) {
    let sizes = row.values.iter().flatten().map(|v| v.abs());
    format::readable_unit(&row.def.unit, sizes.fold(0.0, f64::max))
}

fn shown(row: &Diff, k: usize) -> String {
    let (unit, factor) = scaled(row);
    cell(&row.figure(k).scaled(factor, unit))
}

fn tiles(diff: &DesignDiff) -> Vec<Tile> {
    let wanted = diff.figures.iter().filter(|row| is_headline(&row.def));
    let tile = |row: &Diff| {
        let shown = |value: Option<f64>| value.map_or(NONE.to_owned(), number);
        let [a, b] = row.values.map(shown);
        let judged = match row.judged {
            Judged::Same => "the same".to_owned(),
            Judged::Differ => change(row),
            Judged::BelowUncertainty => "no difference shown".to_owned(),
            _ => format!("{}: {}", change(row), judged(row).0),
        };
        Tile::new(&*row.def.label, format!("{a} \u{2192} {b}"), judged).unit(&*row.def.unit)
    };
    wanted.map(tile).collect()
}

fn decision(diff: &DesignDiff, origin: &Provenance) -> Decision {
    let why = format!("both by {}; no other program", diff.engine);
    let right = Question::Right.answered(Mark::Warn, "not compared", why);
    let bears = design::both_bear(diff.designs.each_ref().map(|one| &one.limits));
    let heads = diff.figures.iter().filter(|row| is_headline(&row.def));
    let all = heads.clone().count();
    let shown = heads.filter(|row| row.judged == Judged::Differ).count();
    let why =
        "larger than the numerical uncertainty; contact law and fits act on both and are left out";
    let sure = Question::Sure.answered(Mark::None, format!("{shown} of {all} changes shown"), why);
    let why = format!("whether other engines confirm {}", diff.names[1]);
    let next = crate::pages::next(origin, "compare", &why);
    [Some(right), Some(bears), Some(sure), Some(next)]
}

/// Returns a verdict as text, and its mark.
fn judged(row: &Diff) -> (&'static str, Mark) {
    match row.judged {
        Judged::Same => ("the same", Mark::Muted),
        Judged::BelowUncertainty => ("below the uncertainty: no difference shown", Mark::Muted),
        Judged::Differ => ("", Mark::None),
        Judged::NotKnown => ("uncertainty not known", Mark::Warn),
        Judged::Missing => ("not in both", Mark::Warn),
    }
}

/// Returns a table of figures of both designs and their change.
fn both<'a>(
    diff: &DesignDiff,
    caption: &str,
    rows: impl Iterator<Item = &'a Diff>,
) -> TableOf<&'a Diff> {
    let label = |row: &Diff| named(&row.def.label, &scaled(row).0);
    let mut table = Table::of(caption, rows).text("", "Figure", |row| label(row));
    for (k, name) in diff.names.iter().enumerate() {
        table = table
            .number("", name, |row| row.values[k])
            .display(|row| shown(row, k));
    }
    table
        .number("", "Change", |row| row.change())
        .display(|row| change(row))
}

/// Returns a table of figures of both designs, their change and its verdict.
fn table<'a>(diff: &DesignDiff, caption: &str, rows: impl Iterator<Item = &'a Diff>) -> Block {
    let table = both(diff, caption, rows)
        .text("", "Judged", |row| judged(row).0)
        .marked(|row| judged(row).1);
    table.into()
}

/// Returns a table of keys with the values of both scenes.
fn keys<'a>(
    diff: &DesignDiff,
    caption: &str,
    changes: impl Iterator<Item = &'a KeyDiff>,
) -> TableOf<&'a KeyDiff> {
    let [a, b] = &diff.names;
    Table::of(caption, changes)
        .text("", "Key", |change| format!("`{}`", change.key))
        .text("", a, |change| value(change, 0))
        .text("", b, |change| value(change, 1))
        .text("", "Stage", |change| change.stage.map_or("", Stage::name))
}

fn scene(diff: &DesignDiff) -> Section {
    let keys = |caption: &str, follows: bool| {
        let of = diff.changed.iter().filter(|c| c.follows == follows);
        let table = keys(diff, caption, of)
            .text("", "What it is", |change| {
                key(&change.key).map_or("", |key| key.about)
            })
            .done();
        (!table.is_empty()).then_some(Block::Table(table))
    };
    let stated = keys("Keys that differ", false);
    let many = diff.changed.iter().filter(|c| !c.follows).count();
    let mut blocks: Vec<Block> = match stated {
        Some(table) if many > MANY => vec![Block::folded(format!("{many} keys differ"), table)],
        other => other.into_iter().collect(),
    };
    if diff.identical() {
        let same = "Every key of both scenes has the same value, but for name and description.";
        blocks.push(same.into());
    }
    let derived = diff.derived.iter();
    let mut differing = derived.filter(|row| row.judged != Judged::Same).peekable();
    if differing.peek().is_some() {
        let caption = "What follows from the dimensions and the load";
        blocks.push(table(diff, caption, differing));
    }
    let followed = keys("Keys that both scenes leave to a formula", true);
    let title = "Keys that differ because others do";
    blocks.extend(followed.map(|followed| Block::folded(title, followed)));
    Section::new("scene", "What changed").with(blocks)
}

fn figures(diff: &DesignDiff) -> Section {
    Section::new("figures", "Figures")
        .with(
            "After \u{b1} how far a figure may be off: by the poses that were looked at, or by the run's own verification. A difference below \
             both together was not shown.",
        )
        .with(table(diff, "Figures of both designs", diff.figures.iter()))
}

fn over_time(diff: &DesignDiff) -> Option<Section> {
    let time_series = time_series::block(&diff.comparison, &diff.participants, true)?;
    let windows = diff.time_series.iter();
    let mut tables = windows.map(|(window, rows)| {
        let caption = format!("Means and peaks, {} window", window.word());
        table(diff, &caption, rows.iter())
    });
    let first = Vec::from_iter(tables.next());
    let rest: Vec<Block> = tables.collect();
    let section = Section::new("courses", "Over time")
        .with(time_series)
        .with(first);
    Some(match rest.is_empty() {
        true => section,
        false => section.with(Block::folded("Other windows", rest)),
    })
}

fn curves(diff: &DesignDiff) -> Section {
    let designs = [0, 1].map(|k| (diff.names[k].as_str(), &diff.designs[k]));
    let mut charts = vec![design::torsion_chart(&designs)];
    charts.extend(design::transmission_charts(&designs));
    charts.extend(design::sharing_charts(&designs));
    charts.push(design::bearing_chart(&designs));
    Section::new("curves", "Side by side").with(charts)
}

/// Returns the section with both designs in motion over their common time.
fn motion(diff: &DesignDiff) -> Option<Section> {
    let motion = animation::beside(&diff.motion)?;
    Some(Section::new("motion", "Motion").with(motion))
}
