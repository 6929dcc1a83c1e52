//! Gears with the ring as output and a fixed carrier: contacts in the frame of the ring.
//!
//! ```text
//! from the ring:  x' = R(-P) x,  angle' = angle - P,  rate' = rate - P',     the carrier turns by -P
//! ```
//! P is the ring's angle. Contacts, bearings and damping depend only on relative motion. The field of a gear with a fixed ring
//! therefore gives their loads in the ring's frame, and these are rotated back. Inertia stays with the mechanism in the ground
//! frame: the ring carries its pins, output pins are fixed to the ground, and the acceleration of the ring's frame has no
//! effect.

use pinwheel_mbs::{BodyState, Wrench};

use crate::Layout;
use crate::contacts::pair::PairContact;

/// Frame of a ring that is the output, with states and loads relative to it.
#[derive(Debug, Clone, Default)]
pub(crate) struct RingFrame {
    pub(crate) local: Vec<BodyState>,
    pub(crate) own: Vec<Wrench>,
}

fn turned([x, y]: [f64; 2], [cos, sin]: [f64; 2]) -> [f64; 2] {
    [cos * x - sin * y, sin * x + cos * y]
}

/// Returns the state of a body in a frame that rotates about the origin with the angle and rate of `frame`.
fn in_frame(body: &BodyState, frame: &BodyState) -> BodyState {
    let (sin, cos) = frame.angle.sin_cos();
    let velocity = [body.vx + frame.rate * body.y, body.vy - frame.rate * body.x];
    let [place, velocity] = [[body.x, body.y], velocity].map(|v| turned(v, [cos, -sin]));
    let [angle, rate] = [body.angle - frame.angle, body.rate - frame.rate];
    BodyState::new(
        [place[0], place[1], angle],
        [velocity[0], velocity[1], rate],
    )
}

/// Writes the states of `bodies`, whose output is the ring, relative to the ring, with the carrier as the output.
pub(crate) fn from_ring(bodies: &[BodyState], local: &mut Vec<BodyState>) {
    let ring = bodies[Layout::OUTPUT];
    local.clear();
    local.extend(bodies.iter().map(|body| in_frame(body, &ring)));
    local[Layout::OUTPUT] = in_frame(&BodyState::default(), &ring);
}

/// Returns the states in the ground frame of bodies given relative to the ring, with a carrier angle of 0.
pub(crate) fn from_carrier(local: &[BodyState]) -> Vec<BodyState> {
    let mut bodies = Vec::new();
    // Relative to the carrier the ring rotates backwards, so the transformation is the same.
    from_ring(local, &mut bodies);
    bodies
}

impl RingFrame {
    /// Adds the loads of the frame to `loads` in the ground frame. Those on the carrier act on the ground. The ring takes the moment
    /// that balances all others: couples of pins that it holds.
    pub(crate) fn add_to_ground(&self, ring: &BodyState, loads: &mut [Wrench]) {
        let (sin, cos) = ring.angle.sin_cos();
        for (number, (load, own)) in loads.iter_mut().zip(&self.own).enumerate() {
            if number != Layout::OUTPUT {
                let [fx, fy] = turned([own.fx, own.fy], [cos, sin]);
                (load.fx, load.fy) = (load.fx + fx, load.fy + fy);
                load.moment += own.moment;
            }
        }
        let all = self.local.iter().zip(&self.own);
        let others: f64 = all
            .map(|(at, own)| at.x * own.fy - at.y * own.fx + own.moment)
            .sum();
        loads[Layout::OUTPUT].moment -= others;
    }
}

/// Returns the states with the held carrier in place of a ring that is the output, for the bearings on its cranks.
pub(crate) fn with_carrier(bodies: &[BodyState]) -> Vec<BodyState> {
    let mut held = bodies.to_vec();
    held[Layout::OUTPUT] = BodyState::default();
    held
}

/// Returns a pair in the frame of the ring as one in the ground frame.
pub(crate) fn pair_to_ground(pair: &PairContact, ring: &BodyState) -> PairContact {
    let (sin, cos) = ring.angle.sin_cos();
    let [point, normal, centre] =
        [pair.point, pair.normal, pair.centre].map(|v| turned(v, [cos, sin]));
    PairContact {
        point,
        normal,
        centre,
        ..*pair
    }
}
