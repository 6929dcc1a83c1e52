//! What `pinwheel compare` says on stdout: figures of every engine, verdicts of every pair.

use pinwheel_compare::quantities::INPUT_TORQUE;
use pinwheel_compare::{Check, Comparison, Outcome, Verdict, WindowKind};
use pinwheel_report::terminal::{BAD, Cell, GOOD, QUIET, TITLE, lines, styled};
use pinwheel_scene::Scene;

/// The whole text, without the place of the page.
#[must_use]
pub fn text(scene: &Scene, comparison: &Comparison) -> String {
    let mut text = format!("{}\n\n", styled(TITLE, &crate::title(scene)));
    text.push_str(&lines(&engines(comparison)));
    let judged = pairs(comparison);
    if judged.len() > 1 {
        text.push('\n');
        text.push_str(&lines(&judged));
    }
    for remark in comparison.windows.iter().filter_map(|w| w.remark()) {
        text.push_str(&format!("\n{remark}"));
    }
    for absent in &comparison.absent_windows {
        text.push_str(&format!(
            "\nNo {} window: {}.",
            absent.kind.word(),
            absent.reason
        ));
    }
    let counts = comparison.counts;
    let verdict = match (counts.within, counts.exceeded) {
        (0, 0) => styled(QUIET, "nothing judged: no limit applies"),
        (within, 0) => styled(GOOD, &format!("within limits: {within} of {within}")),
        (within, exceeded) => styled(
            BAD,
            &format!("LIMIT EXCEEDED: {exceeded} of {}", within + exceeded),
        ),
    };
    let quiet = match counts.not_judged {
        0 => String::new(),
        n => styled(QUIET, &format!(" ({n} not judged, reasons in the report)")),
    };
    format!("{text}\n{verdict}{quiet}")
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
        title("track"),
        heading("driver torque, mean"),
        heading("ext peak"),
        heading("int peak"),
        heading("wall"),
        title(&window.map_or_else(String::new, |kind| format!("({} window)", kind.word()))),
    ]];
    for engine in &comparison.engines {
        let mut row = vec![Cell::text(&engine.name), Cell::text(&engine.track)];
        let figures = engine
            .figures
            .iter()
            .find(|figures| Some(figures.window) == window);
        let figure = |quantity: &str, unit: &str, peak: bool| {
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
                |value| format!("{value:.*} {unit}", if peak { 1 } else { 4 }),
            ))
        };
        row.push(figure(INPUT_TORQUE, "N m", false));
        row.push(figure("external_sleeve_force_n", "N", true));
        row.push(figure("internal_sleeve_force_n", "N", true));
        if engine.cost.recorded.is_some() {
            row.push(Cell::figure("recorded"));
        } else if engine.cost.wall_s > 0.0 {
            row.push(Cell::figure(format!("{:.2} s", engine.cost.wall_s)));
        } else {
            row.push(Cell::figure("-"));
        }
        match engine.status.reason() {
            Some(reason) => row.push(Cell::text(reason).styled(BAD)),
            None => row.push(own_verdict(
                engine.judged.iter().map(|entry| &entry.verdict),
            )),
        }
        rows.push(row);
    }
    rows
}

/// Of what was judged of an engine alone, the worst.
fn own_verdict<'a>(verdicts: impl Iterator<Item = &'a Verdict>) -> Cell {
    let mut word = Cell::text("");
    for verdict in verdicts {
        match verdict.outcome() {
            Outcome::Finding => return Cell::text("load balance exceeded").styled(BAD),
            Outcome::Passed => word = Cell::text("load balance within").styled(GOOD),
            Outcome::NotResolved | Outcome::Nothing => {}
        }
    }
    word
}

/// One row for each pair and window in which something was judged, with the check nearest to its limit.
fn pairs(comparison: &Comparison) -> Vec<Vec<Cell>> {
    let title = |text: &str| Cell::text(text).styled(TITLE);
    let heading = |text: &str| Cell::figure(text).styled(TITLE);
    let mut rows = vec![vec![
        title("pair"),
        title("window"),
        title("nearest to its limit"),
        heading("value"),
        heading("limit"),
        title("verdict"),
    ]];
    for pair in &comparison.pairs {
        for window in &comparison.windows {
            let mut counts = pinwheel_compare::Counts::default();
            let mut nearest: Option<(&str, &Check)> = None;
            for entry in pair
                .entries
                .iter()
                .filter(|entry| entry.window == window.kind)
            {
                counts.add(&entry.verdict);
                for check in &entry.checks {
                    if nearest.is_none_or(|(_, least)| share(check) > share(least)) {
                        nearest = Some((&entry.quantity, check));
                    }
                }
            }
            let Some((quantity, check)) = nearest else {
                continue;
            };
            let verdict = if counts.exceeded > 0 {
                Cell::text(format!("{} exceeded", counts.exceeded)).styled(BAD)
            } else {
                Cell::text(format!("{} within", counts.within)).styled(GOOD)
            };
            rows.push(vec![
                Cell::text(format!("{} / {}", pair.a, pair.b)),
                Cell::text(window.kind.word()),
                Cell::text(format!("{quantity}, {}", metric(check))),
                Cell::figure(
                    check
                        .value
                        .map_or_else(|| "nan".to_owned(), |v| format!("{v:.1e}")),
                ),
                Cell::figure(format!("{:.1e}", check.limit)),
                verdict,
            ]);
        }
    }
    rows
}

/// The metric's name as `summary.json` writes it.
fn metric(check: &Check) -> String {
    serde_json::to_value(check.metric)
        .ok()
        .and_then(|value| value.as_str().map(str::to_owned))
        .unwrap_or_default()
}

/// Value over limit; what is not a number is beyond every limit.
fn share(check: &Check) -> f64 {
    check
        .value
        .map_or(f64::INFINITY, |value| value / check.limit)
}
