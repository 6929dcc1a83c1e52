//! Equations of one balance: its input angle and load, the carrier of the discs, and the free coordinates.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use pinwheel_mbs::BodyState;

use crate::Layout;
use crate::carrier::Carrier;

/// Number of unknowns of a disc that floats.
pub(super) const OF_A_DISC: usize = 3;

/// Permitted residual, relative to the load's size.
pub(super) const LEFT: f64 = 1e-9;

/// Residuals at which Newton's method ends at once, relative to the load's size. Figures of poses over a mesh need no more than
/// `TRACKED`, which is the rounding that they are given.
pub(super) const GOAL: f64 = 1e-12;
pub(super) const TRACKED: f64 = 1e-9;

/// Residual of a balance, and the inverse of the Jacobian that led there.
pub(super) type Balanced = (DVector<f64>, Option<DMatrix<f64>>);

/// Unknowns besides the output's angle, which is the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Free {
    /// None: rigid cranks turn the discs with the output.
    Output,
    /// Angle of every disc, on rigid eccentrics.
    Angles,
    /// Place and angle of every disc.
    Places,
}

/// Scales of lengths, angles, forces and moments.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub(super) length: f64,
    pub(super) angle: f64,
    pub(super) force: f64,
    pub(super) moment: f64,
}

/// Balance to be solved.
#[derive(Debug, Clone)]
pub(super) struct Problem {
    /// Input angle, rad.
    pub(super) phi: f64,
    /// Moment on the output, N m.
    pub(super) load: f64,
    /// Bearings of the discs, without friction.
    pub(super) carrier: Arc<Carrier>,
    pub(super) free: Free,
    pub(super) size: Size,
    /// Residual at which Newton's method ends, relative to the load's size.
    pub(super) goal: f64,
    /// Angle of the output at the ideal mesh, rad, and its largest distance from there before teeth jump, rad.
    pub(super) ideal: f64,
    pub(super) reach: f64,
}

impl Problem {
    /// Returns the unknowns of bodies at their poses.
    pub(super) fn unknowns(&self, bodies: &[BodyState], layout: Layout) -> Vec<f64> {
        let discs = bodies[layout.wheel_bodies()].iter();
        let output = std::iter::once(bodies[Layout::OUTPUT].angle);
        match self.free {
            Free::Output => output.collect(),
            Free::Angles => output.chain(discs.map(|disc| disc.angle)).collect(),
            Free::Places => output
                .chain(discs.flat_map(|disc| [disc.x, disc.y, disc.angle]))
                .collect(),
        }
    }

    /// Returns true if an unknown is a coordinate of a disc's centre, not an angle.
    pub(super) fn is_length(&self, unknown: usize) -> bool {
        self.free == Free::Places && unknown > 0 && !unknown.is_multiple_of(OF_A_DISC)
    }

    /// Returns the size of an unknown, m or rad.
    pub(super) fn of_place(&self, unknown: usize) -> f64 {
        match self.is_length(unknown) {
            true => self.size.length,
            false => self.size.angle,
        }
    }

    /// Returns the size of the residual at an unknown, N or N m.
    fn of_load(&self, unknown: usize) -> f64 {
        match self.is_length(unknown) {
            true => self.size.force,
            false => self.size.moment,
        }
    }

    /// Returns the largest residual, relative to its size.
    pub(super) fn unbalanced(&self, residual: &DVector<f64>) -> f64 {
        let shares = residual.iter().enumerate();
        shares.fold(0.0, |most, (k, x)| {
            f64::max(most, x.abs() / self.of_load(k))
        })
    }

    /// Returns the largest step, relative to its size.
    pub(super) fn moved(&self, step: impl IntoIterator<Item = f64>) -> f64 {
        let shares = step.into_iter().enumerate();
        shares.fold(0.0, |most, (k, x)| {
            f64::max(most, x.abs() / self.of_place(k))
        })
    }

    /// Returns the Jacobian with springs to the last iterate, whose stiffness is `share` of a contact's.
    pub(super) fn held(&self, mut jacobian: DMatrix<f64>, share: f64) -> DMatrix<f64> {
        for k in 0..jacobian.nrows() {
            jacobian[(k, k)] -= share * (self.of_load(k) / self.of_place(k));
        }
        jacobian
    }
}
