//! Cycloidal gearboxes: scene, mechanism, contacts and the native run.

pub mod auto;
mod balance;
pub mod channels;
pub mod claims;
pub mod contacts;
mod distance;
mod due;
mod efficiency;
pub mod energy;
mod explain;
mod frequencies;
mod friction;
mod gearbox;
mod geometry;
pub mod guard;
mod layout;
pub mod load_course;
pub mod native;
mod pace;
mod recorder;
pub mod resolve;
pub mod scene;
pub mod statics;

pub use distance::Distance;
pub use efficiency::Efficiency;
pub use explain::{Explanation, Statement, explain};
pub use frequencies::Frequencies;
pub use gearbox::{Gearbox, GearboxError};
pub use geometry::Geometry;
pub use layout::{Layout, Sleeve};
pub use recorder::Recorder;
