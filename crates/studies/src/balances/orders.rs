//! Harmonics of quantities that repeat with the mesh.

use serde::Serialize;

use super::poses::Poses;
use crate::fourier::moduli;

/// Number of stored harmonics.
const KEPT: usize = 12;
/// Share of the largest harmonic below which a harmonic is rounding.
const LEAST: f64 = 1e-6;

/// Harmonic of an angle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Harmonic {
    /// Cycles per turn of the input.
    pub input_order: f64,
    /// Cycles per turn of the output.
    pub output_order: f64,
    /// Amplitude, half of its peak to peak, arcmin.
    pub amplitude_arcmin: f64,
    /// Source of the harmonic: `external mesh`, `internal mesh`, a multiple of both, or neither.
    pub of: &'static str,
}

/// Harmonic of a force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceHarmonic {
    /// Cycles per turn of the input.
    pub input_order: f64,
    /// Cycles per turn of the output.
    pub output_order: f64,
    /// Amplitude, half of its peak to peak, N.
    pub amplitude_n: f64,
    /// Source of the harmonic, as for [`Harmonic`].
    pub of: &'static str,
}

/// Returns the largest harmonics of a force (N) over one period, largest first.
pub(crate) fn of_force(force_n: &[f64], poses: &Poses) -> Vec<ForceHarmonic> {
    largest(
        force_n,
        poses,
        |[input_order, output_order], amplitude_n, of| ForceHarmonic {
            input_order,
            output_order,
            amplitude_n,
            of,
        },
    )
}

/// Returns the largest harmonics of an angle (arcmin) over one period, largest first.
pub(crate) fn of_angle(angle_arcmin: &[f64], poses: &Poses) -> Vec<Harmonic> {
    largest(
        angle_arcmin,
        poses,
        |[input_order, output_order], amplitude_arcmin, of| Harmonic {
            input_order,
            output_order,
            amplitude_arcmin,
            of,
        },
    )
}

/// Returns the largest harmonics over one period from their orders, amplitude and source; empty if too few poses would
/// alias the harmonics of the meshes.
fn largest<T>(
    values: &[f64],
    poses: &Poses,
    harmonic: impl Fn([f64; 2], f64, &'static str) -> T,
) -> Vec<T> {
    if !poses.has_harmonics() {
        return Vec::new();
    }
    let scale = 2.0 / values.len() as f64;
    let [external, internal] = poses.meshes;
    let moduli = moduli(values.to_vec()).into_iter().enumerate().skip(1);
    let mut amplitudes: Vec<(usize, f64)> = moduli.map(|(k, value)| (k, scale * value)).collect();
    amplitudes.sort_by(|a, b| b.1.total_cmp(&a.1));
    let least = LEAST * amplitudes.first().map_or(0.0, |first| first.1);
    amplitudes.retain(|(_, amplitude)| *amplitude > least);
    amplitudes.truncate(KEPT);
    let named = |(k, amplitude): (usize, f64)| {
        let of = match (k.is_multiple_of(external), k.is_multiple_of(internal)) {
            (true, true) => "both meshes",
            (true, false) => "external mesh",
            (false, true) => "internal mesh",
            (false, false) => "neither mesh",
        };
        let order = k as f64 * poses.per_turn;
        harmonic([order, order * poses.ratio], amplitude, of)
    };
    amplitudes.into_iter().map(named).collect()
}
