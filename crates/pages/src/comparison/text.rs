//! What `pinwheel compare` says on stdout: figures of every engine, verdicts of every pair.

use pinwheel_compare::comparison::EngineSummary;
use pinwheel_compare::quantities::INPUT_TORQUE;
use pinwheel_compare::{Comparison, Outcome, Track, Verdict, WindowKind};
use pinwheel_report::statement;
use pinwheel_report::terminal::{BAD, Cell, GOOD, QUIET, TITLE, lines, paragraph, styled};
use pinwheel_scene::Scene;

/// The whole text, without the place of the page.
#[must_use]
pub fn text(scene: &Scene, comparison: &Comparison) -> String {
    let mut text = format!("{}\n\n", styled(TITLE, &paragraph(&crate::title(scene))));
    text.push_str(&lines(&engines(comparison)));
    if let Some(window) = shown_window(comparison) {
        text.push_str(&styled(
            QUIET,
            &paragraph(&format!(
                "Mean driver torque and largest external and internal sleeve force in the {} window; load: the output \
                 torque's balance with it.",
                window.word()
            )),
        ));
        text.push('\n');
    }
    for engine in &comparison.engines {
        if let Some(reason) = engine.status.reason() {
            text.push_str(&paragraph(&format!("{}: {reason}", engine.name)));
            text.push('\n');
        }
    }
    let measured = measured(comparison);
    if measured.len() > 1 {
        text.push('\n');
        text.push_str(&lines(&measured));
        let rigs = comparison
            .engines
            .iter()
            .filter(|e| e.track == Track::Measured);
        for (name, note) in rigs.flat_map(|e| e.cost.notes.iter().map(|note| (&e.name, note))) {
            text.push_str(&format!("{}\n", paragraph(&format!("{name}: {note}"))));
        }
    }
    let judged = pairs(comparison);
    if judged.len() > 1 {
        text.push('\n');
        text.push_str(&lines(&judged));
    }
    for remark in comparison.windows.iter().filter_map(|w| w.remark()) {
        text.push_str(&format!("\n{}", paragraph(&remark)));
    }
    for absent in &comparison.absent_windows {
        text.push_str(&format!(
            "\n{}",
            paragraph(&format!(
                "No {} window: {}.",
                absent.kind.word(),
                absent.reason
            ))
        ));
    }
    let unresolved = statement::unresolved(comparison).into_iter();
    let unresolved = unresolved.map(|found| format!("not resolved: {}: {}", found.who, found.why));
    for line in sharpened(comparison)
        .into_iter()
        .chain(budgets(comparison))
        .chain(unresolved)
    {
        text.push_str(&format!("\n{}", paragraph(&line)));
    }
    format!("{text}\n{}", total(comparison))
}

/// The last line: what all verdicts amount to.
fn total(comparison: &Comparison) -> String {
    let counts = comparison.counts;
    let mut parts = Vec::new();
    let mut say = |n: usize, words: &str| {
        if n > 0 {
            parts.push(format!("{n} {words}"));
        }
    };
    say(counts.differ, "differ");
    say(counts.exceeded, "exceed a limit");
    say(counts.model_beyond, "beyond a model's tolerance");
    say(counts.not_resolved, "not resolved");
    say(counts.agree, "agree");
    say(counts.within, "within limits");
    say(counts.model - counts.model_beyond, "of models");
    say(counts.stated, "not resolved for a stated reason");
    let parts = parts.join(", ");
    let (style, verdict) = match comparison.outcome {
        Outcome::Finding if counts.differ + counts.model_beyond == 0 => {
            (BAD, format!("LIMIT EXCEEDED: {parts}"))
        }
        Outcome::Finding => (BAD, format!("ENGINES DIFFER: {parts}")),
        Outcome::NotResolved => (BAD, format!("NOT RESOLVED: {parts}")),
        Outcome::Passed => (GOOD, format!("every statement holds: {parts}")),
        Outcome::Stated => (QUIET, parts),
        Outcome::Nothing => {
            let nothing = "nothing judged: no limit and no uncertainty applies";
            (QUIET, nothing.to_owned())
        }
    };
    let quiet = match counts.not_judged {
        0 => String::new(),
        n => format!(" ({n} not judged, see the page)"),
    };
    styled(style, &paragraph(&format!("{verdict}{quiet}")))
}

/// The window figures are shown for: the steady one, or the whole run.
fn shown_window(comparison: &Comparison) -> Option<WindowKind> {
    [WindowKind::Steady, WindowKind::Whole, WindowKind::Transient]
        .into_iter()
        .find(|kind| comparison.windows.iter().any(|window| window.kind == *kind))
}

fn engines(comparison: &Comparison) -> Vec<Vec<Cell>> {
    let window = shown_window(comparison);
    let title = |text: &str| Cell::text(text).styled(TITLE);
    let heading = |text: &str| Cell::figure(text).styled(TITLE);
    let mut rows = vec![vec![
        title("engine"),
        heading("torque N m"),
        heading("ext N"),
        heading("int N"),
        heading("wall s"),
        title("load"),
    ]];
    for engine in &comparison.engines {
        let mut row = vec![Cell::text(&engine.name)];
        let figures = engine
            .figures
            .iter()
            .find(|figures| Some(figures.window) == window);
        let figure = |quantity: &str, peak: bool| {
            let value = figures
                .and_then(|figures| figures.quantities.get(quantity))
                .map(|statistics| {
                    if peak {
                        statistics.peak
                    } else {
                        statistics.mean
                    }
                });
            Cell::figure(value.map_or_else(
                || "-".to_owned(),
                |value| format!("{value:.*}", if peak { 1 } else { 4 }),
            ))
        };
        row.push(figure(INPUT_TORQUE, false));
        row.push(figure("external_sleeve_force_n", true));
        row.push(figure("internal_sleeve_force_n", true));
        if engine.cost.recorded.is_some() {
            row.push(Cell::figure("recorded"));
        } else if engine.cost.wall_s > 0.0 {
            row.push(Cell::figure(format!("{:.2}", engine.cost.wall_s)));
        } else {
            row.push(Cell::figure("-"));
        }
        match engine.status.reason() {
            Some(_) => row.push(not_finished(engine)),
            None => row.push(own_verdict(
                engine.judged.iter().map(|entry| &entry.verdict),
            )),
        }
        rows.push(row);
    }
    rows
}

/// Why an engine has no figures, in a word; the reason stands below the table.
fn not_finished(engine: &EngineSummary) -> Cell {
    match engine.status.is_broken() {
        true => Cell::text(engine.status.word()).styled(BAD),
        false => Cell::text("left out").styled(QUIET),
    }
}

/// Of what was judged of an engine alone, the worst.
fn own_verdict<'a>(verdicts: impl Iterator<Item = &'a Verdict>) -> Cell {
    let mut word = Cell::text("");
    for verdict in verdicts {
        match verdict.outcome() {
            Outcome::Finding => return Cell::text("exceeded").styled(BAD),
            Outcome::Passed => word = Cell::text("within").styled(GOOD),
            Outcome::NotResolved | Outcome::Stated | Outcome::Nothing => {}
        }
    }
    word
}

/// How far measured data are from each engine, quantity by quantity.
fn measured(comparison: &Comparison) -> Vec<Vec<Cell>> {
    let title = |text: &str| Cell::text(text).styled(TITLE);
    let heading = |text: &str| Cell::figure(text).styled(TITLE);
    let mut rows = vec![vec![
        title("measured"),
        title("quantity"),
        heading("L2"),
        heading("mean"),
        heading("peak"),
        title("verdict"),
    ]];
    let percent = |value: Option<f64>| {
        Cell::figure(value.map_or_else(|| "-".to_owned(), |v| format!("{:.2} %", 100.0 * v)))
    };
    let pairs = comparison
        .pairs
        .iter()
        .filter(|p| p.track == Track::Measured);
    for pair in pairs {
        for entry in &pair.entries {
            let Some(metrics) = &entry.metrics else {
                continue;
            };
            rows.push(vec![
                Cell::text(format!(
                    "{} / {}",
                    statement::short(&pair.a),
                    statement::short(&pair.b)
                )),
                Cell::text(format!(
                    "{}, {}",
                    brief(&entry.quantity),
                    entry.window.word()
                )),
                percent(metrics.relative_l2),
                percent(metrics.mean_difference),
                percent(metrics.peak_difference),
                Cell::text(statement::entry(entry, |value| format!("{value:.0e}"))),
            ]);
        }
    }
    rows
}

/// One row for each pair: the gravest statement on it, and where it was made.
fn pairs(comparison: &Comparison) -> Vec<Vec<Cell>> {
    let title = |text: &str| Cell::text(text).styled(TITLE);
    let mut rows = vec![vec![title("pair"), title("at worst"), title("of")]];
    for pair in &comparison.pairs {
        let worst = statement::gravest(pair);
        // What engines and recordings cannot say is told once, below.
        let Some(worst) = worst.filter(|w| w.verdict.outcome() != Outcome::Stated) else {
            continue;
        };
        let style = match worst.verdict.outcome() {
            Outcome::Finding | Outcome::NotResolved => BAD,
            Outcome::Passed => GOOD,
            Outcome::Stated | Outcome::Nothing => QUIET,
        };
        rows.push(vec![
            Cell::text(format!(
                "{} / {}",
                statement::short(&pair.a),
                statement::short(&pair.b)
            )),
            Cell::text(statement::entry(worst, |value| format!("{value:.0e}"))).styled(style),
            Cell::text(format!(
                "{}, {}",
                brief(&worst.quantity),
                worst.window.word()
            )),
        ]);
    }
    rows
}

/// `external_sleeve_force_n` as `external sleeve force`.
fn brief(quantity: &str) -> String {
    let units = ["_n_m", "_n", "_rad_s", "_rad"];
    let bare = units.iter().find_map(|unit| quantity.strip_suffix(unit));
    bare.unwrap_or(quantity)
        .replace("external_sleeve", "ext")
        .replace("internal_sleeve", "int")
        .replace('_', " ")
}

/// What taking off the leading error term makes of pairs whose orders were confirmed: the sharpest and the bluntest.
fn sharpened(comparison: &Comparison) -> Option<String> {
    let mut sharper: Vec<(f64, f64)> = Vec::new();
    for entry in comparison.pairs.iter().flat_map(|pair| &pair.entries) {
        let plain = entry.judgements.iter().find(|j| j.counts);
        let both = entry.extrapolated.as_ref().zip(plain);
        let bounds = both.and_then(|(new, old)| Some((new.combined()?, old.combined()?)));
        sharper.extend(bounds.filter(|(new, old)| new < old));
    }
    let all = sharper.len();
    if all == 0 {
        return None;
    }
    sharper.sort_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
    let (new, old) = sharper[all / 2];
    Some(format!(
        "extrapolated (Richardson): {all} statements are sharper, in the median U = {new:.0e} instead of {old:.0e}"
    ))
}

/// Signs of a bar.
const BAR: usize = 20;

/// The shares of numerics, inputs and data in the uncertainty of a comparison with measured data, as bars.
fn budgets(comparison: &Comparison) -> Vec<String> {
    let mut told = Vec::new();
    for pair in &comparison.pairs {
        for entry in &pair.entries {
            let counting = entry.judgements.iter().find(|j| j.counts);
            let Some((budget, shares)) = counting
                .and_then(|j| j.budget)
                .and_then(|budget| Some((budget, budget.shares()?)))
            else {
                continue;
            };
            let signs = |share: f64| (share * BAR as f64).round() as usize;
            let bar: String = shares
                .iter()
                .zip(['n', 'i', 'd'])
                .map(|(share, sign)| sign.to_string().repeat(signs(*share)))
                .collect();
            let [numerical, input, data] = shares.map(|share| 100.0 * share);
            told.push(format!(
                "{} / {}, {}, {}: u_val = {:.1e} [{bar:BAR$}] numerics {numerical:.0} %, inputs {input:.0} %, data {data:.0} %",
                statement::short(&pair.a),
                statement::short(&pair.b),
                brief(&entry.quantity),
                entry.window.word(),
                budget.validation()
            ));
        }
    }
    told
}
