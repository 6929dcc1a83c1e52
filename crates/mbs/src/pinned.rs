//! Contacts in a mechanism of centre-pinned bodies.
//!
//! In such a mechanism a contact's sliding and closing speeds are linear in the free rates: each body turns, and a carried one
//! also swings about its carrier's pin. Bodies that turn at a prescribed rate contribute an offset.

use crate::forces::Forces;
use crate::sliding::{Contact, Row, SlidingStage};
use crate::state::{BodyId, BodyState};

/// Origin of a body's angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Angle {
    /// Free angle: entry of y.
    Free(usize),
    /// Prescribed angle: driver number.
    Driven(usize),
    /// Uniform rotation.
    Idle,
}

/// Free rates of a mechanism, and the contacts of one stage.
#[derive(Debug, Clone)]
pub struct PinnedContacts {
    /// Origin of each body's angle, and the body that carries it.
    pub(crate) pins: Vec<(Angle, Option<BodyId>)>,
    /// Bodies whose rates are free, in order.
    pub(crate) free: Vec<BodyId>,
    /// Bodies without a joint, in order; their velocities (x, y) are numbered after all free rates.
    pub(crate) floating: Vec<BodyId>,
    /// Contacts, to be listed by the forces, and the effect of their friction on the free rates.
    pub(crate) stage: SlidingStage,
}

impl PinnedContacts {
    /// Solves the stage's friction for the listed contacts of `bodies`; see [`SlidingStage::solve`].
    /// `guess` and `rates`: of the free bodies, then of the floating ones.
    pub(crate) fn solve<F: Forces>(
        &mut self,
        a: f64,
        guess: &[f64],
        bodies: &[BodyState],
        forces: &F,
        rates: &mut [f64],
    ) -> bool {
        let (pins, floating) = (&self.pins, (self.free.len(), self.floating.as_slice()));
        self.stage
            .set_rows(|contact| rows(pins, floating, contact, bodies));
        let law = |k: usize, listed: f64, rate: f64| forces.normal_force(k, listed, rate);
        self.stage.solve(a, guess, rates, law)
    }
}

/// Returns the sliding and closing speeds of `contact` as functions of the free rates and of the velocities of the `floating`
/// bodies, which are numbered from the given number on.
#[inline]
fn rows(
    pins: &[(Angle, Option<BodyId>)],
    (first, floating): (usize, &[BodyId]),
    contact: &Contact,
    bodies: &[BodyState],
) -> [Row; 2] {
    let [x, y] = contact.point;
    let [nx, ny] = contact.normal;
    let (mut tangent, mut normal) = (Row::default(), Row::default());
    let (mut known_t, mut known_n) = (0.0, 0.0);
    for (body, sign) in [(contact.bodies[0], 1.0), (contact.bodies[1], -1.0)] {
        let at = bodies[body];
        // Velocity by a unit rate about (cx, cy) at a point at (px, py) from it: (-py, px).
        let rates = |px: f64, py: f64| (sign * (px * nx + py * ny), sign * (px * ny - py * nx));
        if let Some(number) = floating.iter().position(|&floats| floats == body) {
            let dof = first + 2 * number;
            for (dof, t, n) in [(dof, -ny, nx), (dof + 1, nx, ny)] {
                tangent.push(dof, sign * t);
                normal.push(dof, sign * n);
            }
        } else {
            known_t += sign * (nx * at.vy - ny * at.vx);
            known_n += sign * (nx * at.vx + ny * at.vy);
        }
        let (spin_t, spin_n) = rates(x - at.x, y - at.y);
        if let Angle::Free(dof) = pins[body].0 {
            tangent.push(dof, spin_t);
            normal.push(dof, spin_n);
        } else {
            known_t += spin_t * at.rate;
            known_n += spin_n * at.rate;
        }
        if let Some(carrier) = pins[body].1
            && let Angle::Free(dof) = pins[carrier].0
        {
            let base = bodies[carrier];
            let (swing_t, swing_n) = rates(at.x - base.x, at.y - base.y);
            tangent.push(dof, swing_t);
            normal.push(dof, swing_n);
            known_t -= swing_t * base.rate;
            known_n -= swing_n * base.rate;
        }
    }
    (tangent.offset, normal.offset) = (tangent.offset + known_t, normal.offset + known_n);
    [tangent, normal]
}
