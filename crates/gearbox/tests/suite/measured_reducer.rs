//! Measured gears beside presets: an RV reducer's twist and orders, and signs of damage.

use std::f64::consts::{PI, TAU};

use pinwheel_gearbox::statics::Statics;
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_scene::Scene;

/// Arc minutes in a radian.
const ARCMIN: f64 = 10_800.0 / PI;
/// Least torque of the measured linear range, N m.
const LINE: f64 = 300.0;
/// Turns of the input for one turn of the output.
const RATIO: f64 = 81.0;

fn gearbox(sets: &[&str]) -> Gearbox {
    load("rv-160n-like", sets)
}

fn load(preset: &str, sets: &[&str]) -> Gearbox {
    let sets: Vec<_> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Gearbox::new(&Scene::load(preset, &sets).unwrap()).unwrap()
}

fn measured() -> toml::Table {
    let file = "../../reference/published/rv-160n.toml";
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    std::fs::read_to_string(path).unwrap().parse().unwrap()
}

fn numbers(table: &toml::Table, key: &str) -> Vec<f64> {
    let list = table[key].as_array().unwrap().iter();
    list.map(|value| value.as_float().unwrap()).collect()
}

/// Returns the least-squares fit of `a + b T^p` with the root mean square of its residuals: `[a, b, rms]`.
fn fit(points: &[[f64; 2]], p: f64) -> [f64; 3] {
    let n = points.len() as f64;
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(&|q| q[0].powf(p)), mean(&|q| q[1]));
    let b = mean(&|q| (q[0].powf(p) - x) * (q[1] - y)) / mean(&|q| (q[0].powf(p) - x).powi(2));
    let a = y - b * x;
    let rms = mean(&|q| (a + b * q[0].powf(p) - q[1]).powi(2)).sqrt();
    [a, b, rms]
}

/// Half of the twist between a torque and its opposite, arcmin, at 100, 200 .. 1800 N m, and the mean of both over that half.
struct Twist {
    half: Vec<[f64; 2]>,
    common: f64,
}

fn twist(sets: &[&str]) -> Twist {
    let gearbox = gearbox(sets);
    let mut statics = Statics::new(&gearbox).unwrap();
    let mut common = 0.0_f64;
    let half = (1..=18).map(|k| {
        let torque = 100.0 * f64::from(k);
        let [there, back] =
            [torque, -torque].map(|load| statics.solve(0.1, load).unwrap().output - 0.1 / RATIO);
        common = common.max(((there + back) / (there - back)).abs());
        [torque, 0.5 * (there - back) * ARCMIN]
    });
    let half = half.collect();
    Twist { half, common }
}

impl Twist {
    fn line(&self) -> Vec<[f64; 2]> {
        let points = self.half.iter().copied();
        points.filter(|[torque, _]| *torque >= LINE).collect()
    }

    /// Exponent of the best `a + b T^p`.
    fn exponent(&self) -> f64 {
        let line = self.line();
        let all = (700..1300).map(|k| 1e-3 * f64::from(k));
        all.min_by(|p, q| fit(&line, *p)[2].total_cmp(&fit(&line, *q)[2]))
            .unwrap()
    }
}

/// Two fitted numbers, a support's stiffness and a bearing's clearance, give the measured twist at every torque. Without the
/// supports the needles dominate: the gear is 8 times as stiff and its twist is not linear, which the measurement excludes.
#[test]
fn published_measured_reducer_by_one_compliance_and_one_clearance() {
    let measured = measured();
    let of = |key: &str| measured[key].as_float().unwrap();
    let range = numbers(&measured, "exponent");
    let ours = twist(&[]);
    let [intercept, slope, bent] = fit(&ours.line(), 1.0);
    let exponent = ours.exponent();
    println!(
        "fitted: {:.1} N m/arcmin, {intercept:.3} arcmin, exponent {exponent:.3}, off the line by {bent:.1e}",
        1.0 / slope
    );
    assert!((1.0 / slope / of("stiffness_n_m_arcmin") - 1.0).abs() < 0.005);
    assert!((intercept - of("intercept_arcmin")).abs() < 0.01);
    assert!((range[0]..range[1]).contains(&exponent), "{exponent}");
    let off = ours.half.iter().map(|[torque, half]| {
        let soft = of("soft_arcmin") * (1.0 - (-torque / of("soft_n_m")).exp());
        half - of("no_load_arcmin") - soft - torque / of("stiffness_n_m_arcmin")
    });
    let off: Vec<f64> = off.collect();
    let rms = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    println!("off the measured curve: {rms:.3} arcmin, {off:.3?}");
    assert!(rms < of("repeatability_arcmin"), "{rms}");
    assert!(ours.common < 0.01, "forward and backward: {}", ours.common);

    let start = (ours.half[1][1] - ours.half[0][1]) / 100.0 / slope;
    println!("compliance from 100 to 200 N m over that of the line: {start:.3}");
    let stiff = twist(&[
        "cranks.support_stiffness_n_m=1e15",
        "bearings.eccentric.clearance_m=0",
    ]);
    let times = slope / fit(&stiff.line(), 1.0)[1];
    println!(
        "rigid supports: {times:.2} times, exponent {}",
        stiff.exponent()
    );
    assert!((8.0..9.0).contains(&times), "{times}");
    assert!((0.88..0.92).contains(&stiff.exponent()));
}

/// Returns half of the twist between turning forward and backward against these loads, arcmin, with friction.
fn turning(sets: &[&str], torques: impl IntoIterator<Item = f64>) -> Vec<[f64; 2]> {
    let gearbox = gearbox(sets);
    let mut plain = Statics::new(&gearbox).unwrap();
    let mut rubs = Statics::rubbing(&gearbox).unwrap().unwrap();
    let half = torques.into_iter().map(|torque| {
        let [back, there] = [-1.0, 1.0].map(|way| {
            let at = plain.solve(0.1, -way * torque).unwrap();
            rubs.turning(way, &at, -way * torque).unwrap().output
        });
        [torque, 0.5 * (back - there) * ARCMIN]
    });
    half.collect()
}

/// Friction of loaded parts displaces the output of a turning gear by 0.003 arcmin only. The measured gear has 0.26 arcmin without
/// load, and 0.10 more within some 160 N m.
#[test]
fn published_measured_start_is_not_friction_of_loaded_parts() {
    let measured = measured();
    let of = |key: &str| measured[key].as_float().unwrap();
    let needles = [
        "bearings.eccentric.friction_coefficient=0.0025",
        "bearings.eccentric.bore_m=0.033",
    ];
    let sleeves = [
        "bearings.sleeve_friction_coefficient=0.02",
        "bearings.sleeve_bore_m=0.008",
    ];
    let held = [
        "gear.external_sleeves_turn=false",
        "contact.friction_coefficient=0.05",
    ];
    let own = twist(&[]);
    for parts in [[needles, sleeves].concat(), [needles, held].concat()] {
        for [torque, rubs] in turning(&parts, [100.0, 300.0, 900.0, 1800.0]) {
            let own = own.half.iter().find(|own| own[0] == torque).unwrap()[1];
            println!("{parts:?}, {torque} N m: {:.4} arcmin more", rubs - own);
            assert!((rubs - own).abs() < 0.02 * of("no_load_arcmin"));
        }
    }
}

/// A constant drag at the output cannot replace the clearance. 116 N m give the twist without load, and 0.04 to 0.11 arcmin too little
/// under load. 156 N m give the twist under load to the repeatability, and too much without load. Neither has the measured soft
/// start, because the drag has already loaded the needles.
#[test]
fn published_measured_start_by_one_drag() {
    let measured = measured();
    let theirs = numbers(&measured, "half_arcmin");
    let soft = |half: &[f64]| {
        let points = |range: std::ops::RangeInclusive<usize>| -> Vec<[f64; 2]> {
            range.map(|k| [100.0 * k as f64, half[k]]).collect()
        };
        fit(&points(0..=2), 1.0)[1] / fit(&points(3..=18), 1.0)[1]
    };
    println!("measured: {theirs:?}, soft start {:.3}", soft(&theirs));
    let by_drag = |drag: &str| -> Vec<f64> {
        let sets = ["bearings.eccentric.clearance_m=0", drag];
        let half = turning(&sets, (0..=18).map(|k| f64::max(100.0 * f64::from(k), 1.8)));
        let half: Vec<f64> = half.into_iter().map(|[_, half]| half).collect();
        println!("{drag}: {half:.3?}, soft start {:.3}", soft(&half));
        assert!(soft(&half) < 1.02 && soft(&theirs) > 1.12);
        half.iter()
            .zip(&theirs)
            .map(|(ours, theirs)| ours - theirs)
            .collect()
    };
    let idle = by_drag("bearings.output_seal_n_m=116");
    assert!(idle[0].abs() < 0.005 && idle[1..].iter().all(|off| (-0.11..-0.03).contains(off)));
    let line = by_drag("bearings.output_seal_n_m=156");
    let rms = (line[1..].iter().map(|off| off * off).sum::<f64>() / 18.0).sqrt();
    assert!(rms < 0.025 && line[0] > 0.08, "{rms}, {}", line[0]);
}

/// Returns amplitudes of the transmission error over a turn of the output, arcmin, at orders of that turn.
fn orders<const N: usize>(sets: &[&str], load: f64, orders: [u32; N]) -> [f64; N] {
    const POSES: u32 = 200;
    let gearbox = gearbox(sets);
    let mut statics = Statics::new(&gearbox).unwrap();
    let mut sums = [[0.0; 2]; N];
    for k in 0..POSES {
        let turn = f64::from(k) / f64::from(POSES);
        let error = statics.solve(RATIO * TAU * turn, load).unwrap().output - TAU * turn;
        for (order, sum) in orders.iter().zip(&mut sums) {
            let (sin, cos) = (TAU * f64::from(*order) * turn).sin_cos();
            *sum = [sum[0] + error * cos, sum[1] + error * sin];
        }
    }
    sums.map(|[cos, sin]| 2.0 * cos.hypot(sin) / f64::from(POSES) * ARCMIN)
}

/// Without clearance a displaced bore gives the measured order 40, independent of the load; with the fitted clearance load
/// halves it, so the measured start of the twist is hardly all clearance. An oval ring gives order 78 of the measured size, but
/// also without load, where the measured one is a tenth: positions of ring pins are not its cause. Neither error gives order
/// 39.
#[test]
fn published_measured_orders_by_errors_of_parts() {
    let measured = measured();
    let bore = "gear.errors.hole_radial_m=[5e-6, 0, 0, 0, 0, 0]";
    let ring: Vec<f64> = (0..40)
        .map(|i| 5e-6 * (TAU * f64::from(i) / 20.0).cos())
        .collect();
    let ring = format!("gear.errors.external_sleeve_radial_m={ring:?}");
    let [tight, fitted] = ["bearings.eccentric.clearance_m=0", "name=\"fitted\""];
    for (error, order, clearance, range) in [
        (bore, 40, tight, 0.85..1.0),
        (bore, 40, fitted, 0.3..0.6),
        (&ring, 78, tight, 0.95..1.05),
    ] {
        let [idle, loaded] =
            [1.8, -1800.0].map(|load| orders(&[error, clearance], load, [39, order]));
        let theirs = numbers(&measured, &format!("order_{order}_arcmin"));
        let ratio = loaded[1] / idle[1];
        println!(
            "order {order}: {:.4} and {:.4} arcmin, measured {theirs:?}; order 39: {:.1e}",
            idle[1], loaded[1], loaded[0]
        );
        assert!(range.contains(&ratio), "{ratio}");
        let is_measured = range.contains(&(theirs[1] / theirs[0]));
        assert_eq!(is_measured, order == 40 && clearance == tight);
        assert!(loaded[0] < 1e-2 * loaded[1]);
    }
}

/// Returns range (N m) and kurtosis of the driver's torque from 0.3 s on.
fn driver_torque(preset: &str) -> [f64; 2] {
    let gearbox = load(preset, &["solver.integrator=\"auto\""]);
    let run = native::run(&gearbox, &mut |_| false).unwrap();
    let series = run.finished().unwrap().time_series;
    let torque = series.channel("input_torque_n_m").unwrap();
    let steady = &torque[torque.len() / 2..];
    let n = steady.len() as f64;
    let mean = steady.iter().sum::<f64>() / n;
    let moment = |p: i32| steady.iter().map(|x| (x - mean).powi(p)).sum::<f64>() / n;
    let ends = steady
        .iter()
        .fold([mean; 2], |[l, h], x| [l.min(*x), h.max(*x)]);
    [ends[1] - ends[0], moment(4) / moment(2).powi(2)]
}

/// Two ring pins without sleeves raise the torque's envelope and the kurtosis, as Komorska et al. (Sensors 23 (2023) 1645)
/// measured for torque and vibration of a gear of the paper's kind. Their gear has other dimensions, so sizes are not
/// comparable.
#[test]
fn published_signs_of_removed_pins() {
    let [[range, kurtosis], [more_range, more_kurtosis]] =
        ["paper", "pins-removed"].map(driver_torque);
    println!(
        "range {range:.4} to {more_range:.4} N m, kurtosis {kurtosis:.2} to {more_kurtosis:.2}"
    );
    assert!(more_range > 1.05 * range && more_kurtosis > 1.2 * kurtosis);
}
