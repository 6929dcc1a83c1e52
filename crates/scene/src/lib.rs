//! Scenes: the TOML file, its presets and its checks.

mod assumptions;
mod body;
pub mod channels;
mod check;
mod checked;
mod derived;
mod error;
mod fill;
pub mod keys;
mod layout;
mod load;
pub mod load_course;
mod model;
pub mod names;
mod parse;
mod presets;
mod profile;
pub mod scales;
pub mod schema;
mod suggest;
#[cfg(test)]
mod tests;

pub use assumptions::{Assumption, assumptions};
pub use checked::{CheckedScene, Origin, Source};
pub use derived::{Derived, Frequency, derived};
pub use error::{Fault, Place, SceneError};
pub use keys::{KEYS, Key};
pub use layout::{Layout, Sleeve};
pub use model::{
    BodyMass, Contact, Detection, Drive, Formulation, FrictionLaw, Gear, LoadChange, Masses,
    Output, Scene, Solver, Stabilisation, Start,
};
pub use parse::{MOST_BYTES, Override};
pub use presets::{PRESETS, Preset, preset};
pub use scales::{Scales, free_play};
pub use suggest::{did_you_mean, nearest};
