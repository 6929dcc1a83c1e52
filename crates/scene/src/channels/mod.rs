//! Channels beyond the contract's columns, recorded when a scene asks for them.
//!
//! Channels are evaluated at sample times only, from states that the run has anyway. A channel that is not asked
//! for is not computed; a channel that is asked for changes neither a step nor a right-hand side.
//!
//! Signs and frames (docs/physics.md): n points from the pin's centre to the disc's closest point W,
//! velocities are the pin's less the disc's at W, `t = R90 n`. A pair is described at its
//! closest points whether or not it touches: a negative penetration is the gap. Forces of joints act
//! on the body that the joint carries; they are given in the ground frame.

mod catalogue;
mod select;

#[doc(hidden)]
pub use catalogue::always_there;
pub use catalogue::{Chosen, Component, FAMILIES, Family, Joint, PairQuantity, Part, What, Whole};
#[doc(hidden)]
pub use select::{MOST_PATTERNS, select};

use crate::Scene;
use crate::layout::Layout;

/// The columns that a scene asks for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Channels {
    /// The columns, in the order of the catalogue.
    pub list: Vec<Chosen>,
}

impl Channels {
    /// The channels of a scene.
    ///
    /// # Errors
    /// In words: a pattern that nothing fits, and what may have been meant.
    pub fn of(scene: &Scene) -> Result<Self, String> {
        let list = select(&scene.output.channels, Layout::of(&scene.gear));
        let list =
            list.map_err(|fault| format!("output.channels {}; {}", fault.what, fault.remedy))?;
        Ok(Self { list })
    }

    /// Names of the columns, in their order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.list.iter().map(|chosen| chosen.name.as_str())
    }

    /// True if nothing is asked for.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Number of columns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Channels whose name `there` does not know.
    #[must_use]
    pub fn without(&self, there: impl Fn(&str) -> bool) -> Self {
        let list = self.list.iter().filter(|chosen| !there(&chosen.name));
        Self {
            list: list.cloned().collect(),
        }
    }

    /// The families that are asked for, as patterns with the number of columns taken from each.
    #[must_use]
    pub fn families(&self) -> Vec<(&'static Family, usize)> {
        let count = |family: &Family| {
            let fits = |chosen: &&Chosen| pinwheel_files::fits(family.pattern, &chosen.name);
            self.list.iter().filter(fits).count()
        };
        let counted = FAMILIES.iter().map(|family| (family, count(family)));
        counted.filter(|&(_, count)| count > 0).collect()
    }
}
