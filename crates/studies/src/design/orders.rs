//! Harmonics of what repeats with the mesh.

use serde::Serialize;

use super::mesh::Poses;
use crate::fourier::moduli;

/// Harmonics that are kept.
const KEPT: usize = 12;
/// Share of the largest below which a harmonic is the balance's rounding.
const LEAST: f64 = 1e-6;

/// One harmonic.
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

/// One harmonic of a force.
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

/// The largest harmonics of a force over one period, largest first.
pub(super) fn of_force(force_n: &[f64], poses: &Poses) -> Vec<ForceHarmonic> {
    let force = |harmonic: Harmonic| ForceHarmonic {
        input_order: harmonic.input_order,
        output_order: harmonic.output_order,
        amplitude_n: harmonic.amplitude_arcmin,
        of: harmonic.of,
    };
    largest(force_n, poses).into_iter().map(force).collect()
}

/// The largest harmonics of a course over one period, largest first; none where the poses are too few for those of the meshes, which
/// would look like others.
pub(super) fn largest(course: &[f64], poses: &Poses) -> Vec<Harmonic> {
    if !poses.has_harmonics() {
        return Vec::new();
    }
    let scale = 2.0 / course.len() as f64;
    let [external, internal] = poses.meshes;
    let mut found: Vec<Harmonic> = moduli(course.to_vec())
        .into_iter()
        .enumerate()
        .skip(1)
        .map(|(k, value)| Harmonic {
            input_order: k as f64 * poses.per_turn,
            output_order: k as f64 * poses.per_turn * poses.ratio,
            amplitude_arcmin: scale * value,
            of: match (k.is_multiple_of(external), k.is_multiple_of(internal)) {
                (true, true) => "both meshes",
                (true, false) => "external mesh",
                (false, true) => "internal mesh",
                (false, false) => "neither mesh",
            },
        })
        .collect();
    found.sort_by(|a, b| b.amplitude_arcmin.total_cmp(&a.amplitude_arcmin));
    let least = LEAST * found.first().map_or(0.0, |first| first.amplitude_arcmin);
    found.retain(|harmonic| harmonic.amplitude_arcmin > least);
    found.truncate(KEPT);
    found
}
