//! How far one run's courses lie from another's, in the two numbers the stability study uses.

use pinwheel_courses::Courses;
use serde::Serialize;

/// Relative L2 differences.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    /// All sleeve forces together.
    pub forces: f64,
    /// The driver's torque.
    pub driver_torque: f64,
}

/// Groups of courses that are forces.
const FORCES: [&str; 2] = ["external_sleeve_force_n_", "internal_sleeve_force_n_"];

/// `||a - b|| / ||b||` over the samples both have; `b` is the reference. Both start at 0 and share
/// the sampling step.
#[must_use]
pub fn difference(a: &Courses, b: &Courses) -> Difference {
    let mut forces = (0.0, 0.0);
    for channel in b.channels() {
        if FORCES.iter().any(|prefix| channel.name.starts_with(prefix)) {
            add(&mut forces, a.channel(&channel.name), &channel.values);
        }
    }
    let mut torque = (0.0, 0.0);
    let name = "input_torque_n_m";
    add(&mut torque, a.channel(name), b.channel(name).unwrap_or(&[]));
    let root = |(error, size): (f64, f64)| (error / size).sqrt();
    Difference {
        forces: root(forces),
        driver_torque: root(torque),
    }
}

fn add(sum: &mut (f64, f64), a: Option<&[f64]>, b: &[f64]) {
    for (x, y) in a.unwrap_or(&[]).iter().zip(b) {
        sum.0 += (x - y) * (x - y);
        sum.1 += y * y;
    }
}
