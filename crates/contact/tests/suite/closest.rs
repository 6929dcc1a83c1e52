//! Closest points on the curve, one at a time.

use pinwheel_contact::{Complex, Epitrochoid};

#[test]
fn local_and_global_search_agree_to_rounding() {
    let curve = Epitrochoid::new(0.0028, 16, 0.7).unwrap();
    for k in 0..400 {
        let at = curve.at(0.0157 * f64::from(k));
        let p = at.position - at.normal.scale(1e-5 * f64::from(k % 7 + 1));
        let start = Complex::unit(0.0157 * f64::from(k) + 1e-3 * f64::from(k % 5 - 2));
        let local = curve.foot_within(p, [start, start.powu(16)], 0.0).unwrap();
        let global = curve.closest(p);
        assert!((local.distance - global.distance).abs() < 1e-16);
        assert!((local.at.position - at.position).norm() < 1e-14);
    }
}

/// From any start, a point that the ray test reports outside is farther from the curve than required. From a start close by,
/// the test reports every point beyond the allowance of the steepest slope.
#[test]
fn rays_tell_what_is_outside() {
    let mut certified = 0;
    for (zk, m) in [(16, 0.7), (40, 0.6), (5, 0.9)] {
        let curve = Epitrochoid::new(0.0028, zk, m).unwrap();
        let pitch = std::f64::consts::TAU / f64::from(zk);
        for k in 0..150_u32 {
            let a = 0.042 * f64::from(k);
            let at = curve.at(a).position;
            for (j, lift) in [0.5, 0.999, 1.0 - 1e-8, 1.0 + 1e-8, 1.001, 1.05, 1.5]
                .into_iter()
                .enumerate()
            {
                let p = at.scale(lift);
                let distance = curve.closest(p).distance;
                for away in [0.0, 1e-5, 1e-3] {
                    let outside = |from: f64| {
                        let start = Complex::unit(from);
                        curve.outside_by_ray(p, [start, start.powu(zk)], away)
                    };
                    let grown = (curve.steepest * (away / p.norm()).asin()).exp();
                    let clear = p.norm() - away - at.norm() * grown > 1e-9 * at.norm();
                    let near = a + 2e-3 * pitch * (f64::from(k % 5) - 2.0);
                    assert!(outside(near) || !clear, "{zk} {k} {lift} {away}");
                    for from in [
                        near,
                        a + 0.3 * f64::from(k % 7),
                        a + 3.0,
                        a - 0.5 * j as f64,
                    ] {
                        if outside(from) {
                            assert!(distance > away, "{zk} {k} {lift} {away} {from}");
                            certified += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(certified > 1000, "{certified}");
}
