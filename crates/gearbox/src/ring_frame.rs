//! Gears whose ring is the output, while the carrier is held: contacts as seen from the ring.
//!
//! ```text
//! from the ring:  x' = R(-P) x,  angle' = angle - P,  rate' = rate - P',     the carrier turns by -P
//! ```
//! P is the ring's angle. Contacts, bearings and damping depend on relative motion alone, so that the field of a gear with a fixed ring
//! gives them in that frame, and their loads are turned back. Inertia stays with the mechanism, which is in the frame of the ground: the
//! ring carries its pins, output pins stand in the ground, and the frame that accelerates has no part in it.

use pinwheel_mbs::{BodyState, Wrench};

use crate::Layout;

fn turned([x, y]: [f64; 2], [cos, sin]: [f64; 2]) -> [f64; 2] {
    [cos * x - sin * y, sin * x + cos * y]
}

/// Returns the state of a body in a frame that turns about the origin with the angle and rate of `frame`.
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

/// Writes the states of `bodies`, whose output is the ring, as seen from the ring, with the carrier as the output.
pub(crate) fn from_ring(bodies: &[BodyState], seen: &mut Vec<BodyState>) {
    let ring = bodies[Layout::OUTPUT];
    seen.clear();
    seen.extend(bodies.iter().map(|body| in_frame(body, &ring)));
    seen[Layout::OUTPUT] = in_frame(&BodyState::default(), &ring);
}

/// Returns the states in the ground's frame of bodies seen from the ring, where the carrier's angle is 0.
pub(crate) fn from_carrier(seen: &[BodyState]) -> Vec<BodyState> {
    let mut bodies = Vec::new();
    // Seen from the carrier, the ring turns back: the same turn of the frame.
    from_ring(seen, &mut bodies);
    bodies
}

/// Adds loads on bodies as seen from the ring to `loads` in the ground's frame; those on the carrier go to the ground.
pub(crate) fn add_to_ground(seen: &[Wrench], ring: &BodyState, loads: &mut [Wrench]) {
    let (sin, cos) = ring.angle.sin_cos();
    for (number, (load, own)) in loads.iter_mut().zip(seen).enumerate() {
        if number != Layout::OUTPUT {
            let [fx, fy] = turned([own.fx, own.fy], [cos, sin]);
            (load.fx, load.fy) = (load.fx + fx, load.fy + fy);
            load.moment += own.moment;
        }
    }
}
