//! The study on a terminal: largest steps, scene by scene.

use pinwheel_report::terminal::{BAD, Cell, QUIET, TITLE, lines, styled};
use pinwheel_studies::stability::Atlas;

use super::maps::shown_step;

/// The largest step of each method, scene by scene; without the place of the page.
#[must_use]
pub fn text(atlas: &Atlas) -> String {
    let head = Cell::text("scene").styled(TITLE);
    let methods = atlas
        .options
        .methods
        .iter()
        .map(|method| Cell::figure(method.name()).styled(TITLE));
    let mut rows = vec![std::iter::once(head).chain(methods).collect::<Vec<_>>()];
    for row in atlas.done() {
        let mut line = vec![Cell::text(&row.scene)];
        if let Some(reason) = &row.refused {
            line.push(Cell::text(reason).styled(BAD));
        }
        for cell in &row.cells {
            let style = match (&cell.failure, cell.largest_step_s) {
                (None, _) => anstyle::Style::new(),
                (Some(_), Some(_)) => QUIET,
                (Some(_), None) => BAD,
            };
            line.push(Cell::figure(shown_step(cell)).styled(style));
        }
        rows.push(line);
    }
    format!(
        "{}\n{}\nLargest step with the right picture; of methods with a tolerance, the forces' error.",
        styled(TITLE, "stability"),
        lines(&rows)
    )
}
