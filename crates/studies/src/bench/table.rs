//! The points as one flat table: a line a setting, errors of all windows side by side.

use std::io::Write;

use super::{Knob, WorkPrecision};
use crate::StudyError;

/// Writes CSV with a header row, `.` decimals and full precision; what does not exist is empty.
///
/// # Errors
/// The sink's.
pub fn write_csv(study: &WorkPrecision, sink: impl Write) -> Result<(), StudyError> {
    let mut csv = csv::Writer::from_writer(sink);
    let mut header: Vec<String> = [
        "engine",
        "version",
        "track",
        "method",
        "order",
        "step_s",
        "tolerance",
        "status",
        "cpu_min_s",
        "cpu_median_s",
        "runs",
        "rhs_calls",
        "steps",
        "rejected_steps",
    ]
    .map(str::to_owned)
    .into();
    for window in &study.windows {
        for what in ["force_l2", "force_max", "torque_l2", "torque_max"] {
            header.push(format!("{}_{what}", window.name));
        }
    }
    let columns = header.len();
    csv.write_record(&header)?;
    for series in &study.series {
        for point in &series.points {
            let setting = point.setting.to_string();
            let (step, tolerance) = match series.knob {
                Knob::StepS => (setting, String::new()),
                Knob::Tolerance => (String::new(), setting),
            };
            let mut row = vec![
                series.engine.clone(),
                series.version.clone(),
                series.track.as_str().to_owned(),
                series.method.clone(),
                series
                    .order
                    .map(|order| order.to_string())
                    .unwrap_or_default(),
                step,
                tolerance,
                point.ending.word().to_owned(),
            ];
            if let Some(cost) = point.cost {
                row.extend([
                    cost.cpu_min_s.to_string(),
                    cost.cpu_median_s.to_string(),
                    cost.runs.to_string(),
                    cost.rhs_calls.map(|n| n.to_string()).unwrap_or_default(),
                    cost.steps.to_string(),
                    cost.rejected_steps.to_string(),
                ]);
            } else {
                row.extend(std::iter::repeat_n(String::new(), 6));
            }
            for errors in &point.errors {
                for value in [
                    errors.force_l2,
                    errors.force_max,
                    errors.torque_l2,
                    errors.torque_max,
                ] {
                    row.push(value.to_string());
                }
            }
            row.resize(columns, String::new());
            csv.write_record(&row)?;
        }
    }
    csv.flush().map_err(csv::Error::from)?;
    Ok(())
}
