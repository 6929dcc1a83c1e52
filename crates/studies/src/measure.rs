//! How far one run's courses lie from another's, and how high they are.

use pinwheel_courses::{Courses, columns};
use serde::{Deserialize, Serialize};

/// Relative L2 differences.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// All sleeve forces together.
    pub forces: f64,
    /// The driver's torque.
    pub driver_torque: f64,
}

/// Sizes of a run's courses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Largest sleeve force, N.
    pub peak_force_n: f64,
    /// Mean of the driver's torque, N m.
    pub mean_torque_n_m: f64,
    /// Root mean square of the driver's torque, N m.
    pub rms_torque_n_m: f64,
}

const FORCES: [&str; 2] = [columns::EXTERNAL_FORCE, columns::INTERNAL_FORCE];
const TORQUE: &str = columns::INPUT_TORQUE;

/// `||a - b|| / ||b||` over the samples both have; `b` is the reference. Both start at 0 and share the
/// sampling step. 1 where `b` is nothing and `a` is not.
#[must_use]
pub fn difference(a: &Courses, b: &Courses) -> Difference {
    let mut forces = (0.0, 0.0);
    for prefix in FORCES {
        for (x, y) in a.group(prefix).iter().zip(b.group(prefix)) {
            add(&mut forces, x, y);
        }
    }
    let mut torque = (0.0, 0.0);
    if let (Some(x), Some(y)) = (a.channel(TORQUE), b.channel(TORQUE)) {
        add(&mut torque, x, y);
    }
    let root = |(error, size): (f64, f64)| {
        if error == 0.0 {
            return 0.0;
        }
        // Against nothing, something is wholly wrong.
        if size == 0.0 {
            return 1.0;
        }
        (error / size).sqrt()
    };
    Difference {
        forces: root(forces),
        driver_torque: root(torque),
    }
}

fn add(sum: &mut (f64, f64), a: &[f64], b: &[f64]) {
    for (x, y) in a.iter().zip(b) {
        sum.0 += (x - y) * (x - y);
        sum.1 += y * y;
    }
}

/// Sizes over the whole run.
#[must_use]
pub fn level(courses: &Courses) -> Level {
    let forces = FORCES.iter().flat_map(|prefix| courses.group(prefix));
    let peak_force_n = forces.flatten().fold(0.0, |most: f64, &x| most.max(x));
    let torque = courses.channel(TORQUE).unwrap_or(&[]);
    let n = torque.len().max(1) as f64;
    Level {
        peak_force_n,
        mean_torque_n_m: torque.iter().sum::<f64>() / n,
        rms_torque_n_m: (torque.iter().map(|x| x * x).sum::<f64>() / n).sqrt(),
    }
}
