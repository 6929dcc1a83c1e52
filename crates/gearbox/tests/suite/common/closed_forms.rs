//! Closed forms of the loaded mesh, for verification of the solver.
//!
//! A rigid disc without backlash on equal linear springs distributes its torque by the levers of the contact normals:
//!
//! ```text
//! l_i = e zs sin(phi_i)/sqrt(1 + m^2 - 2 m cos(phi_i)),    F_i = T l_i/sum of l_k^2 over the loaded pins (l_k > 0)
//! ```
//! phi_i is the angle of pin i from the line through the centres of gear and disc. Sources: M. Lehmann,
//! Berechnung und Messung der Kraefte in einem Zykloiden-Kurvenscheiben-Getriebe, thesis, TU Muenchen 1976;
//! J. Malhotra, M. A. Parameswaran, Mech. Mach. Theory 18 (1983) 491-499.

use std::f64::consts::TAU;

use pinwheel_scene::Gear;

/// Disc at zero clearance on linear springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LinearMesh {
    /// Eccentricity e, m.
    pub eccentricity: f64,
    /// Number zk of ring pins.
    pub sleeves: usize,
    /// Shortening m of the profile, dimensionless.
    pub shortening: f64,
}

impl LinearMesh {
    /// Returns the mesh of a gear.
    pub(crate) fn of(gear: &Gear) -> Self {
        Self {
            eccentricity: gear.eccentricity_m,
            sleeves: gear.external_sleeves,
            shortening: gear.shortening,
        }
    }

    /// Returns the lever of the normal at the pin at `angle` from the eccentric, about the disc's centre, m.
    pub(crate) fn lever(&self, angle: f64) -> f64 {
        let (m, zs) = (self.shortening, self.sleeves as f64 - 1.0);
        self.eccentricity * zs * angle.sin() / (1.0 + m * m - 2.0 * m * angle.cos()).sqrt()
    }

    /// Returns the forces on all pins, N, for `torque` (N m) on the disc, with the first pin at `first` rad from the eccentric.
    /// Pins that could only pull have 0.
    pub(crate) fn forces(&self, first: f64, torque: f64) -> Vec<f64> {
        let angle = |k| first + TAU * k as f64 / self.sleeves as f64;
        shared((0..self.sleeves).map(|k| self.lever(angle(k))), torque)
    }

    /// Returns the force of all pins on the disc, N: along the eccentric (away from the gear's centre), and across it.
    ///
    /// Every normal passes through the pitch point, e zk from the gear's centre, so the part across is T/(e zs) exactly.
    pub(crate) fn bearing(&self, first: f64, torque: f64) -> [f64; 2] {
        let m = self.shortening;
        let mut sum = [0.0; 2];
        for (k, force) in self.forces(first, torque).into_iter().enumerate() {
            let angle = first + TAU * k as f64 / self.sleeves as f64;
            let (s, c) = angle.sin_cos();
            let scale = force / (1.0 + m * m - 2.0 * m * c).sqrt();
            sum[0] += scale * (m - c);
            sum[1] += scale * s;
        }
        sum
    }

    /// Returns the least and the largest, over `positions` poses of one pitch, of the largest pin force, N.
    pub(crate) fn peak(&self, torque: f64, positions: usize) -> (f64, f64) {
        let pitch = TAU / self.sleeves as f64;
        (0..positions)
            .map(|k| {
                let forces = self.forces(pitch * k as f64 / positions as f64, torque);
                forces.into_iter().fold(0.0, f64::max)
            })
            .fold((f64::INFINITY, 0.0), |(low, high), f| {
                (low.min(f), high.max(f))
            })
    }
}

/// Disc on its output pins, at zero clearance on linear springs.
///
/// Relative to the output shaft a disc moves on a circle of radius e without rotation, so all normals are parallel to the
/// eccentric and `l_k = rw sin(beta_k)`, beta_k the angle of pin k from the eccentric. The pins share the torque like the ring
/// pins and on the same side: output pins press a disc inward, ring pins towards the gear's centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LinearOutput {
    /// Radius rw of the circle of output pins, m.
    pub circle_radius: f64,
    /// Number zi of output pins.
    pub sleeves: usize,
}

impl LinearOutput {
    /// Returns the output stage of a gear.
    pub(crate) fn of(gear: &Gear) -> Self {
        Self {
            circle_radius: gear.internal_circle_radius_m,
            sleeves: gear.internal_sleeves,
        }
    }

    /// Returns the forces on all pins, N, for `torque` (N m) on the disc, with the first pin at `first` rad from the eccentric.
    /// Pins that could only pull have 0.
    pub(crate) fn forces(&self, first: f64, torque: f64) -> Vec<f64> {
        let lever = |k| (first + TAU * k as f64 / self.sleeves as f64).sin();
        shared(
            (0..self.sleeves).map(|k| self.circle_radius * lever(k)),
            torque,
        )
    }
}

/// Distributes the torque among the pins with positive levers.
fn shared(levers: impl Iterator<Item = f64>, torque: f64) -> Vec<f64> {
    let levers: Vec<f64> = levers.map(|l| l.max(0.0)).collect();
    let sum: f64 = levers.iter().map(|l| l * l).sum();
    levers.iter().map(|l| torque * l / sum).collect()
}

/// Returns the smallest convex radius of C, R sqrt(27 (1 - m^2)(zk - 1)/(zk + 1)^3), m, if it is between lobe and pit.
pub(crate) fn smallest_convex_radius(gear: &Gear) -> f64 {
    let (m, zk) = (gear.shortening, gear.external_sleeves as f64);
    gear.pitch_radius_m() * (27.0 * (1.0 - m * m) * (zk - 1.0) / (zk + 1.0).powi(3)).sqrt()
}
