//! Text of the study for a terminal: successes of each method. The page has the map of scenes.

use crate::format::{joined, significant};
use crate::terminal::{self, paragraphs, titled};
use pinwheel_studies::stability::Atlas;
use pinwheel_timeseries::table::{Mark, Table};

/// Number of scenes in which each method gives the right picture, its smallest step or largest error; without the place of the page.
pub fn text(atlas: &Atlas) -> String {
    let scenes: Vec<_> = atlas.done().filter(|row| row.refused.is_none()).collect();
    let cells = |place: usize| {
        let cells = scenes.iter();
        cells.filter_map(move |row| Some((row.scene.as_str(), row.cells.get(place)?)))
    };
    let methods = atlas.options.methods.iter().enumerate();
    let table = Table::of("", methods)
        .text("", "method", |(_, method)| method.name())
        .text("", "right", |(k, _)| {
            let count = cells(*k).filter(|(_, cell)| cell.is_right()).count();
            format!("{count} of {}", scenes.len())
        })
        .text("", "smallest step, \u{b5}s", |(k, _)| {
            let step = cells(*k).filter_map(|(scene, cell)| Some((scene, cell.largest_step_s?)));
            let step = step.min_by(|a, b| a.1.total_cmp(&b.1));
            step.map_or_else(String::new, |(scene, step)| {
                format!("{}, {scene}", significant(1e6 * step, 3))
            })
        })
        .text("", "largest error, %", |(k, _)| {
            let error = cells(*k).filter_map(|(scene, cell)| Some((scene, cell.right_to()?)));
            let error = error.max_by(|a, b| a.1.total_cmp(&b.1));
            error.map_or_else(String::new, |(scene, error)| {
                format!("{}, {scene}", significant(100.0 * error, 2))
            })
        })
        .text("", "fails in", |(k, _)| {
            let wrong = cells(*k).filter(|(_, cell)| !cell.is_right());
            joined(", ", wrong.map(|(scene, _)| scene))
        })
        .marked(|_| Mark::Bad);
    let refused = atlas
        .done()
        .filter_map(|row| Some((&row.scene, row.refused.as_ref()?)));
    let refused = refused.map(|(scene, why)| format!("{scene}: {why}"));
    let findings = paragraphs(atlas.findings().map(|(line, _)| line));
    let table = terminal::table(&table.done().without_empty());
    let map = "The map of scenes and methods is on the page.".to_owned();
    titled("stability", [findings, table, paragraphs(refused), map])
}
