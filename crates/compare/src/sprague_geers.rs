//! Sprague and Geers' errors of magnitude and phase.
//!
//! With I_ab = mean(a b) over all channels and samples, m the base and c the other signal: M = sqrt(I_cc / I_mm) - 1, P =
//! acos(I_mc / sqrt(I_mm I_cc)) / pi, C = sqrt(M^2 + P^2).
//! A signal scaled by 1.2 has M = 0.2, P = 0.
//!
//! Sources: Sprague and Geers, Int. J. Numer. Meth. Engng 60 (2004) 2467; Schwer, Engineering
//! with Computers 23 (2007) 295.

use serde::Serialize;

use pinwheel_timeseries::norms::View;

/// Errors of magnitude and phase, and their combination.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SpragueGeers {
    /// M: error of magnitude; positive when larger than the base. It depends on the choice of the base.
    pub magnitude: f64,
    /// P: error of phase and form, 0 to 1, independent of the choice of the base.
    pub phase: f64,
    /// C = sqrt(M^2 + P^2).
    pub comprehensive: f64,
}

/// Evaluates the errors of `course` relative to `base`, two views of one shape.
///
/// Two all-zero time series agree: all errors are 0. `None` if only one is zero, if the shapes differ, or if a value is not
/// finite.
pub fn sprague_geers(course: &View<'_>, base: &View<'_>) -> Option<SpragueGeers> {
    if !course.same_shape(base) {
        return None;
    }
    let (rms_c, rms_m) = (course.rms()?, base.rms()?);
    if rms_c == 0.0 && rms_m == 0.0 {
        return Some(SpragueGeers {
            magnitude: 0.0,
            phase: 0.0,
            comprehensive: 0.0,
        });
    }
    if rms_c == 0.0 || rms_m == 0.0 {
        return None;
    }
    let magnitude = rms_c / rms_m - 1.0;
    // Angle between the two as vectors. acos loses half of the digits where the time series almost agree, the usual case;
    // Kahan's form, 2 atan2(|u - v|, |u + v|) of the unit vectors, keeps them all.
    let (mut apart, mut together) = (0.0, 0.0);
    for (c, m) in course.values().zip(base.values()) {
        let (u, v) = (c / rms_c, m / rms_m);
        apart += (u - v) * (u - v);
        together += (u + v) * (u + v);
    }
    let phase = 2.0 * apart.sqrt().atan2(together.sqrt()) / std::f64::consts::PI;
    Some(SpragueGeers {
        magnitude,
        phase,
        comprehensive: magnitude.hypot(phase),
    })
}

/// Returns C without direction: M is that of the larger signal relative to the smaller.
pub fn comprehensive(a: &View<'_>, b: &View<'_>) -> Option<f64> {
    let [ab, ba] = [sprague_geers(a, b)?, sprague_geers(b, a)?];
    Some(ab.comprehensive.max(ba.comprehensive))
}
