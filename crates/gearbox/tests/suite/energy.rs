//! Works and samples of the energy account.

use pinwheel_gearbox::energy::EnergyAccount;
use pinwheel_timeseries::sampling::SAFETY;

/// Returns an account of one power, with samples at the selected entries.
fn account(
    segments: &[(&[f64], &dyn Fn(f64) -> f64)],
    sampled: impl Fn(usize) -> bool,
) -> EnergyAccount {
    let mut account = EnergyAccount::default();
    let mut entry = 0;
    for (n, (times, power)) in segments.iter().enumerate() {
        if n > 0 {
            account.restart_at();
        }
        for &t in *times {
            account.enter(t, [power(t); 7]);
            if sampled(entry) {
                account.mark(t, [0.0; 2]);
            }
            entry += 1;
        }
    }
    account
}

fn work(account: &EnergyAccount, from: f64, to: f64) -> f64 {
    account.audit(from, to).unwrap().damping_j
}

/// Exact for cubics, also with unequal entries, and of order 4 otherwise.
#[test]
fn quadrature_has_its_order() {
    let cubic = |t: f64| 1.0 + t * (2.0 - t * (3.0 - 4.0 * t));
    let exact = |t: f64| t + t * t - t * t * t + t.powi(4);
    let times = [0.0, 0.1, 0.25, 0.3, 0.5, 0.6];
    let ledger = account(&[(&times, &cubic)], |_| true);
    assert!((work(&ledger, 0.0, 0.6) - exact(0.6)).abs() < 1e-15);
    assert!((work(&ledger, 0.25, 0.5) - exact(0.5) + exact(0.25)).abs() < 1e-15);
    // At the scale of a run, where all intervals are small, unequal intervals are still recognised.
    let small = times.map(|t| 1e-4 * t);
    let ledger = account(&[(&small, &|t| cubic(1e4 * t))], |_| true);
    assert!((work(&ledger, 0.0, 6e-5) / 1e-4 - exact(0.6)).abs() < 1e-14);
    let error = |n: usize| {
        let times: Vec<f64> = (0..=n).map(|k| k as f64 / n as f64).collect();
        let ledger = account(&[(&times, &|t| (7.0 * t).sin())], |k| k == 0 || k == n);
        (work(&ledger, 0.0, 1.0) - (1.0 - 7.0_f64.cos()) / 7.0).abs()
    };
    let order = (error(40) / error(80)).log2();
    assert!(order > 3.7, "{order}");
}

/// The account does not depend on which entries are samples.
#[test]
fn samples_do_not_change_the_works() {
    let times: Vec<f64> = (0..40)
        .map(|k| f64::from(k) * 0.1 + 0.03 * f64::from(k % 3))
        .collect();
    let power = |t: f64| (3.0 * t).cos() + t;
    let all = account(&[(&times, &power)], |_| true);
    for every in [2, 3, 5, 13] {
        let few = account(&[(&times, &power)], |k| k % every == 0);
        for &time in times.iter().step_by(every).skip(1) {
            let [of_few, of_all] = [&few, &all].map(|of| of.audit(0.0, time).unwrap());
            assert_eq!(of_few.to_s, time);
            assert_eq!(of_few, of_all, "every {every}");
        }
    }
}

/// Only samples take memory, for any number of entries.
#[test]
fn entries_between_samples_are_not_kept() {
    let times: Vec<f64> = (0..1000).map(f64::from).collect();
    let ledger = account(&[(&times, &|t| t)], |k| k == 0 || k == 999);
    assert_eq!(ledger.audit(1.0, 499.0), None);
    assert_eq!(ledger.audit(500.0, 998.0), None);
    assert!((work(&ledger, 0.0, 999.0) / (999.0 * 999.0 / 2.0) - 1.0).abs() < 1e-13);
}

#[test]
fn entries_are_never_far_apart() {
    assert_eq!(EnergyAccount::between(0.0, 1e-4, 1e-5, 1).count(), 0);
    let times: Vec<f64> = EnergyAccount::between(0.0, 1e-3, 1e-5, 1).collect();
    assert_eq!(times.len(), 9);
    assert!((times[4] - 5e-4).abs() < 1e-18);
    assert_eq!(EnergyAccount::between(0.0, 1e-6, 1e-5, 1).count(), 0);
}

/// A power that jumps: each side has its own cubics, with nothing from across the jump.
#[test]
fn no_interval_reaches_over_a_jump() {
    let (before, after) = ([0.0, 0.1, 0.2, 0.3], [0.3, 0.35, 0.45, 0.5, 0.7]);
    let segments: [(&[f64], &dyn Fn(f64) -> f64); 2] =
        [(&before, &|t| t * t * t), (&after, &|t| 5.0 - t)];
    // The sample at the jump is the first entry of the second segment.
    let ledger = account(&segments, |k| k != 3);
    let total = work(&ledger, 0.0, 0.7);
    let exact = 0.3_f64.powi(4) / 4.0 + 5.0 * 0.4 - 0.5 * (0.49 - 0.09);
    assert!((total - exact).abs() < 1e-15, "{total} {exact}");
    let part = work(&ledger, 0.2, 0.45);
    let exact = (0.3_f64.powi(4) - 0.2_f64.powi(4)) / 4.0 + 5.0 * 0.15 - 0.5 * (0.2025 - 0.09);
    assert!((part - exact).abs() < 1e-15, "{part} {exact}");
}

/// An account is that of the samples nearest to the requested times.
#[test]
fn accounts_are_of_the_nearest_samples() {
    let ledger = account(&[(&[0.0, 1.0, 2.0, 3.0], &|_| 1.0)], |_| true);
    for (from, to, ends) in [
        (0.4, 2.6, (0.0, 3.0)),
        (0.6, 2.4, (1.0, 2.0)),
        (-5.0, 9.0, (0.0, 3.0)),
    ] {
        let audit = ledger.audit(from, to).unwrap();
        assert_eq!((audit.from_s, audit.to_s), ends);
    }
    assert_eq!(ledger.audit(0.6, 1.4), None);
}

#[test]
fn too_little_is_no_account() {
    assert_eq!(EnergyAccount::default().total(), None);
}

/// Returns the uncertainties of the driving and of the lost work, J, of an account with equal powers.
fn off(account: &EnergyAccount) -> [f64; 2] {
    let audit = account.total().unwrap();
    // Two of the seven equal powers drive, and five are lost.
    [audit.remainder_off_j / 3.0, audit.lost_off_j / 5.0].map(|off| off / SAFETY)
}

/// Uncertainty: negligible for a smooth power, the power's own size if under-sampled, the range of few entries.
#[test]
fn entries_bound_the_power_between_them() {
    let uncertainty = |power: &dyn Fn(f64) -> f64, entries: u32, h: f64| {
        let times: Vec<f64> = (0..entries).map(|k| h * f64::from(k)).collect();
        let ends = [0, times.len() - 1];
        off(&account(&[(&times, power)], |k| ends.contains(&k)))
    };
    let cubic = uncertainty(&|t| 1.0 + t * t * t, 50, 0.1);
    let [smooth, coarse] = [0.1, 1.5].map(|h| uncertainty(&f64::sin, 200, h));
    let few = uncertainty(&|t| t, 3, 1.0);
    for k in 0..2 {
        assert!(cubic[k] < 1e-12);
        let (smooth, coarse) = (smooth[k], coarse[k]);
        assert!(smooth < 1e-6 && coarse > 0.5, "{smooth} {coarse}");
        assert!((few[k] - 4.0).abs() < 1e-12, "{few:?}");
    }
    let segments: [(&[f64], &dyn Fn(f64) -> f64); 2] =
        [(&[0.0, 1.0, 2.0], &|t| t), (&[2.0], &|t| t)];
    assert_eq!(off(&account(&segments, |k| k == 0 || k == 3)), few);
}
