//! The study of the paper on a terminal.

use pinwheel_report::terminal::{BAD, Cell, GOOD, TITLE, lines, styled};
use pinwheel_studies::paper::Paper;

use super::words;

/// The verdicts, without the place of the page.
#[must_use]
pub fn text(found: &Paper) -> String {
    let marked = |verdict, word: &str| {
        let cell = Cell::text(word);
        match words::good(verdict) {
            Some(true) => cell.styled(GOOD),
            Some(false) => cell.styled(BAD),
            None => cell,
        }
    };
    let figures = found.figures.iter().map(|figure| {
        let verdict = marked(figure.verdict, words::figure(figure.verdict));
        vec![Cell::text(&figure.name), verdict, Cell::text(&figure.title)]
    });
    let claims = found.claims.iter().map(|judged| {
        let verdict = marked(judged.verdict, words::claim(judged.verdict));
        vec![
            Cell::text("claim"),
            verdict,
            Cell::text(&judged.claim.claim),
        ]
    });
    let rows: Vec<Vec<Cell>> = figures.chain(claims).collect();
    format!(
        "{}\n{}\n{} runs in {:.0} s",
        styled(TITLE, "the paper, computed again"),
        lines(&rows),
        found.runs,
        found.wall_s
    )
}
