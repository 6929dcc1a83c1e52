//! One contact at one instant: a law by itself, for test vectors and for other programs.

use super::{Law, NormalLaw};

/// What a law sees of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapState {
    /// Hertz's K of the pair, N/m^1.5; laws with a stiffness of their own do not look at it.
    pub stiffness: f64,
    /// Growth of K as the sleeve moves along t = R90 n, with n from the sleeve to the wheel, N/m^2.5.
    pub stiffness_slope: f64,
    /// delta, m: above 0 where they touch, below 0 a gap.
    pub penetration: f64,
    /// d(delta)/dt, m/s: above 0 while they close.
    pub rate: f64,
}

/// What a law answers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Response {
    /// F_n, N: pushes the sleeve along -n.
    pub normal_force: f64,
    /// Stored energy, J.
    pub stored: f64,
    /// Force on the sleeve along t, at its centre, N; 0 for laws that are normal only.
    pub along_force: f64,
}

impl Law {
    /// Forces and energy of a pair, as the contact loops have them; all 0 across a gap.
    ///
    /// ```
    /// use pinwheel_contact::laws::{GapState, Law};
    ///
    /// let law = Law::from_values("constant", &[
    ///     ("constant_stiffness_n_m15", 1e8), ("damping_n_s_m", 8.0), ("ramp_m", 1e-5),
    /// ])?;
    /// let touch = GapState { stiffness: 0.0, stiffness_slope: 0.0, penetration: 4e-4, rate: 0.5 };
    /// // K delta^1.5 + C v = 1e8 * 8e-6 + 8 * 0.5
    /// assert!((law.respond(&touch).normal_force - 804.0).abs() < 1e-9);
    /// let gap = GapState { penetration: -1e-6, ..touch };
    /// assert_eq!(law.respond(&gap).normal_force, 0.0);
    /// # Ok::<(), pinwheel_contact::laws::LawError>(())
    /// ```
    #[must_use]
    pub fn respond(&self, state: &GapState) -> Response {
        let (stiffness, penetration) = (state.stiffness, state.penetration);
        if !(penetration > 0.0) {
            return Response::default();
        }
        Response {
            normal_force: self.force(stiffness, penetration, state.rate),
            stored: self.stored(stiffness, penetration),
            along_force: self
                .along(penetration)
                .map_or(0.0, |along| -state.stiffness_slope * along),
        }
    }
}
