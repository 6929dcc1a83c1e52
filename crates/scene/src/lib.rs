//! Scenes: all inputs of a run, read from a TOML file and checked.
//!
//! ```text
//!  preset or file ──┐
//!  its base ────────┼─> read, key by key ─> filled in ─> checked ──> CheckedScene ─> built and run
//!  --set key=value ─┘      (keys)            (formulas)   (ranges,     reads like a Scene, and cannot be changed
//!                                                          geometry)   but by being checked again
//! ```
//!
//! * [`keys`]: one row a key: permitted values, meaning, default.
//! * [`CheckedScene`]: required for building and running; [`CheckedScene::origins`] lists values that the file does not
//!   write.
//! * [`Scales`]: sizes and frequencies of a scene, from which steps and tolerances are chosen.
//! * [`catalogue`]: scenes from data sheets, with suggestions for missing dimensions.
//! * [`load_profile`], [`channels`], [`schema`]: the load over time, columns on request, the JSON schema for editors.
//!
//! # A gear in ten lines
//!
//! ```
//! use pinwheel_scene::{Scene, Source};
//!
//! let text = r#"
//! gear = { eccentricity_m = 0.00075, external_sleeves = 40, pin_circle_radius_m = 0.052, wheels = 2,
//!          external_sleeve_radius_m = 0.002, internal_sleeves = 10, internal_sleeve_radius_m = 0.004,
//!          internal_circle_radius_m = 0.032 }
//! drive = { input_speed_rad_s = 100.0, output_torque_n_m = 200.0 }
//! "#;
//! let scene = Scene::from_toml(text, "mine.toml", &[])?;
//! assert!((scene.gear.hole_radius_m - 0.00475).abs() < 1e-12, "sleeve + eccentricity");
//! let derived = scene.origins().into_iter().filter(|o| matches!(o.source, Source::Formula(_)));
//! assert!(derived.count() > 10);
//! # Ok::<(), pinwheel_scene::SceneError>(())
//! ```

pub mod as_built;
mod assumptions;
pub mod bearings;
mod body;
pub mod catalogue;
pub mod channels;
mod check;
mod checked;
mod cranks;
mod derived;
pub mod deviations;
mod error;
mod fill;
mod formulas;
mod json;
pub mod keys;
mod layout;
mod load;
pub mod load_profile;
mod materials;
mod model;
pub mod names;
mod number;
mod outline;
mod parse;
mod presets;
mod profile;
pub mod quantity;
pub mod scales;
pub mod schema;
pub mod speed_profile;
mod springs;
pub mod structure;
mod table;
mod temperature;
mod uncertain;
mod wall;

pub use assumptions::{Assumption, assumptions};
pub use body::bore_radius_m;
pub use catalogue::Catalogue;
pub use check::doubts;
pub use checked::{CheckedScene, Origin, Source};
pub use derived::{Derived, Frequency, Line, Walls, derived};
pub use error::{Fault, Location, SceneError};
pub use json::JOB_PROTOCOL;
pub use keys::{KEYS, Key};
pub use layout::{Layout, Sleeve};

pub use model::{
    Bearings, BodyMass, Contact, Cranks, Detection, Drive, EccentricBearing, Errors, Formulation,
    FrictionLaw, Gear, Held, Limits, LoadChange, Masses, Modification, NormalOffset, Output,
    OutputPart, PlusMinus, Scene, Solver, SpeedChange, Stabilisation, Start, Structure,
    Temperature,
};
pub use outline::{Outline, turned};
pub use parse::{Draft, Override, edited};
pub use pinwheel_files::{MOST_BYTES, did_you_mean, nearest};
pub use presets::{PRESETS, Preset, preset};
pub use scales::{Scales, free_play, largest_hole_play, largest_play};

/// Private items for the tests of this crate.
#[doc(hidden)]
pub mod internals {
    pub use crate::body::Shape;
    pub use crate::check::{external_sleeves, holes_inside_the_wheel, profile};
    pub use crate::number::{above, below, short, written};
    pub use crate::profile::Profile;
}
