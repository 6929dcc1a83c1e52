//! Errors of a run in a window.

use pinwheel_studies::bench::Span;
use pinwheel_studies::internals::errors;
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::LoadFloor;

fn time_series(force: [f64; 3]) -> TimeSeries {
    let mut time_series = TimeSeries::new(vec![0.0, 1.0, 2.0]).unwrap();
    time_series
        .push("external_sleeve_force_n_0", force.to_vec())
        .unwrap();
    time_series
        .push("internal_sleeve_force_n_0", vec![0.0; 3])
        .unwrap();
    time_series.push("input_torque_n_m", vec![1.0; 3]).unwrap();
    time_series
}

#[test]
fn norms_by_hand() {
    let span = |from_s, to_s| Span {
        name: String::new(),
        from_s,
        to_s,
    };
    let (a, b) = (time_series([3.0, 4.0, 1.0]), time_series([3.0, 4.0, 0.0]));
    let least = LoadFloor {
        force_n: 0.5,
        torque_n_m: 1e-3,
    };
    let errors = |a: &TimeSeries, b: &TimeSeries, span: &Span| errors(a, b, span, least);
    let near = |actual: [f64; 2], by_hand: [f64; 2]| {
        let off = actual.iter().zip(by_hand).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-15, "{actual:?}");
    };
    let all = errors(&a, &b, &span(0.0, 2.0));
    near([all.force_l2, all.force_max], [0.2, 0.25]);
    assert_eq!((all.torque_l2, all.torque_max), (0.0, 0.0));
    let early = errors(&a, &b, &span(0.0, 1.0));
    assert_eq!((early.force_l2, early.force_max), (0.0, 0.0));
    // Errors relative to the load floor.
    let late = errors(&a, &b, &span(2.0, 2.0));
    near([late.force_l2, late.force_max], [2.0, 2.0]);
}
