//! Text of the study of the paper for a terminal.

use crate::terminal::{table, titled};
use pinwheel_studies::paper::PaperResult;
use pinwheel_timeseries::table::Table;

use super::mark;

/// Returns the verdicts, without the path of the page.
pub fn text(found: &PaperResult) -> String {
    let figures = found.figures.iter();
    let figures = figures.map(|figure| (figure.name.as_str(), figure.verdict, &figure.title));
    let claims = found.claims.iter();
    let claims = claims.map(|judged| ("claim", judged.verdict, &judged.claim.claim));
    let list = Table::of("", figures.chain(claims))
        .text("", "Figure", |row| row.0)
        .text("", "By our runs", |row| row.1.words())
        .marked(|row| mark(row.1))
        .text("", "What", |row| row.2);
    let cost = format!("\n{} runs in {:.0} s", found.runs, found.wall_s);
    titled("the paper, computed again", [table(&list.done()), cost])
}
