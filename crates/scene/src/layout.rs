//! Layout of the list of bodies: the index of each body.

use std::ops::Range;

use crate::Gear;

/// Body indices: input, output, discs, ring pins, output pins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Number of discs.
    pub wheels: usize,
    /// zk.
    pub external_sleeves: usize,
    /// zi.
    pub internal_sleeves: usize,
}

impl Layout {
    /// Index of the input shaft.
    pub const INPUT: usize = 0;
    /// Index of the output shaft.
    pub const OUTPUT: usize = 1;

    /// Returns the layout of a gear.
    pub fn of(gear: &Gear) -> Self {
        Self {
            wheels: gear.wheels,
            external_sleeves: gear.external_sleeves,
            internal_sleeves: gear.internal_sleeves,
        }
    }

    /// Indices of the discs.
    #[inline]
    pub fn wheel_bodies(&self) -> Range<usize> {
        2..2 + self.wheels
    }

    /// Indices of the ring pins.
    #[inline]
    pub fn external_bodies(&self) -> Range<usize> {
        let from = 2 + self.wheels;
        from..from + self.external_sleeves
    }

    /// Indices of the output pins.
    #[inline]
    pub fn internal_bodies(&self) -> Range<usize> {
        let from = 2 + self.wheels + self.external_sleeves;
        from..from + self.internal_sleeves
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        self.internal_bodies().end
    }

    /// Returns the body index of a pin.
    pub fn sleeve_body(&self, sleeve: Sleeve) -> usize {
        match sleeve {
            Sleeve::External(j) => self.external_bodies().start + j,
            Sleeve::Internal(k) => self.internal_bodies().start + k,
        }
    }
}

/// Pin, by kind and number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sleeve {
    /// Ring pin on the housing, 0 at angle 0, counter-clockwise.
    External(usize),
    /// Output pin on the output shaft.
    Internal(usize),
}

impl Sleeve {
    /// Returns 0 for a ring pin and 1 for an output pin.
    #[must_use]
    #[inline]
    pub fn side(self) -> usize {
        usize::from(matches!(self, Self::Internal(_)))
    }
}
