//! The exponential multistep method on systems with a Jacobian; without one it is Dormand-Prince (generic tests).

use pinwheel_mbs::integrators::{Dopri5, EtdAdams, StepCounts, Stepper};
use pinwheel_mbs::{Jacobian, OdeSystem, Structure};

use super::bounds;
use bounds::holds;

/// Two light masses on stiff springs, pushed slowly and coupled by a cubic spring; the second spring may only push.
struct Masses {
    one_sided: bool,
    evaluations: u64,
}

/// Squared angular frequencies, rad^2/s^2.
const STIFFNESS: [f64; 2] = [4e4, 9e4];
const DAMPING: [f64; 2] = [2.0, 5.0];
const CUBIC: f64 = 2e4;
const START: [f64; 4] = [0.01, 0.02, 0.0, 1.0];
const END: f64 = 2.0;

impl Masses {
    fn new(one_sided: bool) -> Self {
        Self {
            one_sided,
            evaluations: 0,
        }
    }

    /// Returns 1 if the second spring acts, else 0.
    fn second(&self, x: f64) -> f64 {
        if self.one_sided && x < 0.0 { 0.0 } else { 1.0 }
    }
}

impl OdeSystem for Masses {
    fn dimension(&self) -> usize {
        4
    }

    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.evaluations += 1;
        let between = CUBIC * (y[0] - y[1]).powi(3);
        dydt[..2].copy_from_slice(&y[2..]);
        dydt[2] = 800.0 * (3.0 * t).sin() - STIFFNESS[0] * y[0] - DAMPING[0] * y[2] - between;
        dydt[3] =
            900.0 * (2.0 * t).cos() - self.second(y[1]) * STIFFNESS[1] * y[1] - DAMPING[1] * y[3]
                + between;
    }

    fn structure(&self) -> Structure {
        Structure::SecondOrder {
            is_leaf: vec![false; 2],
        }
    }

    fn jacobian(&mut self, t: f64, y: &[f64], jacobian: &mut Jacobian) -> bool {
        let Jacobian {
            position,
            rate,
            time,
            ..
        } = jacobian;
        let Some(position) = position else {
            return false;
        };
        let slope = 3.0 * CUBIC * (y[0] - y[1]).powi(2);
        for (k, own) in [STIFFNESS[0], self.second(y[1]) * STIFFNESS[1]]
            .into_iter()
            .enumerate()
        {
            position.add(k, k, -own - slope);
            position.add(k, 1 - k, slope);
            rate.add(k, k, -DAMPING[k]);
        }
        time[0] = 2400.0 * (3.0 * t).cos();
        time[1] = -1800.0 * (2.0 * t).sin();
        true
    }

    fn scale(&self, _: &[f64], scale: &mut [f64]) {
        scale.copy_from_slice(&[0.02, 0.02, 4.0, 4.0]);
    }
}

/// Returns the states at the requested times, and the counts of work.
fn run(
    stepper: &mut dyn Stepper,
    system: &mut Masses,
    times: &[f64],
) -> (Vec<[f64; 4]>, StepCounts) {
    let states = times.iter().map(|&t| {
        stepper.set_stop_time(t);
        while stepper.time() < t {
            stepper.step(system).unwrap();
        }
        let mut y = [0.0; 4];
        stepper.interpolate(system, t, &mut y);
        y
    });
    let states = states.collect();
    (states, stepper.counts())
}

fn exponential(tolerance: f64, one_sided: bool, times: &[f64]) -> (Vec<[f64; 4]>, StepCounts) {
    let mut system = Masses::new(one_sided);
    let mut stepper = EtdAdams::new(1e-4, tolerance, 0.0, &START);
    let done = run(&mut stepper, &mut system, times);
    assert_eq!(done.1.evaluations, system.evaluations);
    done
}

fn explicit(tolerance: f64, one_sided: bool, times: &[f64]) -> (Vec<[f64; 4]>, StepCounts) {
    let mut stepper = Dopri5::new(1e-4, tolerance, 0.0, &START);
    run(&mut stepper, &mut Masses::new(one_sided), times)
}

/// Returns the largest difference, relative to the scales of the system.
fn distance(a: &[[f64; 4]], b: &[[f64; 4]]) -> f64 {
    let scale = [0.02, 0.02, 4.0, 4.0];
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs
        .zip(scale.iter().cycle())
        .fold(0.0, |m: f64, ((a, b), s)| m.max((a - b).abs() / s))
}

fn grid(step: f64) -> Vec<f64> {
    (1..=(END / step) as usize)
        .map(|k| k as f64 * step)
        .collect()
}

/// Steps end at all samples: far apart, only the last, or at uneven times. Errors stay below four times those of Dormand-Prince
/// at the same tolerance (measured: 0.0004 to 2.4 times), and evaluations below half (measured: 0.31 to 0.07). Uneven samples
/// are an exception: they take five steps each, because their distances never permit doubling.
#[test]
fn samples_of_any_kind_cost_no_digits() {
    let uneven: Vec<f64> = (1..1500)
        .map(|k| END * (f64::from(k) / 1500.0).powf(1.3))
        .collect();
    for (name, times) in [
        ("grid", grid(2e-3)),
        ("coarse grid", grid(0.05)),
        ("end", vec![END]),
        ("uneven", uneven),
    ] {
        let exact = explicit(1e-12, false, &times).0;
        for tolerance in [1e-4, 1e-5, 1e-6, 1e-7, 1e-8] {
            let (states, counts) = exponential(tolerance, false, &times);
            let plain = explicit(tolerance, false, &times);
            let (error, of_plain) = (distance(&states, &exact), distance(&plain.0, &exact));
            println!(
                "{name} {tolerance:e}: {error:.1e} {counts:?}, dopri5 {of_plain:.1e} {}",
                plain.1.evaluations
            );
            let what = format!("{name} at {tolerance:e}");
            holds(
                "etd-adams",
                &format!("error, {what}"),
                error,
                ..4.0 * of_plain,
            );
            let share = counts.evaluations as f64 / plain.1.evaluations as f64;
            if name != "uneven" && (times.len() < 1000 || tolerance < 1e-5) {
                holds("etd-adams", &format!("evaluations, {what}"), share, ..0.5);
            }
        }
    }
}

/// Short runs of smooth and one-sided springs, with samples on a grid, at uneven times and at the end: errors at and between
/// samples, in tolerances, and cost. The method mostly rejects wrong results, so that a fault in it raises the cost.
#[test]
fn regress_short_runs_cost_what_they_cost() {
    let scaled = |times: Vec<f64>| times.into_iter().map(|t| 0.15 * t).collect::<Vec<_>>();
    let uneven = (1..100).map(|k| END * (f64::from(k) / 100.0).powf(1.3));
    // Errors at and between samples, steps, rejected steps, evaluations and Jacobians.
    for (name, one_sided, tolerance, times, measured) in [
        (
            "grid",
            false,
            1e-6,
            scaled(grid(0.02)),
            [21.4, 0.1, 152.0, 0.0, 187.0, 10.0],
        ),
        (
            "grid",
            true,
            1e-6,
            scaled(grid(0.02)),
            [60.5, 16.4, 187.0, 4.0, 226.0, 12.0],
        ),
        (
            "uneven",
            true,
            1e-7,
            scaled(uneven.collect()),
            [31.4, 11.8, 547.0, 5.0, 587.0, 34.0],
        ),
        (
            "end",
            false,
            1e-9,
            scaled(vec![END]),
            [20.5, 25.9, 485.0, 9.0, 519.0, 20.0],
        ),
        (
            "end",
            true,
            1e-5,
            scaled(vec![END]),
            [14.0, 15.6, 117.0, 5.0, 147.0, 6.0],
        ),
    ] {
        let (states, counts) = exponential(tolerance, one_sided, &times);
        let mut free = EtdAdams::new(1e-4, tolerance, 0.0, &START);
        // Shorter than an oscillation, of which only the ends would be evaluated.
        Stepper::shorten(&mut free, 1e-3);
        let (mut inside, mut dense) = (Vec::new(), Vec::new());
        let mut system = Masses::new(one_sided);
        while stepper_time(&free) < 0.15 * END {
            let before = stepper_time(&free);
            free.step(&mut system).unwrap();
            let t = before + 0.7 * (stepper_time(&free) - before);
            let mut y = [0.0; 4];
            free.interpolate(&mut system, t, &mut y);
            inside.push(t);
            dense.push(y);
        }
        let error = distance(&states, &explicit(1e-12, one_sided, &times).0);
        let between = distance(&dense, &explicit(1e-12, one_sided, &inside).0);
        let ratios = [
            error / tolerance,
            between / tolerance,
            counts.steps as f64,
            counts.rejected as f64,
            counts.evaluations as f64,
            counts.jacobians as f64,
        ];
        println!("{name} {one_sided} {tolerance:e}: {ratios:.1?}");
        for (k, (ratio, measured)) in ratios.into_iter().zip(measured).enumerate() {
            let slack = if k < 2 { 0.5 } else { 0.03 };
            let off = (ratio - measured).abs();
            assert!(
                off <= slack * measured + 1.0,
                "{name} {k}: {ratio} {measured}"
            );
        }
    }
}

/// Equal steps, by a bound and a very loose tolerance: halving them divides the error by at least 2^3.5 (measured: 2^7.3, as
/// the higher order is used).
#[test]
fn fixed_steps_have_the_order() {
    let exact = explicit(1e-13, false, &[END]).0;
    let error = |steps: f64| {
        let (mut system, longest) = (Masses::new(false), END / steps);
        let mut stepper = EtdAdams::new(longest, 1e9, 0.0, &START);
        Stepper::shorten(&mut stepper, longest);
        let (states, counts) = run(&mut stepper, &mut system, &[END]);
        println!("{steps}: {:.1e} {counts:?}", distance(&states, &exact));
        // The first steps are Dormand-Prince's.
        assert!((counts.steps as f64 - steps).abs() <= 8.0);
        assert!(counts.jacobians > 0 && counts.evaluations < 2 * counts.steps);
        distance(&states, &exact)
    };
    let errors = [2048.0, 4096.0, 8192.0].map(error);
    for pair in errors.windows(2) {
        holds("etd-adams", "order", (pair[0] / pair[1]).log2(), 3.5..);
    }
}

/// Between steps the state is as accurate as at their ends.
#[test]
fn states_between_steps_are_as_good() {
    let mut system = Masses::new(false);
    let mut stepper = EtdAdams::new(1e-4, 1e-7, 0.0, &START);
    let (mut times, mut states) = (Vec::new(), Vec::new());
    while stepper_time(&stepper) < END {
        let before = stepper_time(&stepper);
        stepper.step(&mut system).unwrap();
        for share in [0.1, 0.5, 0.9] {
            let t = before + share * (stepper_time(&stepper) - before);
            let mut y = [0.0; 4];
            stepper.interpolate(&mut system, t, &mut y);
            times.push(t);
            states.push(y);
        }
    }
    let error = distance(&states, &explicit(1e-12, false, &times).0);
    println!("{error:.1e}");
    holds("etd-adams", "error between steps", error, ..1e-5);
}

fn stepper_time(stepper: &EtdAdams) -> f64 {
    Stepper::time(stepper)
}

/// The second spring only pushes: f has a kink and the Jacobian jumps twice in every oscillation. Measured errors, which grow
/// with each oscillation: 2.2e-2, 9.7e-4 and 7.1e-6, a third to a half of those of Dormand-Prince, with 0.32 to 0.12 of its
/// evaluations.
#[test]
fn contacts_that_open_and_close_keep_the_tolerance() {
    let times = grid(2e-3);
    let exact = explicit(1e-12, true, &times).0;
    for tolerance in [1e-4, 1e-6, 1e-8] {
        let (states, counts) = exponential(tolerance, true, &times);
        let plain = explicit(tolerance, true, &times);
        let (error, of_plain) = (distance(&states, &exact), distance(&plain.0, &exact));
        println!(
            "{tolerance:e}: {error:.1e} {counts:?}, dopri5 {of_plain:.1e} {}",
            plain.1.evaluations
        );
        let what = format!("error at {tolerance:e}, in those of dopri5");
        holds("etd-adams", &what, error / of_plain, ..1.0);
        let share = counts.evaluations as f64 / plain.1.evaluations as f64;
        holds(
            "etd-adams",
            &format!("evaluations at {tolerance:e}"),
            share,
            ..0.5,
        );
    }
}

/// A state that is NaN ends the run with an error, with either method.
#[test]
fn hard_a_fault_in_the_middle_is_an_error() {
    struct Broken(Masses);
    impl OdeSystem for Broken {
        fn dimension(&self) -> usize {
            4
        }
        fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) {
            self.0.derivative(t, y, dydt);
            if t > 1.0 {
                dydt[2] = f64::NAN;
            }
        }
        fn structure(&self) -> Structure {
            self.0.structure()
        }
        fn jacobian(&mut self, t: f64, y: &[f64], jacobian: &mut Jacobian) -> bool {
            self.0.jacobian(t, y, jacobian)
        }
    }
    let mut system = Broken(Masses::new(false));
    let mut stepper = EtdAdams::new(1e-4, 1e-6, 0.0, &START);
    let outcome = (0..100_000).find_map(|_| stepper.step(&mut system).err());
    assert!(outcome.is_some());
    assert!(Stepper::state(&stepper).iter().all(|x| x.is_finite()));
    assert!(Stepper::time(&stepper) <= 1.0);
}
