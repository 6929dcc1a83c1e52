//! Statistics of a course.

use pinwheel_studies::baseline::Statistics;

#[test]
fn windows_by_hand() {
    let found = Statistics::of_course(&[&[3.0, 0.0, 1.0, -2.0], &[4.0, 0.0, 1.0, 2.0]]);
    assert_eq!(found.mean, [3.5, 0.0, 1.0, 0.0]);
    assert_eq!(found.rms, [12.5_f64.sqrt(), 0.0, 1.0, 2.0]);
    assert_eq!(found.peak, [4.0, 0.0, 1.0, 2.0]);
    assert_eq!((found.whole_mean(), found.whole_peak()), (1.125, 4.0));
    let spoiled = Statistics::of_course(&[&[f64::NAN, 1.0, 1.0, 1.0]]);
    assert!(spoiled.distance(&found).unwrap().is_nan());
    assert_eq!(
        found.distance(&Statistics {
            mean: vec![1.0],
            ..Statistics::default()
        }),
        None
    );
}
