//! Pose, velocity and load of a planar rigid body.

/// Index into [`Mechanism::bodies`](crate::Mechanism::bodies).
pub type BodyId = usize;

/// Pose and velocity of a body's centre of mass in the ground frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BodyState {
    /// Position, m.
    pub x: f64,
    /// Position, m.
    pub y: f64,
    /// Angle, rad, counter-clockwise, not wrapped.
    pub angle: f64,
    /// Velocity, m/s.
    pub vx: f64,
    /// Velocity, m/s.
    pub vy: f64,
    /// Angular velocity, rad/s.
    pub rate: f64,
}

impl BodyState {
    /// Creates a state from position and angle, and their rates.
    #[inline]
    pub fn new([x, y, angle]: [f64; 3], [vx, vy, rate]: [f64; 3]) -> Self {
        Self {
            x,
            y,
            angle,
            vx,
            vy,
            rate,
        }
    }
}

/// Force at the centre of mass of a body and moment about it, in the ground frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// Force, N.
    pub fx: f64,
    /// Force, N.
    pub fy: f64,
    /// Moment, N m, counter-clockwise.
    pub moment: f64,
}

/// Energy of the contacts and their power losses; both losses are at least 0 for a dissipative law.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactEnergy {
    /// Stored energy, J.
    pub stored_j: f64,
    /// Power lost by damping, W: the normal force less that at rate 0, times the rate.
    pub damping_w: f64,
    /// Power lost by sliding in contacts, W.
    pub contact_friction_w: f64,
    /// Power lost by the friction of bearings, W.
    pub bearing_friction_w: f64,
    /// Power lost by sleeves on their pins, W.
    pub sleeve_friction_w: f64,
    /// Power lost by seals, W.
    pub seal_friction_w: f64,
}

impl ContactEnergy {
    /// Returns the power lost by all kinds of friction, W.
    pub fn friction_w(&self) -> f64 {
        self.by_cause_w().iter().sum()
    }

    /// Returns the powers lost by friction of contacts, bearings, pins and seals, W.
    #[inline]
    pub fn by_cause_w(&self) -> [f64; 4] {
        [
            self.contact_friction_w,
            self.bearing_friction_w,
            self.sleeve_friction_w,
            self.seal_friction_w,
        ]
    }
}

/// Adds the force (N, ground frame) at `point` (m) to the load of the first body of a pair, and its opposite to the other's.
#[inline]
pub fn add_pair(
    loads: &mut [Wrench],
    bodies: &[BodyState],
    pair: [BodyId; 2],
    point: [f64; 2],
    force: [f64; 2],
) {
    for (body, sign) in pair.into_iter().zip([1.0, -1.0]) {
        let (load, at) = (&mut loads[body], bodies[body]);
        let (fx, fy) = (sign * force[0], sign * force[1]);
        load.fx += fx;
        load.fy += fy;
        load.moment += (point[0] - at.x) * fy - (point[1] - at.y) * fx;
    }
}
