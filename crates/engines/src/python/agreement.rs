//! Comparison of the contact law with the package's independent implementation of the paper's equations, at random states.

use std::sync::atomic::AtomicBool;

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::scales::law_parameters;
use pinwheel_scene::{CheckedScene, Scene};
use pyo3::prelude::*;

use super::package::package;
use super::published::Published;
use super::{convert, engine, host};
use crate::engine::{Ending, Halt};

/// Largest differences between the two implementations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// States compared.
    pub states: usize,
    /// Number of states with contact.
    pub loaded: usize,
    /// Largest force in any state, N.
    pub largest_n: f64,
    /// Largest difference of any force over the largest force of its state; near 0 force it is only rounding.
    pub worst_relative: f64,
    /// Largest difference of any force, N.
    pub worst_n: f64,
    /// Largest difference of any force over the effect of rounding of lengths and speeds in its state.
    pub worst_over_rounding: f64,
    /// Largest difference of any moment over the largest force of its state times the largest lever.
    pub worst_moment_relative: f64,
    /// States omitted because two points of a disc are equally near to within rounding (points detection).
    pub ambiguous: usize,
}

/// Compares both laws at `states` random states near the mesh.
///
/// # Errors
/// The package does not have the scene's law, or Python is missing or failed.
pub fn law_agreement(scene: &CheckedScene, states: usize, seed: u64) -> Result<Agreement, Halt> {
    host::ready(&AtomicBool::new(false))?;
    let gearbox = Gearbox::new(scene).map_err(Ending::failed)?;
    let law = Published::new(&gearbox)?;
    // The numpy version does not compute the wall behind a contact.
    let mut walled = Scene::clone(scene);
    walled.contact.disc_depth_m =
        Some(law_parameters(scene).disc_depth).filter(|depth| *depth > 0.0);
    Python::attach(|py| {
        let compare = || -> PyResult<Agreement> {
            let pointer = engine::pointer(&package(py)?, &law)?;
            let apart = py
                .import("pinwheel_engines.agreement")?
                .call_method1("compare", (walled.to_toml(), pointer, states, seed))?;
            let of = |name: &str| apart.getattr(name);
            Ok(Agreement {
                states: of("states")?.extract()?,
                loaded: of("loaded")?.extract()?,
                largest_n: of("largest_n")?.extract()?,
                worst_relative: of("worst_relative")?.extract()?,
                worst_n: of("worst_n")?.extract()?,
                worst_over_rounding: of("worst_over_rounding")?.extract()?,
                worst_moment_relative: of("worst_moment_relative")?.extract()?,
                ambiguous: of("ambiguous")?.extract()?,
            })
        };
        compare().map_err(|error| convert::halt(py, &error))
    })
}
