//! One run on a terminal.

use pinwheel_report::terminal::{Cell, TITLE, lines, styled};
use pinwheel_studies::single::Outcome;

/// Settings, samples and cost of a run that finished; `courses`: where its samples are.
#[must_use]
pub fn text(found: &Outcome, courses: &str) -> String {
    let stats = &found.run.stats;
    let row = |label: &str, value: String| vec![Cell::text(label), Cell::text(value)];
    let mut rows = vec![
        row(
            "engine",
            format!(
                "{} {} ({})",
                found.engine,
                found.version,
                found.track.as_str()
            ),
        ),
        row("settings", stats.settings.clone()),
        row(
            "samples",
            format!(
                "{}, to {} s",
                found.run.courses.len(),
                found.scene.solver.duration_s
            ),
        ),
        row(
            "time",
            format!("{:.3} s wall, {:.3} s CPU", stats.wall_s, stats.cpu_s),
        ),
        row(
            "steps",
            format!("{}, {} contact evaluations", stats.steps, stats.rhs_calls),
        ),
        row(
            "freedom",
            format!("{} velocities integrated", stats.degrees_of_freedom),
        ),
    ];
    if let Some(resolution) = &found.resolution {
        rows.push(row("resolution", resolution.sentence()));
    }
    rows.extend(stats.notes.iter().map(|note| row("note", note.clone())));
    rows.push(row("courses", courses.to_owned()));
    format!("{}\n{}", styled(TITLE, &found.scene.name), lines(&rows))
}
