//! Constants of the search for closest points in lanes.

use pinwheel_contact::Complex;
use pinwheel_contact::internals::Search;

/// f = T x r of a point on the curve, as the product of two power series: those of T1 + T2 and of the arc along the curve.
#[test]
fn series_are_the_product_of_two_power_series() {
    for (sleeves, m) in [(3, 0.3), (16, 0.7), (60, 0.95)] {
        let zk = f64::from(sleeves);
        let search = Search::new(sleeves, m, 1.0, 1.0);
        for k in 0..7 {
            let lobe = Complex::unit(0.9 * f64::from(k)).scale(m);
            // Coefficients of d^n, with i^n/n! in `power`.
            let mut power = Complex::ONE;
            let (mut tangent, mut way) = (Vec::new(), Vec::new());
            for n in 0..=5 {
                let turned = power * lobe.scale(zk.powi(n));
                tangent.push(power + turned);
                way.push(power + turned.scale(1.0 / zk));
                power = power.turned().scale(1.0 / f64::from(n + 1));
            }
            way[0] = Complex::new(0.0, 0.0);
            for n in 2..=5 {
                let f: f64 = (0..=n).map(|j| -tangent[j].cross(way[n - j])).sum();
                let [constant, factor] = search.series[n - 2];
                let part = if n % 2 == 0 { lobe.im } else { lobe.re };
                let exact = -f / zk.powi(n as i32 - 1);
                let off = constant + factor * part - exact;
                assert!(
                    off.abs() < 1e-12,
                    "{sleeves} {k} {n}: {exact} off by {off:e}"
                );
            }
        }
        // Largest third derivative, 6 times its coefficient, over all directions of the lobe.
        let most = (0..64)
            .map(|k| m * (0.1 * f64::from(k)).cos())
            .map(|re| search.series[1][0] + search.series[1][1] * re)
            .fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!(most <= search.third && search.third < 2.0 * most, "{most}");
    }
}
