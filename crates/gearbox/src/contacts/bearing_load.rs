//! Load of one elastic bearing.

use pinwheel_contact::Scalar;
use pinwheel_mbs::ContactEnergy;
use pinwheel_scene::bearings::BearingLaw;

/// Load and offset of one bearing at a state.
#[derive(Debug, Clone, Copy, Default)]
pub struct BearingLoad<S = f64> {
    /// Force on the disc at its centre, N, ground frame.
    pub on_wheel: [S; 2],
    /// Offset: the disc's centre less the eccentric's, m, ground frame.
    pub offset_m: [S; 2],
    /// Friction torque on the disc, N m.
    pub drag_n_m: S,
    /// Angular velocity of the disc relative to the eccentric, rad/s.
    pub(super) turning: S,
    /// Rate of the offset, m/s.
    pub(super) rate: S,
}

impl<S: Scalar> BearingLoad<S> {
    /// Computes the load at an offset (m) and its velocity (m/s).
    #[inline]
    pub(super) fn of(law: &BearingLaw, offset_m: [S; 2], [ux, uy]: [S; 2], turning: S) -> Self {
        let [dx, dy] = offset_m;
        let offset = (dx * dx + dy * dy).sqrt();
        let [nx, ny] = match offset.value() > 0.0 {
            true => [dx / offset, dy / offset],
            false => [dx.like(0.0); 2],
        };
        let rate = ux * nx + uy * ny;
        let force = law.force(offset, rate);
        Self {
            on_wheel: [-force * nx, -force * ny],
            offset_m,
            drag_n_m: law.drag(force, turning),
            turning,
            rate,
        }
    }
}

impl BearingLoad {
    /// Adds the stored energy and the dissipated powers of the bearing.
    pub(super) fn add_energy(&self, law: &BearingLaw, sum: &mut ContactEnergy) {
        let [dx, dy] = self.offset_m;
        let offset = dx.hypot(dy);
        sum.stored_j += law.stored(offset);
        let damped = law.force(offset, self.rate) - law.force(offset, 0.0);
        sum.damping_w += damped * self.rate;
        sum.bearing_friction_w -= self.drag_n_m * self.turning;
    }
}
