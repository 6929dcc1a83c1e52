//! Metric of Sprague and Geers.

use pinwheel_compare::sprague_geers::{SpragueGeers, sprague_geers};
use pinwheel_timeseries::norms::View;

fn wave(shift: f64, scale: f64) -> Vec<f64> {
    // Complete periods, so that the closed forms below are exact.
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
    // sin(x) against sin(x - s) over complete periods: I_mc = cos(s)/2, so P = s/pi.
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
