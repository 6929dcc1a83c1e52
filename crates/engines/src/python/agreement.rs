//! Our law against the package's own, written a second time from the paper's equations, at random states.

use std::sync::atomic::AtomicBool;

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::scales::law_parameters;
use pinwheel_scene::{CheckedScene, Scene};
use pyo3::prelude::*;

use super::law::Published;
use super::{convert, engine, host};
use crate::engine::{Ending, Halt};

/// How far the two implementations are apart.
#[derive(Debug, Clone, Copy, PartialEq, FromPyObject)]
pub struct Agreement {
    /// States compared.
    pub states: usize,
    /// Number of states in which something touches.
    pub loaded: usize,
    /// Largest force in any state, N.
    pub largest_n: f64,
    /// Largest difference of any force over the largest force of its state; where nearly nothing touches, rounding
    /// is all there is.
    pub worst_relative: f64,
    /// Largest difference of any force, N.
    pub worst_n: f64,
    /// Largest difference of any force over what rounding of lengths and speeds explains in its state.
    pub worst_over_rounding: f64,
    /// Largest difference of any moment over (largest force of its state times the largest lever), relative.
    pub worst_moment_relative: f64,
    /// States left out because two points of a disc are equally near to within rounding (points detection).
    pub ambiguous: usize,
}

/// Compares both laws at `states` random states near the mesh.
///
/// # Errors
/// The scene has a law that only ours knows, or Python is missing or broke.
pub fn law_agreement(scene: &CheckedScene, states: usize, seed: u64) -> Result<Agreement, Halt> {
    host::ready(&AtomicBool::new(false))?;
    let gearbox = Gearbox::new(scene).map_err(Ending::failed)?;
    let law = Published::new(&gearbox)?;
    // numpy does not look for the wall behind a contact.
    let mut told = Scene::clone(scene);
    told.contact.disc_depth_m = Some(law_parameters(scene).disc_depth).filter(|depth| *depth > 0.0);
    Python::attach(|py| {
        let compare = || -> PyResult<Agreement> {
            let package = host::package(py)?;
            let pointer = engine::pointer(&package, &law)?;
            let found = py
                .import("pinwheel_engines.agreement")?
                .call_method1("compare", (told.to_toml(), pointer, states, seed))?;
            found.extract()
        };
        compare().map_err(|error| convert::halt(py, &error))
    })
}
