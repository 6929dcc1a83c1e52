//! Seals of the shafts: a torque against their turning.
//!
//! ```text
//! M = -T clamp(rate/slow, -1, 1)
//! ```
//! with slow = 1 rad/s at the input, and as much less at the output as that turns slower.

use pinwheel_contact::PinLaw;
use pinwheel_mbs::{BodyState, Evaluation, Jacobian, Pose};

use super::field::{ContactEnergy, ContactField, PairContact};
use super::floating::EccentricBearings;
use super::pairs::OUTPUT;
use super::pin_friction::PinFriction;
use crate::scene::Scene;
use crate::{Layout, Sleeve};

/// Torque that holds back a body, and the rate below which it fades.
#[derive(Debug, Clone, Copy)]
struct Seal {
    body: usize,
    torque_n_m: f64,
    slow_rad_s: f64,
}

/// The seals of input and output.
#[derive(Debug, Clone, Copy)]
pub struct Seals([Seal; 2]);

impl Seal {
    fn moment(&self, bodies: &[BodyState]) -> f64 {
        let share = bodies[self.body].rate / self.slow_rad_s;
        -self.torque_n_m * share.clamp(-1.0, 1.0)
    }
}

impl Seals {
    /// `None` where no torque is given.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let bearings = &scene.bearings;
        let torques = [bearings.input_seal_n_m, bearings.output_seal_n_m];
        let bodies = [Layout::INPUT, Layout::OUTPUT];
        let slow = [1.0, 1.0 / scene.ratio()];
        torques.iter().any(Option::is_some).then(|| {
            Self([0, 1].map(|k| Seal {
                body: bodies[k],
                torque_n_m: torques[k].unwrap_or_default(),
                slow_rad_s: slow[k],
            }))
        })
    }

    /// Adds their moments to a value of each body.
    pub(crate) fn add<T>(
        &self,
        bodies: &[BodyState],
        to: &mut [T],
        moment: impl Fn(&mut T) -> &mut f64,
    ) {
        for seal in &self.0 {
            *moment(&mut to[seal.body]) += seal.moment(bodies);
        }
    }

    /// Adds how the output's fades where it turns slowly; the input's rate is constant.
    pub(super) fn add_jacobian(&self, bodies: &[BodyState], derivatives: &mut Jacobian) {
        let [_, output] = self.0;
        if bodies[output.body].rate.abs() < output.slow_rad_s {
            let slope = -output.torque_n_m / output.slow_rad_s;
            derivatives.rate.add(OUTPUT, OUTPUT, slope);
        }
    }

    pub(super) fn lost_w(&self, bodies: &[BodyState]) -> f64 {
        let of = |seal: &Seal| -seal.moment(bodies) * bodies[seal.body].rate;
        self.0.iter().map(of).sum()
    }
}

/// A field with seals.
struct Sealed {
    inner: Box<dyn ContactField>,
    seals: Seals,
}

/// A field with a scene's seals; the field itself where there are none.
pub(super) fn with_seals(scene: &Scene, inner: Box<dyn ContactField>) -> Box<dyn ContactField> {
    match Seals::of(scene) {
        Some(seals) => Box::new(Sealed { inner, seals }),
        None => inner,
    }
}

impl ContactField for Sealed {
    fn evaluate(&mut self, bodies: &[BodyState], pose: Pose, sums: &mut Evaluation<'_>) -> bool {
        if !self.inner.evaluate(bodies, pose, sums) {
            return false;
        }
        let seals = &self.seals;
        if let Some(loads) = sums.loads.as_deref_mut() {
            seals.add(bodies, loads, |load| &mut load.moment);
        }
        if let Some(moments) = sums.moments.as_deref_mut() {
            seals.add(bodies, moments, |moment| moment);
        }
        if let Some(energy) = &mut sums.energy {
            energy.seal_friction_w += seals.lost_w(bodies);
        }
        if let Some(derivatives) = sums.derivatives.as_deref_mut() {
            seals.add_jacobian(bodies, derivatives);
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
        sum.seal_friction_w += self.seals.lost_w(bodies);
        sum
    }

    fn bearings(&self) -> Option<&EccentricBearings> {
        self.inner.bearings()
    }

    fn on_pins(&self) -> Option<PinFriction> {
        self.inner.on_pins()
    }

    fn seals(&self) -> Option<&Seals> {
        Some(&self.seals)
    }
}
