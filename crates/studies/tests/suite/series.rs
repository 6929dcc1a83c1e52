//! Reasons to stop a series of runs.

use pinwheel_engines::{AccuracySetting, Ending, SharedModel};
use pinwheel_studies::bench::{Cost, Errors, Options, Point, Series, Stopped};

/// Returns a series of three points, each with its CPU time and error; an infinite error means divergence.
fn series(track: SharedModel, knob: AccuracySetting, points: [(f64, f64); 3]) -> Series {
    let point = |(cpu_min_s, force_l2): (f64, f64)| Point {
        setting: 2.0,
        ending: Ending::Finished,
        errors: vec![Errors {
            force_l2,
            ..Errors::default()
        }],
        cost: Some(Cost {
            cpu_min_s,
            ..Cost::default()
        }),
    };
    Series {
        engine: String::new(),
        version: String::new(),
        track,
        method: String::new(),
        order: None,
        knob,
        points: points.map(point).into(),
        stopped: Stopped::Finished,
    }
}

#[test]
fn a_series_stops_for_a_reason() {
    let options = Options::default();
    let stop = |track, cpu_s, error, before| {
        let points = [(0.0, before), (0.0, 1.0), (cpu_s, error)];
        series(track, AccuracySetting::Step, points).stop(1.0, 1e-8, &options)
    };
    let tighter = |before_s| {
        let points = [(0.0, 1.0), (before_s, 2e-2), (2.1, 1e-2)];
        let long = series(SharedModel::Native, AccuracySetting::Tolerance, points);
        long.stop(0.6, 1e-8, &options)
    };
    let (native, shared) = (SharedModel::Native, SharedModel::SharedLaw);
    let own = SharedModel::OwnContact;
    assert_eq!(tighter(1.9), None);
    assert_eq!(tighter(2.1), Some(Stopped::TooLong));
    assert_eq!(stop(native, 0.1, 1e-6, 4e-6), None);
    assert_eq!(stop(native, 1.0, 1e-6, 4e-6), Some(Stopped::GoodEnough));
    assert_eq!(stop(shared, 1e3, 1e-2, 4e-2), Some(Stopped::TooLong));
    assert_eq!(stop(own, 1.0, 1e-2, 1e-2), Some(Stopped::Stagnates));
    assert_eq!(stop(shared, 1.0, 1e-2, 1e-2), None);
    let at = Some(Stopped::AtTheReference);
    assert_eq!(stop(native, 1.0, 1e-10, 1e-9), at);
    assert_eq!(stop(native, 1.0, f64::INFINITY, f64::INFINITY), None);
}
