//! Points as one flat table: a row for each setting, with the errors of all windows side by side.

use pinwheel_engines::AccuracySetting;
use pinwheel_timeseries::Ending;
use pinwheel_timeseries::table::{Mark, Shown, Table};

use super::{Cost, Errors, Point, Series, WorkPrecision};

/// Errors of a window: ending of the column's name, and label for people; empty to hide it.
const ERRORS: [(&str, &str, fn(&Errors) -> f64); 4] = [
    ("force_l2", "forces L2", |errors| errors.force_l2),
    ("force_max", "forces L\u{221e}", |errors| errors.force_max),
    ("torque_l2", "", |errors| errors.torque_l2),
    ("torque_max", "", |errors| errors.torque_max),
];

impl WorkPrecision {
    /// Returns a row for each setting of each series, in order.
    pub fn table(&self) -> Table {
        let each = self.series.iter();
        let rows = each.flat_map(|series| series.points.iter().map(move |point| (series, point)));
        let setting =
            |row: &(&Series, &Point), knob| Some(row.1.setting).filter(|_| row.0.knob == knob);
        let cost = |row: &(&Series, &Point), of: fn(Cost) -> f64| row.1.cost.map(of);
        let mut table = Table::of("Every step and tolerance of every series", rows)
            .text("engine", "", |(series, _)| &series.engine)
            .text("version", "", |(series, _)| &series.version)
            .text("track", "", |(series, _)| series.track.as_str())
            .text("method", "", |(series, _)| &series.method)
            .integers("order", "", |(series, _)| series.order)
            .number("step_s", "Step", |row| setting(row, AccuracySetting::Step))
            .unit("s")
            .shown(Shown::Setting)
            .number("tolerance", "Tolerance", |row| {
                setting(row, AccuracySetting::Tolerance)
            })
            .shown(Shown::Setting)
            .text("status", "", |(_, point)| point.ending.word())
            .number("cpu_min_s", "CPU, minimum", |row| {
                cost(row, |c| c.cpu_min_s)
            })
            .shown(Shown::Seconds)
            .number("cpu_median_s", "CPU, median", |row| {
                cost(row, |c| c.cpu_median_s)
            })
            .shown(Shown::Seconds)
            .integers("runs", "Runs", |(_, point)| Some(point.cost?.runs))
            .integers("rhs_calls", "RHS calls", |(_, point)| point.cost?.rhs_calls)
            .integers("steps", "Steps", |(_, point)| Some(point.cost?.steps))
            .integers("rejected_steps", "", |(_, point)| {
                Some(point.cost?.rejected_steps)
            });
        for (k, window) in self.windows.iter().enumerate() {
            for (end, label, of) in ERRORS {
                let (name, window) = (format!("{}_{end}", window.name), &window.name);
                let label = match label {
                    "" => String::new(),
                    label => format!("{window}: {label}"),
                };
                let error = |row: &(&Series, &Point)| row.1.errors.get(k).map(of);
                table = table.number(&name, &label, error).shown(Shown::Relative);
            }
        }
        table
            .text("", "Ended", |(_, point)| point.ending.to_string())
            .marked(|(_, point)| match point.ending {
                Ending::Finished => Mark::Muted,
                Ending::TimedOut { .. } => Mark::Warn,
                _ => Mark::Bad,
            })
            .done()
    }
}
