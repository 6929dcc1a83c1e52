//! Small gearbox-like time series for the tests of this crate.
#![allow(dead_code)]

use pinwheel_compare::limits::Friction;
use pinwheel_compare::model::{ModelTolerance, Prediction};
use pinwheel_compare::{
    Context, Cost, Metric, Participant, Scales, SharedModel, Status, WindowKind,
};
use pinwheel_timeseries::TimeSeries;

/// Returns a participant with these time series at a step of 1e-5 s.
pub(crate) fn participant(name: &str, track: SharedModel, time_series: TimeSeries) -> Participant {
    Participant {
        name: name.to_owned(),
        track,
        version: "1.0".to_owned(),
        summary: String::new(),
        differences: String::new(),
        time_series,
        cost: Cost {
            step_s: 1e-5,
            ..Cost::default()
        },
        status: Status::Finished,
    }
}

/// Returns 0.6 s in steps of 1e-3 s; every pin force and the driver torque are `scale` times as large.
pub(crate) fn time_series(scale: f64) -> TimeSeries {
    let time: Vec<f64> = (0..=600).map(|k| f64::from(k) * 1e-3).collect();
    let mut time_series = TimeSeries::new(time.clone()).unwrap();
    let ripple = |t: f64, k: f64| scale * (60.0 + 40.0 * (140.0 * t + k).sin());
    let of = |f: &dyn Fn(f64) -> f64| time.iter().map(|&t| f(t)).collect::<Vec<_>>();
    time_series
        .push(
            "input_torque_n_m",
            of(&|t| scale * (1.45 + 0.02 * (838.0 * t).sin())),
        )
        .unwrap();
    time_series
        .push("output_torque_n_m", of(&|_| -22.0))
        .unwrap();
    time_series
        .push("output_angle_rad", of(&|t| -52.34 / 15.0 * t))
        .unwrap();
    for k in 0..3 {
        let force = of(&|t| ripple(t, f64::from(k)));
        time_series
            .push(format!("external_sleeve_force_n_{k}"), force)
            .unwrap();
    }
    time_series
}

/// The paper's load and speed.
pub(crate) fn context() -> Context {
    Context {
        scene: "paper".to_owned(),
        duration_s: 0.6,
        load_n_m: Some(22.0),
        // Zero, because the forces of these time series accelerate nothing.
        output_inertia_kg_m2: Some(0.0),
        input_speed_rad_s: Some(52.34),
        scales: Scales {
            force_n: Some(100.0),
            torque_n_m: Some(22.0),
        },
        ..Context::default()
    }
}

/// Random numbers from a fixed seed (splitmix64).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns a number of the uniform distribution from `low` to `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let unit = ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * unit
    }
}

/// Tolerances stated by a bed of springs and by colliders of polylines.
pub(crate) const TOLERANCES: [(&str, ModelTolerance); 4] = {
    let bed = ModelTolerance {
        friction: Friction::Without,
        window: Some(WindowKind::Steady),
        quantity: "input_torque_n_m",
        metric: Metric::Mean,
        predicted: Prediction::LawEnergy,
        tolerance: 5e-3,
        reason: "A bed of springs conserves energy.",
    };
    let force = ModelTolerance {
        quantity: "external_sleeve_force_n",
        metric: Metric::RelativeL2,
        predicted: Prediction::Same,
        tolerance: 4.5e-2,
        ..bed
    };
    let driver = ModelTolerance {
        tolerance: 1.5e-2,
        ..bed
    };
    let mean = ModelTolerance {
        quantity: "*_force_n",
        metric: Metric::Mean,
        tolerance: 1e-1,
        ..force
    };
    [
        ("mujoco-own-contact", bed),
        ("mujoco-own-contact", force),
        ("rapier-own-contact-colliders", driver),
        ("rapier-own-contact-colliders", mean),
    ]
};
