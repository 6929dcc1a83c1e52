//! What `pinwheel calibrate` says on stdout.

use pinwheel_report::terminal::{BAD, Cell, GOOD, TITLE, lines, styled};
use pinwheel_studies::calibration::{COVERAGE, Outcome, Row, SHARPNESS, power};

/// Coverage and sharpness, a row an engine.
#[must_use]
pub fn text(found: &Outcome) -> String {
    let mut text = format!("{} gears\n", found.gears);
    for (figures, title) in [(false, "time series"), (true, "their means, peaks and RMS")] {
        let heading = |text: &str| Cell::figure(text).styled(TITLE);
        let mut rows = vec![vec![
            Cell::text(title).styled(TITLE),
            heading("stated"),
            heading("covered"),
            heading("u / error, median"),
            heading("error / u, largest"),
            heading(if figures { "" } else { "not resolved" }),
            heading(if figures { "" } else { "no truth" }),
        ]];
        rows.extend(found.rows(figures).iter().map(|row| {
            let count = |of: &std::collections::BTreeMap<String, usize>| {
                if figures {
                    String::new()
                } else if row.engine == "all" {
                    of.values().sum::<usize>().to_string()
                } else {
                    of.get(&row.engine).copied().unwrap_or(0).to_string()
                }
            };
            let mut cells = cells(row);
            cells.push(Cell::figure(count(&found.not_resolved)));
            cells.push(Cell::figure(count(&found.without_truth)));
            cells
        }));
        text.push_str(&lines(&rows));
        text.push('\n');
    }
    for left in &found.left_out {
        text.push_str(&format!("left out: {left}\n"));
    }
    let verdict = if found.is_honest() {
        styled(GOOD, "uncertainties are honest")
    } else {
        styled(BAD, "UNCERTAINTIES ARE NOT HONEST")
    };
    format!(
        "{text}{verdict}: at least {:.0} % of the errors are to be within what was stated, and that below {SHARPNESS} times \
         the error in the median",
        100.0 * COVERAGE
    )
}

fn cells(row: &Row) -> Vec<Cell> {
    vec![
        Cell::text(&row.engine),
        Cell::figure(row.cases.to_string()),
        Cell::figure(format!("{:.1} %", 100.0 * row.coverage())),
        Cell::figure(format!("{:.1}", row.sharpness)),
        Cell::figure(format!("{:.2}", row.worst)),
    ]
}

/// The smallest faults told, a row a gear, engine and kind.
#[must_use]
pub fn power(found: &power::Outcome) -> String {
    let title = |text: &str| Cell::text(text).styled(TITLE);
    let heading = |text: &str| Cell::figure(text).styled(TITLE);
    let mut rows = vec![vec![
        title("gear"),
        title("engine"),
        title("fault"),
        title("told"),
        heading("D / U"),
        heading("smallest detected"),
    ]];
    for one in &found.found {
        let told = if one.told {
            Cell::text("differ").styled(GOOD)
        } else {
            Cell::text("NOT TOLD").styled(BAD)
        };
        rows.push(vec![
            Cell::text(&one.scene),
            Cell::text(&one.engine),
            Cell::text(one.kind.label()),
            told,
            Cell::figure(format!("{:.1}", one.uncertainties)),
            Cell::figure(
                one.smallest
                    .map_or_else(|| "-".to_owned(), |size| one.kind.size(size)),
            ),
        ]);
    }
    let mut text = lines(&rows);
    for alarm in &found.false_alarms {
        text.push_str(&format!("\n{}: {alarm}", styled(BAD, "FALSE ALARM")));
    }
    for left in &found.left_out {
        text.push_str(&format!("\nleft out: {left}"));
    }
    text
}
