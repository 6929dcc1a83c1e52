//! How far one run's courses lie from another's, measured by what the scene itself calls small.

use pinwheel_courses::Courses;
use serde::{Deserialize, Serialize};

use crate::Gearbox;

const FORCES: [&str; 2] = ["external_sleeve_force_n", "internal_sleeve_force_n"];
const TORQUE: &str = "input_torque_n_m";

/// Relative L2 distances.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Distance {
    /// All sleeve forces together.
    pub forces: f64,
    /// The driver's torque.
    pub driver_torque: f64,
}

impl Distance {
    /// The larger of the two; NaN if either is.
    #[must_use]
    pub fn worst(&self) -> f64 {
        if self.forces.is_nan() || self.driver_torque.is_nan() {
            return f64::NAN;
        }
        self.forces.max(self.driver_torque)
    }

    /// Both, `factor` times.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self {
            forces: factor * self.forces,
            driver_torque: factor * self.driver_torque,
        }
    }

    /// Both, and `least` where they are less.
    #[must_use]
    pub fn at_least(&self, least: f64) -> Self {
        Self {
            forces: self.forces.max(least),
            driver_torque: self.driver_torque.max(least),
        }
    }

    /// `||a - b|| / ||b||` over the samples both have; `b` is the reference. Both start at 0; where `a` is sampled less often
    /// its times are among those of `b`.
    ///
    /// Where `b` is next to nothing it is measured by the gear's least force instead, and the torque by that force on the
    /// eccentric ([`Gearbox::least_force_n`]).
    #[must_use]
    pub fn between(gearbox: &Gearbox, a: &Courses, b: &Courses) -> Self {
        let least = gearbox.least_force_n();
        let places = common(a.time_s(), b.time_s());
        let seen;
        let b = if places.iter().enumerate().all(|(i, &place)| i == place) {
            b
        } else {
            seen = b.select(&places);
            &seen
        };
        let mut forces = Sums::default();
        for prefix in FORCES {
            for (x, y) in a.group(prefix).iter().zip(b.group(prefix)) {
                forces.add(x, y);
            }
        }
        let mut torque = Sums::default();
        if let (Some(x), Some(y)) = (a.channel(TORQUE), b.channel(TORQUE)) {
            torque.add(x, y);
        }
        let samples = a.len().min(b.len()) as f64;
        Self {
            forces: forces.relative(least * least * samples),
            driver_torque: torque
                .relative((least * gearbox.scene.gear.eccentricity_m).powi(2) * samples),
        }
    }
}

/// Places in `b` of the times of `a`, as far as there are.
fn common(a: &[f64], b: &[f64]) -> Vec<usize> {
    // Times are products of decimal numbers, and may have been written to a file.
    let same = 1e-3
        * b.first_chunk()
            .map_or(0.0, |[first, second]| second - first);
    let mut rest = b.iter().enumerate().peekable();
    let place = |t: &f64| {
        while rest.next_if(|(_, at)| **at < t - same).is_some() {}
        rest.next().map(|(k, _)| k)
    };
    a.iter().map_while(place).collect()
}

/// Sums of squares.
#[derive(Default)]
struct Sums {
    error: f64,
    size: f64,
}

impl Sums {
    fn add(&mut self, a: &[f64], b: &[f64]) {
        for (x, y) in a.iter().zip(b) {
            self.error += (x - y) * (x - y);
            self.size += y * y;
        }
    }

    fn relative(&self, least: f64) -> f64 {
        (self.error / self.size.max(least)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A distance that is not a number is no small one.
    #[test]
    fn the_worst_of_two_distances() {
        let of = |forces: f64, driver_torque: f64| Distance {
            forces,
            driver_torque,
        };
        assert_eq!((of(1.0, 2.0).worst(), of(2.0, 1.0).worst()), (2.0, 2.0));
        assert!(of(f64::NAN, 1.0).worst().is_nan() && of(1.0, f64::NAN).worst().is_nan());
        assert_eq!(of(2.0, 4.0).times(0.5), of(1.0, 2.0));
        assert_eq!(of(2.0, 4.0).at_least(3.0), of(3.0, 4.0));
    }

    /// A force and a torque that are linear in time.
    fn courses(times: &[f64], force: f64, torque: f64) -> Courses {
        let mut courses = Courses::new(times.to_vec()).unwrap();
        let values = |slope: f64| times.iter().map(|t| slope * t).collect();
        courses.push(TORQUE, values(torque)).unwrap();
        courses
            .push("external_sleeve_force_n_0", values(force))
            .unwrap();
        courses
    }

    /// Beside nothing the gear's least force counts, and that force on the eccentric.
    #[test]
    fn what_is_nothing_is_measured_by_the_least_force() {
        let scene = pinwheel_scene::Scene::load("paper", &[]).unwrap();
        let gearbox = Gearbox::new(&scene).unwrap();
        let (least, e) = (gearbox.least_force_n(), 0.0028);
        assert_eq!(scene.gear.eccentricity_m, e);
        let times = [0.0, 3.0, 4.0];
        let nothing = courses(&times, 0.0, 0.0);
        let off = Distance::between(&gearbox, &courses(&times, least, least * e), &nothing);
        // sqrt((3^2 + 4^2)/3 samples)
        let expected = (25.0_f64 / 3.0).sqrt();
        for found in [off.forces, off.driver_torque] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{off:?}");
        }
    }

    /// What is sampled less often, or written with rounding, is compared at its own times.
    #[test]
    fn samples_are_compared_at_their_times() {
        let gearbox = Gearbox::new(&pinwheel_scene::Scene::load("paper", &[]).unwrap()).unwrap();
        let fine = courses(&[0.0, 1.0, 2.0, 3.0, 4.0], 100.0, 10.0);
        for coarse in [[0.0, 2.0, 4.0], [0.0, 2.0 + 1e-9, 4.0 - 1e-9]] {
            let off = Distance::between(&gearbox, &courses(&coarse, 110.0, 10.0), &fine);
            assert!((off.forces - 0.1).abs() < 1e-8, "{off:?}");
            assert!(off.driver_torque < 1e-8, "{off:?}");
        }
        assert_eq!(common(&[0.0, 2.0, 5.0], &[0.0, 1.0, 2.0, 3.0]), [0, 2]);
        assert_eq!(common(&[0.0, 1.002], &[0.0, 1.0, 2.0]), [0, 2]);
    }
}
