//! Cycloidal gearboxes: scene, mechanism, contacts and the native run.

pub mod contacts;
mod layout;
pub mod scene;

pub use layout::{Layout, Sleeve};
