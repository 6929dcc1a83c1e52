//! Cycloidal gearboxes: scene, mechanism, contacts and the native run.

pub mod auto;
mod balance;
pub mod channels;
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
pub mod native;
mod pace;
mod recorder;
pub mod resolve;
pub mod statics;

use pinwheel_scene::{self as scene, Layout, Sleeve, load_course};

pub use distance::Distance;
pub use efficiency::Efficiency;
pub use explain::{Explanation, Statement, explain};
pub use frequencies::Frequencies;
pub use gearbox::{Gearbox, GearboxError};
pub use geometry::Geometry;
pub use recorder::Recorder;
