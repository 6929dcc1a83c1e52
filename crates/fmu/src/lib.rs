//! A scene as a co-simulation unit: FMI 2.0 [Functional Mock-up Interface for Model Exchange and Co-Simulation, version 2.0,
//! Modelica Association, 2014].
//!
//! ```text
//!  scene ──package──> NAME.fmu ┬─ modelDescription.xml    every variable
//!                              ├─ binaries/PLATFORM/      libpinwheel_fmu, the same for every scene
//!                              └─ resources/scene.toml    the scene, every key resolved
//!  importer ──border──> Instance ──> CoSimulation, the native solver
//! ```
//! The library reads the scene when it is instantiated, so that neither building nor using a unit needs a compiler.

pub mod ffi;
mod instance;
mod model;
mod package;

pub use instance::{Instance, Refusal};
pub use model::{Model, Variable, What};
pub use package::{Imprint, Package, PackageError};

/// Private items that the tests of this crate reach; no part of the interface.
#[doc(hidden)]
pub mod internals {
    pub use crate::package::{Unit, identifier};
}
