//! The energy account of a run: where every joule of the driver went.
//!
//! ```text
//! kinetic + stored, end - start  =  work of driver + work of load - lost by damping - lost by sliding + remainder
//! ```
//! Stored energy is the integral of the force at rest over the penetration, at the stiffness of that place.
//! For a law with a potential the remainder is the error of the run; for the paper's law, whose stiffness
//! varies along the profile while the force is normal only, it is the energy the law creates (about 0.95 %).
//!
//! Works are integrals of powers over equally spaced states of the run by the rule that is exact for cubics
//! (each interval from the cubic through its neighbours), so they converge with order 4 and the state
//! itself brings the integrator's order. States are at most [`STEPS`] steps apart, whatever is sampled.
//! Where the load jumps its power does: there are two states at that time, one with each load, and no interval's
//! cubic reaches over it.

use pinwheel_mbs::{Mechanism, Observation};
use serde::{Deserialize, Serialize};

use crate::contacts::ContactEnergy;
use crate::layout::Layout;

/// Steps between two entries at most: 1e-4 s at the paper's step is 8 entries a period of its fastest
/// oscillation (1.2 kHz), and costs a few per cent of the run.
const STEPS: f64 = 10.0;

/// Intervals that differ by no more than this share are equal: sample times are products and sums of decimal numbers.
const EQUAL: f64 = 1e-9;

/// Powers and energies over a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EnergyAccount {
    time: Vec<f64>,
    /// driver, load, damping, sliding, W.
    powers: [Vec<f64>; 4],
    /// kinetic, stored, J.
    energies: [Vec<f64>; 2],
    masses: Vec<(f64, f64)>,
    /// First entries of the legs after the first one.
    legs: Vec<usize>,
}

/// The account between two times.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EnergyAudit {
    /// Start, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Work of the driver on the input shaft, J.
    pub driver_j: f64,
    /// Work of the load on the output shaft, J; negative when the gear drives the load.
    pub load_j: f64,
    /// Growth of kinetic energy, J.
    pub kinetic_j: f64,
    /// Growth of the energy stored in contacts, J.
    pub stored_j: f64,
    /// Lost by contact damping, J.
    pub damping_j: f64,
    /// Lost by sliding, J.
    pub friction_j: f64,
    /// What is left over, J: positive when energy appeared that nothing accounts for.
    pub remainder_j: f64,
    /// The remainder as a share of the larger of the two works.
    pub remainder_share: f64,
}

impl EnergyAccount {
    /// An empty account of a mechanism.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        let masses = mechanism.bodies.iter().map(|b| (b.mass, b.moment));
        Self {
            masses: masses.collect(),
            ..Self::default()
        }
    }

    /// Times between two samples at which entries are due, both ends excluded.
    /// `least`: intervals that they make at least.
    pub(crate) fn between(from: f64, to: f64, step: f64, least: u64) -> impl Iterator<Item = f64> {
        let parts = ((to - from) / (STEPS * step) - 1e-6).ceil();
        let parts = parts.max(least as f64);
        (1..parts as u64).map(move |k| from + (to - from) * k as f64 / parts)
    }

    /// The next entry is the first of a leg, at the time of the last one.
    pub(crate) fn enter_leg(&mut self) {
        self.legs.push(self.time.len());
    }

    /// Adds an entry. `load`: N m on the output shaft; `contacts`: of the state seen.
    pub(crate) fn add(&mut self, load: f64, seen: &Observation<'_>, contacts: ContactEnergy) {
        let driver = seen.driver_torques.first().copied().unwrap_or(0.0);
        let values = [
            driver * seen.bodies[Layout::INPUT].rate,
            load * seen.bodies[Layout::OUTPUT].rate,
            contacts.damping_w,
            contacts.friction_w,
        ];
        let kinetic = self
            .masses
            .iter()
            .zip(seen.bodies)
            .map(|(&(mass, moment), b)| {
                0.5 * (mass * (b.vx * b.vx + b.vy * b.vy) + moment * b.rate * b.rate)
            });
        self.energies[0].push(kinetic.sum());
        self.energies[1].push(contacts.stored_j);
        self.time.push(seen.time);
        for (list, value) in self.powers.iter_mut().zip(values) {
            list.push(value);
        }
    }

    /// The account between the entries nearest to `from` and `to`, s. `None` with fewer than two entries there.
    #[must_use]
    pub fn audit(&self, from: f64, to: f64) -> Option<EnergyAudit> {
        let nearest = |t: f64| {
            let k = self.time.partition_point(|&x| x < t);
            match (k.checked_sub(1), self.time.get(k)) {
                (Some(low), Some(&high)) if t - self.time[low] < high - t => low,
                (Some(low), None) => low,
                _ => k,
            }
        };
        let (a, b) = (nearest(from), nearest(to));
        if a >= b {
            return None;
        }
        let [driver_j, load_j, damping_j, friction_j] =
            [0, 1, 2, 3].map(|k| self.integral(&self.powers[k], a, b));
        let [kinetic_j, stored_j] = [0, 1].map(|k| self.energies[k][b] - self.energies[k][a]);
        let remainder_j = kinetic_j + stored_j + damping_j + friction_j - driver_j - load_j;
        Some(EnergyAudit {
            from_s: self.time[a],
            to_s: self.time[b],
            driver_j,
            load_j,
            kinetic_j,
            stored_j,
            damping_j,
            friction_j,
            remainder_j,
            remainder_share: remainder_j / driver_j.abs().max(load_j.abs()),
        })
    }

    /// Integral of `values` from entry `a` to entry `b`, leg by leg.
    fn integral(&self, values: &[f64], a: usize, b: usize) -> f64 {
        let starts = std::iter::once(0).chain(self.legs.iter().copied());
        let ends = self.legs.iter().copied().chain([self.time.len()]);
        starts
            .zip(ends)
            .map(|(start, end)| {
                let last = end.saturating_sub(1);
                let (from, to) = (
                    a.clamp(start, last.max(start)),
                    b.clamp(start, last.max(start)),
                );
                integral(
                    &self.time[start..end],
                    &values[start..end],
                    from - start,
                    to - start,
                )
            })
            .sum()
    }

    /// The account of the whole run.
    #[must_use]
    pub fn total(&self) -> Option<EnergyAudit> {
        self.audit(f64::NEG_INFINITY, f64::INFINITY)
    }
}

/// Integral of the values from entry `a` to entry `b`, each interval from the cubic through four entries.
fn integral(time: &[f64], values: &[f64], a: usize, b: usize) -> f64 {
    (a..b).map(|k| interval(time, values, k)).sum()
}

/// Integral over [t_k, t_k+1] of the polynomial through up to four entries around it, by Gauss' three points.
fn interval(time: &[f64], values: &[f64], k: usize) -> f64 {
    let from = k.saturating_sub(1).min(time.len().saturating_sub(4));
    let to = (from + 4).min(time.len());
    let (low, h) = (time[k], time[k + 1] - time[k]);
    let even = |pair: &[f64]| (pair[1] - pair[0] - h).abs() < EQUAL * h;
    if to - from == 4 && time[from..to].windows(2).all(even) {
        // The same integral for equal intervals, which nearly all are.
        let weights: [f64; 4] = match k - from {
            0 => [9.0, 19.0, -5.0, 1.0],
            1 => [-1.0, 13.0, 13.0, -1.0],
            _ => [1.0, -5.0, 19.0, 9.0],
        };
        let sum: f64 = weights
            .iter()
            .zip(&values[from..to])
            .map(|(w, v)| w * v)
            .sum();
        return h * sum / 24.0;
    }
    let at = |t: f64| -> f64 {
        (from..to)
            .map(|i| {
                let others = (from..to).filter(|&j| j != i);
                let weight: f64 = others
                    .map(|j| (t - time[j]) / (time[i] - time[j]))
                    .product();
                weight * values[i]
            })
            .sum()
    };
    let x = 0.5 * 0.6_f64.sqrt();
    h * (5.0 * at(low + h * (0.5 - x)) + 8.0 * at(low + 0.5 * h) + 5.0 * at(low + h * (0.5 + x)))
        / 18.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exact for cubics, also on unequal entries, and of order 4 otherwise.
    #[test]
    fn quadrature_has_its_order() {
        let time: Vec<f64> = [0.0, 0.1, 0.25, 0.3, 0.5, 0.6].to_vec();
        let values: Vec<f64> = time
            .iter()
            .map(|t| 1.0 + t * (2.0 - t * (3.0 - 4.0 * t)))
            .collect();
        let exact = |t: f64| t + t * t - t * t * t + t.powi(4);
        assert!((integral(&time, &values, 0, 5) - exact(0.6)).abs() < 1e-15);
        assert!((integral(&time, &values, 2, 4) - exact(0.5) + exact(0.25)).abs() < 1e-15);
        let error = |n: usize| {
            let time: Vec<f64> = (0..=n).map(|k| k as f64 / n as f64).collect();
            let values: Vec<f64> = time.iter().map(|t| (7.0 * t).sin()).collect();
            (integral(&time, &values, 0, n) - (1.0 - 7.0_f64.cos()) / 7.0).abs()
        };
        let order = (error(40) / error(80)).log2();
        assert!(order > 3.7, "{order}");
    }

    #[test]
    fn entries_are_never_far_apart() {
        assert_eq!(EnergyAccount::between(0.0, 1e-4, 1e-5, 1).count(), 0);
        let times: Vec<f64> = EnergyAccount::between(0.0, 1e-3, 1e-5, 1).collect();
        assert_eq!(times.len(), 9);
        assert!((times[4] - 5e-4).abs() < 1e-18);
        assert_eq!(EnergyAccount::between(0.0, 1e-6, 1e-5, 1).count(), 0);
    }

    /// A power that jumps: each side's own cubic, nothing from over the jump.
    #[test]
    fn no_interval_reaches_over_a_jump() {
        let mut account = EnergyAccount::default();
        let mut powers = Vec::new();
        let mut leg = |times: &[f64], power: &dyn Fn(f64) -> f64| {
            for &t in times {
                account.time.push(t);
                powers.push(power(t));
            }
            account.legs.push(account.time.len());
        };
        leg(&[0.0, 0.1, 0.2, 0.3], &|t| t * t * t);
        leg(&[0.3, 0.35, 0.45, 0.5, 0.7], &|t| 5.0 - t);
        account.legs.pop();
        let whole = account.integral(&powers, 0, 8);
        let exact = 0.3_f64.powi(4) / 4.0 + 5.0 * 0.4 - 0.5 * (0.49 - 0.09);
        assert!((whole - exact).abs() < 1e-15, "{whole} {exact}");
        let part = account.integral(&powers, 2, 6);
        let exact = (0.3_f64.powi(4) - 0.2_f64.powi(4)) / 4.0 + 5.0 * 0.15 - 0.5 * (0.2025 - 0.09);
        assert!((part - exact).abs() < 1e-15, "{part} {exact}");
        assert_eq!(account.integral(&powers, 3, 4), 0.0);
    }

    #[test]
    fn too_little_is_no_account() {
        assert_eq!(EnergyAccount::default().total(), None);
    }
}
