//! Seals of the shafts: a torque against their rotation.
//!
//! ```text
//! M = -T clamp(rate/slow, -1, 1)
//! ```
//! slow is 1 rad/s at the input, and smaller at the output by the speed ratio.

use pinwheel_mbs::{BodyState, Derivatives, Evaluation};

use super::motion;
use crate::Layout;
use crate::scene::Scene;

/// Torque against the rotation of a body, and the rate below which it fades.
#[derive(Debug, Clone, Copy)]
struct Seal {
    body: usize,
    torque_n_m: f64,
    slow_rad_s: f64,
}

/// Seals of input and output.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seals([Seal; 2]);

impl Seal {
    fn moment(&self, bodies: &[BodyState]) -> f64 {
        let share = bodies[self.body].rate / self.slow_rad_s;
        -self.torque_n_m * share.clamp(-1.0, 1.0)
    }
}

impl Seals {
    /// Returns the seals of a scene; `None` without a seal torque.
    pub(crate) fn of(scene: &Scene) -> Option<Self> {
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

    /// Adds the requested loads, moments, derivatives and energy.
    pub(super) fn add(&self, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        if let Some(loads) = request.loads.as_deref_mut() {
            self.add_moments(bodies, loads, |load| &mut load.moment);
        }
        if let Some(moments) = request.moments.as_deref_mut() {
            self.add_moments(bodies, moments, |moment| moment);
        }
        if let Some(energy) = &mut request.energy {
            energy.seal_friction_w += self.lost_w(bodies);
        }
        if let Some(derivatives) = &mut request.derivatives {
            self.add_jacobian(bodies, derivatives);
        }
    }

    /// Adds the seals' moments to a value of each body.
    pub(crate) fn add_moments<T>(
        &self,
        bodies: &[BodyState],
        to: &mut [T],
        moment: impl Fn(&mut T) -> &mut f64,
    ) {
        for seal in &self.0 {
            *moment(&mut to[seal.body]) += seal.moment(bodies);
        }
    }

    /// Adds the derivative of the output's seal torque, which fades where the output turns slowly; the input's rate is
    /// constant.
    fn add_jacobian(&self, bodies: &[BodyState], derivatives: &mut Derivatives<'_>) {
        let [_, output] = self.0;
        if bodies[output.body].rate.abs() < output.slow_rad_s {
            let slope = -output.torque_n_m / output.slow_rad_s;
            let row = derivatives.coordinates.angle(output.body);
            derivatives.add(row, &[motion::rate(row, 0.0)], &[slope]);
        }
    }

    pub(super) fn lost_w(&self, bodies: &[BodyState]) -> f64 {
        let of = |seal: &Seal| -seal.moment(bodies) * bodies[seal.body].rate;
        self.0.iter().map(of).sum()
    }
}
