//! What is watched of a run, and the few exact numbers that stand for all of it.
//!
//! The *sketch* of a course a_i (all channels and samples) is `p_k = sum_i s_ki a_i`, k = 1..4, with fixed
//! signs s. For two runs, `mean_k (p_k - p'_k)^2` estimates the sum of all squared differences without bias
//! [Achlioptas 2003], so four numbers at full precision tell a rounding from a change anywhere in a course.

use pinwheel_courses::{Courses, EnergyAudit, columns};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Layout;

/// Numbers of a sketch.
pub const SKETCH: usize = 4;

/// A quantity that is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quantity {
    /// Key in files.
    pub key: &'static str,
    /// In words.
    pub label: &'static str,
    /// Unit of its values.
    pub unit: &'static str,
    /// Every how many samples a baseline keeps one; 0: the values are no course, all are kept.
    pub every: usize,
}

const fn quantity(
    key: &'static str,
    label: &'static str,
    unit: &'static str,
    every: usize,
) -> Quantity {
    Quantity {
        key,
        label,
        unit,
        every,
    }
}

/// All quantities, in the order of [`values`].
pub const QUANTITIES: [Quantity; 7] = [
    quantity("driver_torque", "driver torque", "N m", 5),
    quantity("output_torque", "output torque", "N m", 15),
    quantity(
        "output_twist",
        "output angle against the ideal ratio",
        "rad",
        15,
    ),
    quantity("external_force", "external sleeve forces", "N", 32),
    quantity("internal_force", "internal sleeve forces", "N", 32),
    quantity("energy", "energy account", "J", 0),
    quantity("joint_drift", "largest joint error", "m", 0),
];

/// The quantity called `key`.
#[must_use]
pub fn by_key(key: &str) -> Option<&'static Quantity> {
    QUANTITIES.iter().find(|quantity| quantity.key == key)
}

/// Channels of one quantity, each with all its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Which quantity.
    pub quantity: &'static Quantity,
    /// By channel and sample.
    pub channels: Vec<Vec<f64>>,
}

/// The quantities of a run that came to its end, with its whole account of energy and its joints' largest error, m; those that
/// the engine does not tell have no numbers.
#[must_use]
pub fn values(
    gearbox: &Gearbox,
    courses: &Courses,
    account: Option<EnergyAudit>,
    joint_drift_m: Option<f64>,
) -> Vec<Values> {
    QUANTITIES
        .iter()
        .map(|quantity| Values {
            quantity,
            channels: match quantity.key {
                "driver_torque" => vec![channel(courses, columns::INPUT_TORQUE)],
                "output_torque" => vec![channel(courses, columns::OUTPUT_TORQUE)],
                "output_twist" => vec![twist(gearbox, courses)],
                "external_force" => group(courses, columns::EXTERNAL_FORCE),
                "internal_force" => group(courses, columns::INTERNAL_FORCE),
                "energy" => vec![account.map_or_else(Vec::new, energies)],
                _ => vec![joint_drift_m.into_iter().collect()],
            },
        })
        .collect()
}

fn channel(courses: &Courses, name: &str) -> Vec<f64> {
    courses.channel(name).unwrap_or(&[]).to_vec()
}

fn group(courses: &Courses, prefix: &str) -> Vec<Vec<f64>> {
    courses
        .group(prefix)
        .into_iter()
        .map(<[f64]>::to_vec)
        .collect()
}

/// The output's angle less that of the ideal mesh: angles grow to radians, the twist is a milliradian.
fn twist(gearbox: &Gearbox, courses: &Courses) -> Vec<f64> {
    let motion = gearbox.input_motion();
    let start = gearbox.kinematic_states()[Layout::OUTPUT].angle;
    let angles = courses.channel(columns::OUTPUT_ANGLE).unwrap_or(&[]);
    let ideal = |t: f64| start + gearbox.geometry.ideal_output_angle(motion.at(t).0);
    courses
        .time_s()
        .iter()
        .zip(angles)
        .map(|(&t, angle)| angle - ideal(t))
        .collect()
}

/// Works of the driver and the load, changes of kinetic and stored energy, losses by damping and friction, J.
fn energies(a: EnergyAudit) -> Vec<f64> {
    vec![
        a.driver_j,
        a.load_j,
        a.kinetic_j,
        a.stored_j,
        a.damping_j,
        a.friction_j,
    ]
}

impl Values {
    /// All values, channel by channel.
    pub fn all(&self) -> impl Iterator<Item = f64> + '_ {
        self.channels.iter().flatten().copied()
    }

    /// Number of values.
    #[must_use]
    pub fn count(&self) -> usize {
        self.channels.iter().map(Vec::len).sum()
    }

    /// Values that a baseline keeps, by channel.
    #[must_use]
    pub fn kept(&self) -> Vec<Vec<f64>> {
        let every = self.quantity.every.max(1);
        self.channels
            .iter()
            .map(|c| c.iter().step_by(every).copied().collect())
            .collect()
    }

    /// Root mean square of all values.
    #[must_use]
    pub fn rms(&self) -> f64 {
        rms(self.all())
    }

    /// Mean of all values.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.all().sum::<f64>() / self.count().max(1) as f64
    }

    /// Largest magnitude.
    #[must_use]
    pub fn peak(&self) -> f64 {
        self.all().fold(0.0, |most: f64, x| {
            if x.abs() > most || x.is_nan() {
                x.abs()
            } else {
                most
            }
        })
    }

    /// See the module.
    #[must_use]
    pub fn sketch(&self) -> [f64; SKETCH] {
        let mut sums = [0.0; SKETCH];
        for (index, value) in self.all().enumerate() {
            let signs = mixed(index as u64);
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum += if signs >> k & 1 == 0 { value } else { -value };
            }
        }
        sums
    }

    /// Root mean square of the differences to `other`, which has the same shape.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        rms(self.all().zip(other.all()).map(|(a, b)| a - b))
    }
}

/// Root mean square; 0 for no values.
pub(super) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u32);
    for value in values {
        sum += value * value;
        count += 1;
    }
    (sum / f64::from(count.max(1))).sqrt()
}

/// Root mean square difference of two courses of `count` values, from their sketches.
#[must_use]
pub fn sketched_distance(a: &[f64; SKETCH], b: &[f64; SKETCH], count: usize) -> f64 {
    rms(a.iter().zip(b).map(|(a, b)| a - b)) / (count.max(1) as f64).sqrt()
}

/// Well-mixed bits of a number (the finaliser of SplitMix64 [Steele, Lea, Flood 2014]).
fn mixed(index: u64) -> u64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(values: Vec<f64>) -> Values {
        Values {
            quantity: &QUANTITIES[0],
            channels: vec![values],
        }
    }

    /// A change in any single place moves the sketch by exactly that much, so the estimate is exact there;
    /// spread changes are met within a factor of 3 (chi-squared with 4 degrees of freedom).
    #[test]
    fn sketches_estimate_distances() {
        let base: Vec<f64> = (0..500).map(|k| (f64::from(k) * 0.1).sin()).collect();
        let one = course(base.clone());
        let mut moved = base.clone();
        moved[137] += 1e-9;
        let two = course(moved);
        let estimate = sketched_distance(&one.sketch(), &two.sketch(), one.count());
        assert!((estimate / one.distance(&two) - 1.0).abs() < 1e-4);
        for seed in 1..50 {
            let noisy = base.iter().enumerate().map(|(k, x)| {
                let noise = mixed(k as u64 * 1000 + seed) as f64 / u64::MAX as f64 - 0.5;
                x + 1e-6 * noise
            });
            let two = course(noisy.collect());
            let ratio =
                sketched_distance(&one.sketch(), &two.sketch(), one.count()) / one.distance(&two);
            assert!((0.15..3.0).contains(&ratio), "{ratio}");
        }
    }
}
