//! `stability.csv`: one line a scene and method.

use super::{Survey, judged};
use crate::stability::{Cell, Failure as Fails, Row};

const HEAD: [&str; 15] = [
    "scene",
    "formulation",
    "integrator",
    "tolerance",
    "error_forces",
    "error_driver_torque",
    "failure",
    "largest_step_s",
    "never_failed",
    "fails_first",
    "fails_first_how",
    "energy_remainder_share",
    "joint_drift_m",
    "evaluations",
    "refused",
];

/// Writes the table as CSV.
pub(super) fn write(survey: &Survey, sink: impl std::io::Write) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(sink);
    writer.write_record(HEAD)?;
    for row in survey.rows.iter().flatten() {
        if row.cells.is_empty() {
            let mut record = vec![String::new(); HEAD.len()];
            record[0].clone_from(&row.scene);
            record[HEAD.len() - 1] = row.refused.clone().unwrap_or_default();
            writer.write_record(record)?;
        }
        for cell in &row.cells {
            writer.write_record(line(row, cell))?;
        }
    }
    writer.flush().map_err(csv::Error::from)
}

fn line(row: &Row, cell: &Cell) -> Vec<String> {
    let figure = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:e}"));
    let method = &cell.method;
    let form = judged::name(method);
    let form = form.split(' ').next().unwrap_or_default();
    let first = cell.fails_first.as_ref();
    vec![
        row.scene.clone(),
        form.to_owned(),
        method.integrator.clone(),
        figure(method.tolerance),
        figure(cell.error.map(|e| e.forces)),
        figure(cell.error.map(|e| e.driver_torque)),
        cell.failure.as_ref().map_or("", Fails::word).to_owned(),
        figure(cell.largest_step_s),
        cell.never_failed.to_string(),
        first.map_or("", Fails::word).to_owned(),
        first.map(Fails::sentence).unwrap_or_default(),
        figure(cell.energy_remainder_share),
        format!("{:e}", cell.joint_drift_m),
        cell.evaluations.to_string(),
        String::new(),
    ]
}
