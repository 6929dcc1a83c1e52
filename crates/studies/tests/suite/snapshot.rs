//! Statistics of a time series.

use pinwheel_studies::baseline::Statistics;

#[test]
fn windows_by_hand() {
    let stats = Statistics::of_course(&[&[3.0, 0.0, 1.0, -2.0], &[4.0, 0.0, 1.0, 2.0]]);
    assert_eq!(stats.mean, [3.5, 0.0, 1.0, 0.0]);
    assert_eq!(stats.rms, [12.5_f64.sqrt(), 0.0, 1.0, 2.0]);
    assert_eq!(stats.peak, [4.0, 0.0, 1.0, 2.0]);
    assert_eq!((stats.whole_mean(), stats.whole_peak()), (1.125, 4.0));
    let spoiled = Statistics::of_course(&[&[f64::NAN, 1.0, 1.0, 1.0]]);
    assert!(spoiled.distance(&stats).unwrap().is_nan());
    assert_eq!(
        stats.distance(&Statistics {
            mean: vec![1.0],
            ..Statistics::default()
        }),
        None
    );
}
