//! Which methods serve a scene.

use super::Survey;
use crate::stability::{Cell, Method, Row};

/// Forces within this share of the converged run: the scene is served.
pub const SERVED: f64 = 0.01;

/// A method that gives the right picture, and its error of the forces (0 where nothing carries force).
#[must_use]
pub fn error(cell: &Cell) -> Option<f64> {
    if cell.failure.is_some() {
        return None;
    }
    Some(cell.error.map_or(0.0, |error| error.forces))
}

/// The method with the smallest error, by its place.
#[must_use]
pub fn best(row: &Row) -> Option<(&Cell, f64)> {
    let right = row.cells.iter().filter_map(|c| error(c).map(|e| (c, e)));
    right.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Names of the scenes that no method gives within [`SERVED`].
#[must_use]
pub fn unserved(survey: &Survey) -> Vec<String> {
    let rows = survey.rows.iter().flatten();
    rows.filter(|row| best(row).is_none_or(|(_, error)| error > SERVED))
        .map(|row| row.scene.clone())
        .collect()
}

/// `reduced rk2`, with the tolerance of methods that have one.
#[must_use]
pub fn name(method: &Method) -> String {
    if let Some(solver) = &method.solver {
        return solver.clone();
    }
    let form = match method.formulation {
        pinwheel_scene::Formulation::Reduced => "reduced",
        pinwheel_scene::Formulation::Lagrange => "lagrange",
    };
    match method.tolerance {
        Some(tolerance) => format!("{form} {} {tolerance:.0e}", method.integrator),
        None => format!("{form} {}", method.integrator),
    }
}
