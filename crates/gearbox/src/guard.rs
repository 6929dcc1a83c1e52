//! Guard that detects runs that diverged although every number is finite.
//!
//! A diverged penalty model often stays finite: discs jump teeth, and the time series look regular. In a working gearbox every
//! disc follows its ideal mesh within its free play and some elastic twist, far below a pitch.

use pinwheel_mbs::BodyState;

use crate::Gearbox;
use crate::Layout;
use crate::ring_frame::from_ring;

/// Largest deviation from the ideal mesh, in pitches (2 pi/zs), beyond the free play.
const PITCHES: f64 = 0.25;

/// Checks one state.
///
/// # Errors
/// A message with the body that left its mesh and its deviation, or with the state that is not finite.
#[inline]
pub fn check(gearbox: &Gearbox, bodies: &[BodyState]) -> Result<(), String> {
    let geometry = &gearbox.geometry;
    let [input, output] = [Layout::INPUT, Layout::OUTPUT].map(|body| bodies[body].angle);
    let mut relative = Vec::new();
    let bodies = match gearbox.scene.ring_turns() {
        false => bodies,
        true => {
            from_ring(bodies, &mut relative);
            &relative
        }
    };
    let pitch = pitch(gearbox);
    for (i, body) in gearbox.layout.wheel_bodies().enumerate() {
        let off = bodies[body].angle - geometry.ideal_wheel_angle(i, input);
        judge(pitch, off, geometry.wheel_play_rad, || format!("disc {i}"))?;
    }
    check_output(gearbox, input, output)
}

/// Checks the angle of the output shaft alone, at the input angle `input`, rad.
///
/// # Errors
/// A message with the deviation from the mesh, or that the angle is not finite.
pub fn check_output(gearbox: &Gearbox, input: f64, output: f64) -> Result<(), String> {
    let geometry = &gearbox.geometry;
    let play = geometry.wheel_play_rad + geometry.hole_play_rad;
    let off = output - geometry.ideal_turn_of_output(input);
    judge(pitch(gearbox), off, play, || "the output shaft".into())
}

/// Returns the angle from one lobe to the next, rad.
fn pitch(gearbox: &Gearbox) -> f64 {
    std::f64::consts::TAU / gearbox.geometry.lobes()
}

#[inline]
fn judge(pitch: f64, off: f64, play: f64, name: impl Fn() -> String) -> Result<(), String> {
    let off = off.abs();
    if off <= play + PITCHES * pitch {
        return Ok(());
    }
    Err(if off.is_finite() {
        format!(
            "{} is {off:.3} rad off its ideal mesh (a pitch is {pitch:.3} rad)",
            name()
        )
    } else {
        format!("the angle of {} is not finite", name())
    })
}
