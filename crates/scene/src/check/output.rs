//! The channels that a scene asks for must exist in its gearbox.

use super::super::error::Fault;
use super::super::model::Scene;
use crate::channels::select;
use crate::layout::Layout;

/// Number of columns asked for.
pub(super) fn columns(scene: &Scene) -> Result<usize, Fault> {
    match select(&scene.output.channels, Layout::of(&scene.gear)) {
        Ok(chosen) => Ok(chosen.len()),
        Err(unknown) => Err(Fault::new(
            &["output.channels"],
            unknown.what,
            unknown.remedy,
        )),
    }
}
