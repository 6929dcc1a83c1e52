//! Tells numbers that ran away from numbers.
//!
//! A penalty model that blows up often stays finite: wheels jump teeth and the courses look like
//! data. In a gearbox that works, every wheel follows its ideal mesh within its free play and
//! some elastic twist, far below a pitch.

use pinwheel_mbs::BodyState;

use crate::Gearbox;
use crate::Layout;

/// Largest deviation from the ideal mesh, in pitches (2 pi/zs), beyond the free play.
const PITCHES: f64 = 0.25;

/// Checks one state.
///
/// # Errors
/// Which body left its mesh and by how much, or which state is not finite.
pub fn check(gearbox: &Gearbox, bodies: &[BodyState]) -> Result<(), String> {
    let geometry = &gearbox.geometry;
    let gear = &gearbox.scene.gear;
    let input = bodies[Layout::INPUT].angle;
    let pitch = std::f64::consts::TAU / geometry.ratio();
    // One-sided free play of a wheel, d sqrt(1 - m^2)/(e zs), and of the output in its holes.
    let m = gear.shortening;
    let wheel_play =
        gear.backlash_m * (1.0 - m * m).sqrt() / (gear.eccentricity_m * geometry.ratio());
    let clearance = gear.hole_radius_m - gear.internal_sleeve_radius_m - gear.eccentricity_m;
    let output_play = wheel_play + clearance.max(0.0) / gear.internal_circle_radius_m;
    let judge = |name: &dyn Fn() -> String, angle: f64, ideal: f64, play: f64| {
        let off = (angle - ideal).abs();
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
    };
    for (i, body) in gearbox.layout.wheel_bodies().enumerate() {
        let ideal = geometry.ideal_wheel_angle(i, input);
        judge(
            &|| format!("wheel {i}"),
            bodies[body].angle,
            ideal,
            wheel_play,
        )?;
    }
    let output = bodies[Layout::OUTPUT].angle;
    judge(
        &|| "the output shaft".into(),
        output,
        geometry.ideal_output_angle(input),
        output_play,
    )
}
