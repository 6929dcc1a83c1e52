//! One run on a terminal.

use pinwheel_compare::statistics::{Statistics, View};
use pinwheel_courses::columns;
use pinwheel_gearbox::Efficiency;
use pinwheel_report::terminal::{Cell, TITLE, lines, styled};
use pinwheel_studies::single::Outcome;

/// Five significant digits, and no negative zero.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    if rounded.abs() < 1e-9 {
        "0".to_owned()
    } else {
        rounded.to_string()
    }
}

/// What one runs it for: torque, forces and efficiency after the start-up, as far as the run goes beyond it.
fn results(found: &Outcome) -> Vec<(&'static str, String)> {
    let courses = &found.run.courses;
    let account = found.run.stats.energy.last();
    let from = account.map_or(0.5 * found.scene.solver.duration_s, |audit| audit.from_s);
    let window = courses.window(from, f64::INFINITY);
    let of = |group: &str| {
        let channels = courses.group(group);
        let channels = if channels.is_empty() {
            courses.channel(group).into_iter().collect()
        } else {
            channels
        };
        let inside = |values: &'_ [f64]| values.get(window.clone()).map(<[f64]>::to_vec);
        let inside: Option<Vec<Vec<f64>>> = channels.into_iter().map(inside).collect();
        let inside = inside?;
        Statistics::of(&View::new(inside.iter().map(Vec::as_slice).collect()))
    };
    // Relative uncertainty of the forces and of the torque, where the run knows it.
    let error = found.run.uncertainty.as_ref().and_then(|u| u.error);
    let give = |value: f64, share: Option<f64>| match share {
        Some(share) => format!(" \u{b1} {:.1e}", value.abs() * share),
        None => String::new(),
    };
    let mut rows = Vec::new();
    if let Some(torque) = of(columns::INPUT_TORQUE) {
        let share = error.map(|e| e.driver_torque);
        rows.push((
            "driver torque",
            format!(
                "mean {}{} N m, {} to {}, from {:.4} s on",
                digits(torque.mean),
                give(torque.rms, share),
                digits(torque.min),
                digits(torque.max),
                from
            ),
        ));
    }
    for (label, group) in [
        ("external forces", columns::EXTERNAL_FORCE),
        ("internal forces", columns::INTERNAL_FORCE),
    ] {
        if let Some(force) = of(group) {
            let share = error.map(|e| e.forces);
            rows.push((
                label,
                format!(
                    "peak {}{} N, mean {} N",
                    digits(force.peak),
                    give(force.peak, share),
                    digits(force.mean)
                ),
            ));
        }
    }
    if let Some(efficiency) = account.and_then(Efficiency::of) {
        rows.push((
            "efficiency",
            format!(
                "{:.2}{} % by what contacts lose; {:.2} % by the works, {:+.2} % of them created by the law",
                100.0 * efficiency.of_losses,
                give(100.0 * efficiency.of_losses, error.map(|e| e.driver_torque)),
                100.0 * efficiency.measured,
                100.0 * efficiency.created_share
            ),
        ));
    }
    rows
}

/// Results, settings and cost of a run that finished; `courses`: where its samples are.
#[must_use]
pub fn text(found: &Outcome, courses: &str) -> String {
    let stats = &found.run.stats;
    let row = |label: &str, value: String| vec![Cell::text(label), Cell::text(value)];
    // What one runs it for comes first.
    let mut rows: Vec<Vec<Cell>> = results(found)
        .into_iter()
        .map(|(label, value)| row(label, value))
        .collect();
    rows.extend([
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
    ]);
    if let Some(resolution) = &found.resolution {
        rows.push(row("resolution", resolution.sentence()));
    }
    rows.extend(stats.notes.iter().map(|note| row("note", note.clone())));
    rows.push(row("courses", courses.to_owned()));
    format!("{}\n{}", styled(TITLE, &found.scene.name), lines(&rows))
}
