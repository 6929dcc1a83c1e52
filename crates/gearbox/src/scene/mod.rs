//! Scenes: the TOML file, its presets and its checks.

mod model;

pub use model::{
    BodyMass, Contact, Detection, Drive, Formulation, Gear, Masses, Scene, Solver, Stabilisation, Start,
};
