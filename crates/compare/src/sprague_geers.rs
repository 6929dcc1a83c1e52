//! Sprague and Geers' errors of magnitude and phase.
//!
//! With I_ab = mean(a b) over all channels and samples, m the base and c the other course:
//! M = sqrt(I_cc / I_mm) - 1, P = acos(I_mc / sqrt(I_mm I_cc)) / pi, C = sqrt(M^2 + P^2).
//! A course scaled by 1.2 has M = 0.2, P = 0.
//!
//! Sources: Sprague and Geers, Int. J. Numer. Meth. Engng 60 (2004) 2467; Schwer, Engineering
//! with Computers 23 (2007) 295.

use serde::Serialize;

use pinwheel_timeseries::norms::View;

/// The three errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SpragueGeers {
    /// M: error of magnitude; positive when larger than the base. Has a direction.
    pub magnitude: f64,
    /// P: error of phase and form, 0 to 1. Has none.
    pub phase: f64,
    /// C = sqrt(M^2 + P^2).
    pub comprehensive: f64,
}

/// The errors of `course` measured on `base`, two views of one shape.
///
/// Two all-zero time series agree: all errors are 0. `None` if only one is zero (M or P has no
/// value then), if the shapes differ, or if a value is not finite.
#[must_use]
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
    // The angle between the two as vectors. acos loses half of the digits where the time series
    // almost agree, which is where we are; Kahan's form, 2 atan2(|u - v|, |u + v|) of the unit
    // vectors, keeps them all.
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

/// C without direction: M is taken of the larger course on the smaller.
#[must_use]
pub fn comprehensive(a: &View<'_>, b: &View<'_>) -> Option<f64> {
    Some(
        sprague_geers(a, b)?
            .comprehensive
            .max(sprague_geers(b, a)?.comprehensive),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(shift: f64, scale: f64) -> Vec<f64> {
        // Whole periods, so that the sums of the closed forms below are exact.
        let step = std::f64::consts::TAU / 100.0;
        (0..1000)
            .map(|k| scale * (f64::from(k) * step - shift).sin())
            .collect()
    }

    fn of(course: &[f64], base: &[f64]) -> SpragueGeers {
        sprague_geers(&View::new(vec![course]), &View::new(vec![base])).unwrap()
    }

    #[test]
    fn scaled_by_a_fifth() {
        let errors = of(&wave(0.0, 1.2), &wave(0.0, 1.0));
        assert!((errors.magnitude - 0.2).abs() < 1e-14, "{errors:?}");
        assert!(errors.phase < 1e-14 && (errors.comprehensive - 0.2).abs() < 1e-14);
    }

    #[test]
    fn shifted_wave_has_its_shift_as_phase() {
        // sin(x) against sin(x - s) over whole periods: I_mc = cos(s)/2, so P = s/pi.
        for shift in [1e-9, 1e-4, 0.3, 2.0] {
            let errors = of(&wave(shift, 1.0), &wave(0.0, 1.0));
            let wanted = shift / std::f64::consts::PI;
            assert!(
                (errors.phase - wanted).abs() < 1e-14 + 1e-6 * wanted,
                "{shift}: {errors:?}"
            );
            assert!(errors.magnitude.abs() < 1e-13);
        }
        let opposite = of(&wave(0.0, -1.0), &wave(0.0, 1.0));
        assert!((opposite.phase - 1.0).abs() < 1e-14);
    }

    #[test]
    fn group_is_joint() {
        let (one, two) = (wave(0.0, 1.0), wave(1.0, 3.0));
        let (one_up, two_up) = (wave(0.0, 1.2), wave(1.0, 3.6));
        let errors = sprague_geers(
            &View::new(vec![&one_up, &two_up]),
            &View::new(vec![&one, &two]),
        )
        .unwrap();
        assert!((errors.magnitude - 0.2).abs() < 1e-14 && errors.phase < 1e-14);
    }

    #[test]
    fn zeros_and_non_finite() {
        let zero = [0.0; 3];
        let view = |x: &'static [f64]| View::new(vec![x]);
        assert_eq!(of(&zero, &zero).comprehensive, 0.0);
        assert!(sprague_geers(&view(&[1.0]), &view(&[0.0])).is_none());
        assert!(sprague_geers(&view(&[f64::NAN]), &view(&[1.0])).is_none());
        assert!(sprague_geers(&view(&[1.0, 2.0]), &view(&[1.0])).is_none());
        assert!(sprague_geers(&view(&[]), &view(&[])).is_none());
    }
}
