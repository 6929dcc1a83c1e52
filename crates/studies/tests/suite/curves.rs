//! Curves of the paper as files.

use pinwheel_studies::internals::table;
use pinwheel_studies::paper::{Curve, Plot};

#[test]
fn curves_as_csv() {
    let plot = Plot {
        x_label: "Time (s)".into(),
        y_label: "Force (N)".into(),
        x: vec![0.0, 0.5],
        curves: vec![Curve {
            label: "d = 0, exact".into(),
            points: false,
            y: vec![1.5, f64::NAN],
        }],
        ..Plot::default()
    };
    let mut text = Vec::new();
    table(&plot).write_csv(&mut text).unwrap();
    assert_eq!(
        String::from_utf8(text).unwrap(),
        "time_s,\"Force (N): d = 0, exact\"\n0,1.5\n0.5,\n"
    );
    assert_eq!(
        pinwheel_timeseries::TimeSeries::read_csv("time_s\n0\n".as_bytes())
            .map(|c| c.len())
            .ok(),
        Some(1)
    );
}
