//! What `pinwheel compare` says on stdout: figures of every engine, verdicts of every pair.

use pinwheel_compare::comparison::{EngineSummary, Pair, PairEntry};
use pinwheel_compare::quantities::INPUT_TORQUE;
use pinwheel_compare::{Comparison, Counts, Track, Verdict, WindowKind};
use pinwheel_report::terminal::{BAD, Cell, GOOD, QUIET, TITLE, lines, paragraph, styled};
use pinwheel_report::words;
use pinwheel_scene::Scene;

/// The whole text, without the place of the page.
#[must_use]
pub fn text(scene: &Scene, comparison: &Comparison) -> String {
    let mut text = format!("{}\n\n", styled(TITLE, &paragraph(&crate::title(scene))));
    text.push_str(&lines(&engines(comparison)));
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
    let pairs = pairs(comparison);
    if pairs.len() > 1 {
        text.push('\n');
        text.push_str(&lines(&pairs));
    }
    for remark in comparison.windows.iter().filter_map(|w| w.remark()) {
        text.push_str(&format!("{}\n", paragraph(&remark)));
    }
    for absent in &comparison.absent_windows {
        let words = format!("No {} window: {}.", absent.kind.word(), absent.reason);
        text.push_str(&format!("{}\n", paragraph(&words)));
    }
    let inconclusive = words::inconclusive(comparison).into_iter();
    let inconclusive = inconclusive.map(|(who, why)| format!("inconclusive: {who}: {why}"));
    for line in budgets(comparison).into_iter().chain(inconclusive) {
        text.push_str(&format!("{}\n", paragraph(&line)));
    }
    format!("{text}\n{}", total(comparison))
}

/// The last line: what all verdicts amount to.
fn total(comparison: &Comparison) -> String {
    let words::Summary { headline, counts } = words::summary(comparison);
    let style = match (comparison.counts.exit_status(), comparison.passed) {
        (0, true) => GOOD,
        (0, false) => QUIET,
        _ => BAD,
    };
    styled(style, &paragraph(&format!("{headline}  {counts}")))
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
            None => row.push(own_verdict(engine)),
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

/// The verdict on an engine alone, its balance with the load.
fn own_verdict(engine: &EngineSummary) -> Cell {
    let verdicts = engine.judged.iter().map(|entry| entry.result.verdict);
    let mut compared = verdicts.filter(|verdict| *verdict != Verdict::NotCompared);
    compared
        .next_back()
        .map_or(Cell::text(""), |verdict| marked(verdict.word(), verdict))
}

/// Text in the style of a verdict.
fn marked(text: &str, verdict: Verdict) -> Cell {
    Cell::text(text).styled(match verdict {
        Verdict::Agree => GOOD,
        Verdict::Differ => BAD,
        Verdict::Inconclusive | Verdict::NotCompared => QUIET,
    })
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
                    words::short(&pair.a),
                    words::short(&pair.b)
                )),
                Cell::text(format!(
                    "{}, {}",
                    brief(&entry.quantity),
                    entry.window.word()
                )),
                percent(metrics.relative_l2),
                percent(metrics.mean_difference),
                percent(metrics.peak_difference),
                Cell::text(words::verdict(&entry.result, brief_number)),
            ]);
        }
    }
    rows
}

/// Pairs that are listed one by one, those that differ before those with something to act on.
const LISTED: usize = 5;

/// What pairs share, how often their verdicts are which, and the gravest one; then pairs with something to act on.
fn pairs(comparison: &Comparison) -> Vec<Vec<Cell>> {
    let title = |text: &str| Cell::text(text).styled(TITLE);
    let heading = |text: &str| Cell::figure(text).styled(TITLE);
    let mut rows = vec![vec![
        title("pairs that share"),
        heading("agree"),
        heading("differ"),
        heading("inconcl."),
        title("at worst"),
    ]];
    for (track, shares) in [
        (Track::Native, "equations"),
        (Track::SharedLaw, "contact law"),
        (Track::OwnContact, "nothing"),
        (Track::Measured, "measured data"),
    ] {
        let of_track = || comparison.pairs.iter().filter(|pair| pair.track == track);
        let mut counts = Counts::default();
        let entries = of_track().flat_map(|pair| &pair.entries);
        entries.for_each(|entry| counts.add(&entry.result));
        if of_track().next().is_none() {
            continue;
        }
        let known = of_track().filter_map(|pair| Some((pair, words::gravest(pair)?)));
        // What no setting would settle says less than what agrees.
        let rank = |entry: &PairEntry| match entry.result.rank() {
            2 => 0,
            rank => rank,
        };
        let worst = known.max_by(|a, b| {
            let graver = rank(a.1).cmp(&rank(b.1));
            graver.then(a.1.result.share().total_cmp(&b.1.result.share()))
        });
        let said = worst.map_or(Cell::text(""), |(pair, entry)| {
            let said = words::verdict(&entry.result, brief_number);
            marked(&format!("{}: {said}", name(pair)), entry.result.verdict)
        });
        rows.push(vec![
            Cell::text(shares),
            Cell::figure(counts.agree.to_string()),
            Cell::figure(counts.differ.to_string()),
            Cell::figure(counts.inconclusive.to_string()),
            said,
        ]);
    }
    let acted_on = |pair: &&Pair| words::gravest(pair).is_some_and(|e| e.result.actionable);
    let mut open: Vec<&Pair> = comparison.pairs.iter().filter(acted_on).collect();
    open.sort_by_key(|pair| std::cmp::Reverse(words::gravest(pair).map(|e| e.result.rank())));
    for pair in open.iter().take(LISTED) {
        if let Some(entry) = words::gravest(pair) {
            let place = format!("{}, {}", brief(&entry.quantity), entry.window.word());
            let said = words::verdict(&entry.result, brief_number);
            let empty = || Cell::figure("");
            rows.push(vec![
                Cell::text(name(pair)),
                empty(),
                empty(),
                empty(),
                marked(&format!("{said}; {place}"), entry.result.verdict),
            ]);
        }
    }
    rows
}

fn name(pair: &Pair) -> String {
    format!("{} / {}", words::short(&pair.a), words::short(&pair.b))
}

fn brief_number(value: f64) -> String {
    format!("{value:.0e}")
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

/// Signs of a bar.
const BAR: usize = 20;

/// The shares of numerics, inputs and data in the uncertainty of a comparison with measured data, as bars.
fn budgets(comparison: &Comparison) -> Vec<String> {
    let mut told = Vec::new();
    for pair in &comparison.pairs {
        for entry in &pair.entries {
            let budget = entry.assessments.iter().find(|one| one.decides);
            let budget = budget.and_then(|one| one.budget);
            let Some((budget, shares)) = budget.and_then(|of| Some((of, of.shares()?))) else {
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
                words::short(&pair.a),
                words::short(&pair.b),
                brief(&entry.quantity),
                entry.window.word(),
                budget.validation()
            ));
        }
    }
    told
}
