//! Channels beyond the contract's columns, recorded if a scene selects them.
//!
//! Channels are evaluated at sample times only, from states of the run. A channel costs nothing unless selected, and never
//! changes a step or a right-hand side.
//!
//! Signs and frames (docs/physics.md): n points from the pin's centre to the disc's closest point W, velocities are the
//! pin's less the disc's at W, `t = R90 n`. Channels describe a pair at its closest points also without contact: a negative
//! penetration is the gap. Forces of joints act on the carried body and are given in the ground frame.

mod catalogue;
mod select;

#[doc(hidden)]
pub use catalogue::always_there;
pub use catalogue::{Chosen, Component, FAMILIES, Family, Joint, PairQuantity, Part, What, Whole};
#[doc(hidden)]
pub use select::{MOST_PATTERNS, select};

use crate::Scene;
use crate::layout::Layout;

/// Selected columns of a scene.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Channels {
    /// Columns in the order of the catalogue.
    pub list: Vec<Chosen>,
}

impl Channels {
    /// Returns the channels of a scene.
    ///
    /// # Errors
    /// A pattern without a match, as text with a suggestion.
    pub fn of(scene: &Scene) -> Result<Self, String> {
        let list = select(&scene.output.channels, Layout::of(&scene.gear));
        let list =
            list.map_err(|fault| format!("output.channels {}; {}", fault.what, fault.remedy))?;
        Ok(Self { list })
    }

    /// Returns the names of the columns in their order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.list.iter().map(|chosen| chosen.name.as_str())
    }

    /// True if no channel is selected.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Number of columns.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Returns the channels for whose names `there` is false.
    pub fn without(&self, there: impl Fn(&str) -> bool) -> Self {
        let list = self.list.iter().filter(|chosen| !there(&chosen.name));
        Self {
            list: list.cloned().collect(),
        }
    }

    /// Returns the selected families with the number of columns from each.
    pub fn families(&self) -> Vec<(&'static Family, usize)> {
        let count = |family: &Family| {
            let fits = |chosen: &&Chosen| pinwheel_files::fits(family.pattern, &chosen.name);
            self.list.iter().filter(fits).count()
        };
        let counted = FAMILIES.iter().map(|family| (family, count(family)));
        counted.filter(|&(_, count)| count > 0).collect()
    }
}
