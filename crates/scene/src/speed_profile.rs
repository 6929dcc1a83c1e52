//! Speed of the input over time: its start and the changes of `drive.speed_changes`.
//!
//! ```text
//! omega(t) = before + (after - before) clamp((t - from)/ramp, 0, 1),    ramp > 0
//! ```
//! The speed never jumps, because that takes an infinite torque. The acceleration is constant within a ramp and jumps at
//! both ends, so no step passes over these ([`load_profile::breaks`](crate::load_profile::breaks)).

use pinwheel_mbs::Motion;

use crate::{Drive, Scene};

/// Returns the motions of the input in their order, the first from 0 on: for each change its ramp and the motion after it.
pub fn motions(drive: &Drive) -> Vec<Motion> {
    let mut all = vec![Motion {
        rate: drive.input_speed_rad_s,
        ..Motion::default()
    }];
    let mut before = drive.input_speed_rad_s;
    for change in &drive.speed_changes {
        let after = change.input_speed_rad_s;
        let acceleration = (after - before) / change.ramp_s;
        let pieces = [
            (change.time_s, before, acceleration),
            (change.time_s + change.ramp_s, after, 0.0),
        ];
        for (from_s, rate, acceleration) in pieces {
            let angle = all.last().map_or(0.0, |last| last.at(from_s).0);
            all.push(Motion {
                from_s,
                angle,
                rate,
                acceleration,
            });
        }
        before = after;
    }
    all
}

/// Returns the motion of the input at time `t` (s); at an end of a ramp the one that begins.
pub fn motion_at(drive: &Drive, t: f64) -> Motion {
    let motions = motions(drive);
    let begun = motions.iter().rfind(|motion| motion.from_s <= t);
    begun.copied().unwrap_or_default()
}

/// Returns the lead of the input's angle over a motion at its first speed at time `t` (s), rad; 0 without changes.
pub fn lead_rad(drive: &Drive, t: f64) -> f64 {
    motion_at(drive, t).at(t).0 - drive.input_speed_rad_s * t
}

/// Returns the speed of largest magnitude, rad/s: steps must resolve it, and designs are judged at it.
pub fn fastest_rad_s(drive: &Drive) -> f64 {
    let speeds = drive.speed_changes.iter().map(|c| c.input_speed_rad_s);
    speeds.fold(drive.input_speed_rad_s, |most, speed| {
        if speed.abs() > most.abs() {
            speed
        } else {
            most
        }
    })
}

/// Returns the speed at the end of a run of `scene`, rad/s.
pub fn final_rad_s(scene: &Scene) -> f64 {
    let end = scene.solver.duration_s;
    motion_at(&scene.drive, end).at(end).1
}
