//! Conclusions from a refinement study about its finest run.

use super::common::{context, participant, time_series};
use super::{entry, native, other};
use pinwheel_compare::uncertainty::order::{self, Rough};
use pinwheel_compare::uncertainty::{Basis, Method};
use pinwheel_compare::{
    Context, Divergence, Evidence, Ladder, Level, Rules, SharedModel, WindowKind, compare,
};
use pinwheel_timeseries::TimeSeries;

/// Returns a run with these values as its only channel.
fn torque(values: &dyn Fn(usize) -> f64) -> TimeSeries {
    let time = time_series(1.0).time_s().to_vec();
    let values = (0..time.len()).map(values).collect();
    let mut series = TimeSeries::new(time).unwrap();
    series.push("input_torque_n_m", values).unwrap();
    series
}

/// Returns the evidence of a method of order 2 without kinks.
pub(crate) fn levels(name: &str, coarser: [TimeSeries; 2]) -> Evidence {
    let [two, three] = coarser;
    let level = |refinement: f64, run: TimeSeries| Level {
        setting: 1e-5 * refinement,
        run: Ok(run),
        wall_s: 1.0,
    };
    let ladder = Ladder {
        method: Method::Step {
            order: 2.0,
            rough: None,
        },
        finest: 1e-5,
        floor: 0.0,
        coarser: vec![level(2.0, two), level(4.0, three)],
    };
    Evidence::refinement(name, ladder)
}

/// Differences of the right size confirm an order only if they point in one direction: a cosine of 0.5 or more.
#[test]
fn an_order_is_confirmed_by_differences_that_point_the_same_way() {
    for (cosine, wanted) in [
        (1.0, Basis::Observed),
        (0.55, Basis::Observed),
        (0.45, Basis::Unconfirmed),
        (0.0, Basis::Unconfirmed),
        (-1.0, Basis::Unconfirmed),
    ] {
        let across = f64::sqrt(1.0 - cosine * cosine);
        let turn = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let small = 1e-3;
        let two = move |_: usize| 1.0 + small;
        let three = move |k: usize| two(k) + 4.0 * small * (cosine + across * turn(k));
        let evidence = [levels("native", [torque(&two), torque(&three)])];
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let one = [participant("native", SharedModel::Native, torque(&|_| 1.0))];
        let comparison = compare(&context(), &one, &rules).unwrap();
        let steady = comparison.engines[0].uncertainty.iter();
        let mut steady = steady.filter(|u| u.window == WindowKind::Steady);
        let basis = steady.next().unwrap().l2.estimate().unwrap().basis;
        assert_eq!(basis, wanted, "{cosine}");
    }
    // Differences of one sign, each large at other samples: a cosine of 0.2.
    let large = |even: bool| {
        move |k: usize| {
            if k.is_multiple_of(2) == even {
                1.0
            } else {
                0.1
            }
        }
    };
    let two = move |k: usize| 1.0 + 1e-3 * large(true)(k);
    let three = move |k: usize| two(k) + 4e-3 * large(false)(k);
    let evidence = [levels("native", [torque(&two), torque(&three)])];
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    let one = [participant("native", SharedModel::Native, torque(&|_| 1.0))];
    let comparison = compare(&context(), &one, &rules).unwrap();
    let mut steady = comparison.engines[0].uncertainty.iter();
    let steady = steady.find(|u| u.window == WindowKind::Steady).unwrap();
    assert_eq!(
        steady.l2.estimate().unwrap().basis,
        Basis::Unconfirmed,
        "across"
    );
}

/// Beyond the horizon every run is a sample: u of a figure is three times the largest distance from the finest run.
#[test]
fn beyond_the_horizon_u_is_three_times_the_spread() {
    let parted = Context {
        divergence: Some(Divergence {
            horizon_s: Some(0.1),
            largest_share: 1.0,
            told: String::new(),
        }),
        ..context()
    };
    let evidence = [levels("native", [torque(&|_| 1.001), torque(&|_| 0.998)])];
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    let one = [participant("native", SharedModel::Native, torque(&|_| 1.0))];
    let comparison = compare(&parted, &one, &rules).unwrap();
    let mut steady = comparison.engines[0].uncertainty.iter();
    let steady = steady.find(|u| u.window == WindowKind::Steady).unwrap();
    let u = steady.mean.estimate().unwrap();
    assert_eq!(u.basis, Basis::Spread);
    // Pointwise uncertainties are unknown there.
    assert!(steady.l2.estimate().is_none() && steady.linf.estimate().is_none());
    assert!((u.u - 3.0 * 2e-3).abs() < 1e-12, "{u:?}");
}

/// Kinks confirm no method of higher order than their own; friction confirms the method's own order only.
#[test]
fn neither_kinks_nor_friction_confirm() {
    let at = |observed: f64, rough: Rough| {
        let step = |difference: f64| order::Step {
            ratio: 2.0,
            difference,
        };
        let steps = [step(1.0), step(2_f64.powf(observed))];
        let method = Method::Step {
            order: 4.0,
            rough: Some(rough),
        };
        order::estimate(&steps, Some(1.0), method, 0.0)
            .unwrap()
            .basis
    };
    for observed in [2.5, 4.0] {
        assert_eq!(at(observed, Rough::Kinks), Basis::Unconfirmed);
    }
    assert_eq!(at(1.0, Rough::Friction), Basis::Unconfirmed);
    assert_eq!(at(2.5, Rough::Friction), Basis::Unconfirmed);
    assert_eq!(at(4.0, Rough::Friction), Basis::Observed);
}

/// Invalid differences and ratios are reported, not computed with.
#[test]
fn a_study_that_makes_no_sense_says_so() {
    let of = |ratio: f64, difference: f64| {
        let fine = order::Step {
            ratio: 2.0,
            difference: 1e-6,
        };
        let steps = [fine, order::Step { ratio, difference }];
        let method = Method::Step {
            order: 2.0,
            rough: None,
        };
        order::estimate(&steps, Some(1.0), method, 0.0)
    };
    assert!(of(2.0, 4e-6).is_ok());
    for difference in [f64::NAN, f64::INFINITY] {
        let reason = of(2.0, difference).unwrap_err().reason;
        assert!(reason.contains("not finite"), "{reason}");
    }
    for ratio in [1.0, 0.5, f64::INFINITY, f64::NAN] {
        let reason = of(ratio, 4e-6).unwrap_err().reason;
        assert!(reason.contains("not ordered"), "{ratio}: {reason}");
    }
}

/// A figure confirms an order by the sign of its own differences, independent of the samples.
#[test]
fn a_figure_confirms_by_its_own_sign() {
    let basis_of_the_mean = |first: f64, sign: f64| {
        let turn = |k: usize| if k.is_multiple_of(2) { 3.0 } else { -3.0 };
        let two = move |k: usize| 1.0 + 1e-3 * (first + turn(k));
        let three = move |k: usize| two(k) + 4e-3 * (sign + turn(k));
        let evidence = [levels("native", [torque(&two), torque(&three)])];
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let one = [participant("native", SharedModel::Native, torque(&|_| 1.0))];
        let comparison = compare(&context(), &one, &rules).unwrap();
        let mut all = comparison.engines[0].uncertainty.iter();
        let steady = all.find(|u| u.window == WindowKind::Steady).unwrap();
        assert_eq!(steady.l2.estimate().unwrap().basis, Basis::Observed);
        steady.mean.estimate().unwrap().basis
    };
    for first in [1.0, -1.0] {
        assert_eq!(basis_of_the_mean(first, first), Basis::Observed);
        assert_eq!(basis_of_the_mean(first, -first), Basis::Unconfirmed);
    }
}

#[test]
fn orders_of_tolerances_and_of_no_differences() {
    let step = |ratio: f64, difference: f64| order::Step { ratio, difference };
    let good = step(2.0, 1.0);
    let order = order::observed_order(good, step(2.0, 4.0)).unwrap();
    assert!((order - 2.0).abs() < 1e-12, "{order}");
    for bad in [
        step(2.0, 0.0),
        step(1.0, 1.0),
        step(2.0, f64::NAN),
        step(2.0, f64::INFINITY),
    ] {
        assert_eq!(order::observed_order(bad, good), None, "{bad:?}");
        assert_eq!(order::observed_order(good, bad), None, "{bad:?}");
    }
}

/// A level with an additional sample is not on the grid.
#[test]
fn a_level_with_more_samples_is_refused() {
    let base = time_series(1.0);
    let mut times = base.time_s().to_vec();
    times.push(0.601);
    let mut longer = TimeSeries::new(times).unwrap();
    for channel in base.channels() {
        let mut values = channel.values.clone();
        values.push(0.0);
        longer.push(channel.name.clone(), values).unwrap();
    }
    let evidence = [
        levels("native", [longer.clone(), longer]),
        levels("other", [time_series(1.0), time_series(1.0)]),
    ];
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    let pair = [native(), other(SharedModel::SharedLaw, 1.0)];
    let comparison = compare(&context(), &pair, &rules).unwrap();
    let result = format!("{:?}", entry(&comparison, WindowKind::Steady).result);
    assert!(result.contains("other sample times"), "{result}");
}

/// A relative size refers to the quantity's own size, and rounding is a share of it.
#[test]
fn relative_sizes_are_of_the_quantity() {
    let with = |floor: f64| {
        let evidence = levels("native", [torque(&|_| 2.001), torque(&|_| 2.005)]);
        let rules = Rules {
            evidence: &[evidence.with_floor(floor)],
            ..Rules::default()
        };
        let one = [participant("native", SharedModel::Native, torque(&|_| 2.0))];
        let comparison = compare(&context(), &one, &rules).unwrap();
        let mut all = comparison.engines[0].uncertainty.iter();
        let steady = all.find(|u| u.window == WindowKind::Steady).unwrap();
        steady.clone()
    };
    let steady = with(0.0);
    let l2 = steady.l2.estimate().unwrap();
    assert_eq!(l2.basis, Basis::Observed);
    assert_eq!(steady.relative_l2, Some(l2.u / 2.0));
    let rounding = with(1e-3);
    let linf = rounding.linf.estimate().unwrap();
    assert_eq!((linf.basis, linf.u), (Basis::Rounding, 2e-3));
}
