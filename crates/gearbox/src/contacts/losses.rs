//! A field with what is lost beside its contacts and bearings: by sleeves that rub on their pins, and by seals.

use pinwheel_contact::PinLaw;
use pinwheel_mbs::{BodyState, Pose, Sums};

use super::field::{ContactEnergy, ContactField, PairContact};
use super::floating::Bearings;
use super::seals::Seals;
use super::sleeves::OnPins;
use crate::Sleeve;
use crate::scene::Scene;

struct Losses {
    inner: Box<dyn ContactField>,
    pins: Option<OnPins>,
    seals: Option<Seals>,
}

/// A field with a scene's losses; the field itself where there are none.
pub(super) fn with_losses(scene: &Scene, inner: Box<dyn ContactField>) -> Box<dyn ContactField> {
    let (pins, seals) = (OnPins::of(scene), Seals::of(scene));
    match (&pins, &seals) {
        (None, None) => inner,
        _ => Box::new(Losses { inner, pins, seals }),
    }
}

impl ContactField for Losses {
    fn evaluate(&mut self, bodies: &[BodyState], pose: Pose, sums: &mut Sums<'_>) -> bool {
        // Pairs are told of bodies in place alone.
        let is_told = self.pins.is_none() || pose != Pose::AnglesOnly && sums.moments.is_none();
        if !is_told || !self.inner.evaluate(bodies, pose, sums) {
            return false;
        }
        if let Some(pins) = self.pins
            && (sums.loads.is_some() || sums.energy.is_some())
        {
            let mut lost_w = 0.0;
            self.inner.touching(bodies, &mut |pair| {
                let drag = pins.drag(bodies, pair);
                if let Some(loads) = sums.loads.as_deref_mut() {
                    pins.add(bodies, pair, &drag, loads);
                }
                lost_w += drag.lost_w;
            });
            if let Some(energy) = &mut sums.energy {
                energy.friction_w += lost_w;
            }
        }
        let Some(seals) = &self.seals else {
            return true;
        };
        if let Some(loads) = sums.loads.as_deref_mut() {
            seals.add(bodies, loads, |load| &mut load.moment);
        }
        if let Some(moments) = sums.moments.as_deref_mut() {
            seals.add(bodies, moments, |moment| moment);
        }
        if let Some(energy) = &mut sums.energy {
            energy.friction_w += seals.lost_w(bodies);
        }
        if let Some(slopes) = sums.slopes.as_deref_mut() {
            seals.add_slopes(bodies, slopes);
        }
        true
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        self.inner.touching(bodies, visit);
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        self.inner.nearest(bodies, wheel, sleeve)
    }

    fn law(&self) -> &PinLaw {
        self.inner.law()
    }

    fn energy(&mut self, bodies: &[BodyState]) -> ContactEnergy {
        let mut sum = self.inner.energy(bodies);
        if let Some(pins) = self.pins {
            self.inner.touching(bodies, &mut |pair| {
                sum.friction_w += pins.drag(bodies, pair).lost_w;
            });
        }
        if let Some(seals) = &self.seals {
            sum.friction_w += seals.lost_w(bodies);
        }
        sum
    }

    fn bearings(&self) -> Option<&Bearings> {
        self.inner.bearings()
    }

    fn seals(&self) -> Option<&Seals> {
        self.seals.as_ref()
    }
}
