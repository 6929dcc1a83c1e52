//! The way to a balance: Newton's method, and down the work of forces where it leads nowhere.

use nalgebra::DVector;

use super::super::Statics;
use super::{LEFT, Size};
use crate::carrier::Carrier;

/// Newton steps at most, halvings of one, and what a step must leave at most for its derivatives to serve the next.
const STEPS: usize = 60;
const HALVINGS: usize = 12;
const SERVES: f64 = 0.2;
/// Largest ratio of residuals after and before a step with fresh derivatives at which that step counts as progress.
const SLOW: f64 = 0.9;
/// Steps at most of a search for where forces do no work along a step, and what may be left of it.
const WORKS: usize = 40;
const WORK: f64 = 0.1;
/// Most of the way over which the mesh holds that such a step may take.
const FARTHEST: f64 = 0.1;
/// Where rounding of stiff contacts leaves more, up to this, a balance is one that a Newton step moves by no more than such a share
/// of the contacts' depths and twists.
const ROUNDED: f64 = 1e-7;
const STILL: f64 = 1e-8;
/// Newton goes on as long as it gains, down to this.
const BALANCED: f64 = 1e-10;
/// A weak spring to the last iterate, as a share of a contact's stiffness: for directions that nothing holds.
const WEAK: f64 = 1e-9;
/// Springs to the last iterate where a gear snaps through, as shares of a contact's stiffness. The weakest that works
/// is taken.
const HOLDS: [f64; 6] = [WEAK, 1e-2, 0.1, 1.0, 10.0, 100.0];

impl Statics<'_> {
    /// Newton's method from `u`, with halved steps; what is left, or `None` where it got stuck.
    pub(super) fn newton_on_bearings(
        &mut self,
        phi: f64,
        load: f64,
        bearings: &Carrier,
        u: &mut Vec<f64>,
    ) -> Option<DVector<f64>> {
        let size = self.size(load, bearings);
        let norm = |left: &DVector<f64>| Size::largest(left, |k| size.of_load(k));
        let mut here = self.left(phi, load, bearings, u, None);
        let mut most = norm(&here);
        // Derivatives cost more than forces, so they serve as long as steps with them gain.
        let mut derivatives = None;
        for _ in 0..STEPS {
            if most < BALANCED {
                break;
            }
            let is_fresh = derivatives.is_none();
            if is_fresh {
                let matrix = self.matrix(phi, load, bearings, (u, &here), size);
                derivatives = Some(size.held(matrix, WEAK).lu());
            }
            let step = -derivatives.as_ref()?.solve(&here)?;
            let mut share = self.farthest(&step, size);
            let before = most;
            // What is left at a balance is rounding, which no shorter step betters.
            let tries = if is_fresh && most > LEFT { HALVINGS } else { 1 };
            for _ in 0..tries {
                let there: Vec<f64> = u.iter().zip(&step).map(|(u, s)| u + share * s).collect();
                let left = self.left(phi, load, bearings, &there, None);
                let now = norm(&left);
                if now < most {
                    (*u, here, most) = (there, left, now);
                    break;
                }
                share *= 0.5;
            }
            if most > SERVES * before {
                derivatives = None;
                let stuck = most > SLOW * before;
                if is_fresh && stuck {
                    let moved = Size::largest(&step, |k| size.of_place(k));
                    let is_still = moved <= STILL && most <= ROUNDED;
                    if most < LEFT || is_still {
                        return Some(here);
                    }
                    *u = self.downhill(phi, load, bearings, (u, &here))?;
                    here = self.left(phi, load, bearings, u, None);
                    most = norm(&here);
                }
            }
        }
        (most < LEFT).then_some(here)
    }

    /// The share of a step that leads nowhere near another tooth: where nothing holds, steps have no bounds of their own.
    fn farthest(&self, step: &DVector<f64>, size: Size) -> f64 {
        let angle = FARTHEST * self.brackets().1;
        let far = Size {
            length: angle * self.gearbox.scene.gear.lever_m(),
            angle,
            ..size
        };
        f64::min(1.0, 1.0 / Size::largest(step, |k| far.of_place(k)))
    }

    /// From `u` to where forces do next to no more work along a Newton step: contacts that open and close on the way leave more than
    /// before, by which Newton's method alone would never get past them. Where the gear snaps through, and a step would be against
    /// the forces, springs to `u` hold it.
    fn downhill(
        &mut self,
        phi: f64,
        load: f64,
        bearings: &Carrier,
        (u, here): (&[f64], &DVector<f64>),
    ) -> Option<Vec<f64>> {
        let size = self.size(load, bearings);
        let matrix = self.matrix(phi, load, bearings, (u, here), size);
        let step = HOLDS.iter().find_map(|&hold| {
            let step = -size.held(matrix.clone(), hold).lu().solve(here)?;
            (here.dot(&step) > 0.0).then_some(step)
        })?;
        let moved = Size::largest(&step, |k| size.of_place(k));
        let at =
            |share: f64| -> Vec<f64> { u.iter().zip(&step).map(|(u, s)| u + share * s).collect() };
        // Through free play as far as something holds, and not beyond it, nor over a tooth.
        let farthest = self.farthest(&step, size);
        let (mut low, mut high) = (0.0, farthest);
        let mut share = f64::min(farthest, 1.0 / moved);
        let mut caught = false;
        for _ in 0..WORKS {
            let work = self.left(phi, load, bearings, &at(share), None).dot(&step);
            caught |= work <= 0.0;
            match work > 0.0 {
                true => low = share,
                false => high = share,
            }
            if work.abs() <= WORK * here.dot(&step) || low == farthest {
                break;
            }
            share = match caught {
                true => 0.5 * (low + high),
                false => f64::min(2.0 * share, farthest),
            };
        }
        Some(at(share))
    }
}
