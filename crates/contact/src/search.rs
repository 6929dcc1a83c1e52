//! Constants of a curve for the search of closest points in lanes ([`crate::closest_lanes`]).

/// Constants of a curve that the search needs, in units of R.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Search {
    pub(crate) zk: f64,
    /// 1/zk.
    pub(crate) per_zk: f64,
    /// 1/R, 1/m.
    pub(crate) per_radius: f64,
    /// m.
    pub(crate) shortening: f64,
    /// H.
    pub(crate) repulsion: f64,
    /// Coefficients of -f^(n)(0)/(n! zk^(n-1)) for n = 2 to 5: the constant and the factor of m cos or m sin.
    pub(crate) series: [[f64; 2]; 4],
    /// Bound of |f'''|/(6 zk^2), for small r.
    pub(crate) third: f64,
}

impl Search {
    /// `radius`: R, m. `repulsion`: H.
    pub(crate) fn new(sleeves: u32, m: f64, radius: f64, repulsion: f64) -> Self {
        let zk = f64::from(sleeves);
        let zs = zk - 1.0;
        Self {
            zk,
            per_zk: zk.recip(),
            per_radius: radius.recip(),
            shortening: m,
            repulsion,
            series: [
                [0.0, -1.5 * zs / zk],
                [
                    -(1.0 + m * m * zk * zk) / (6.0 * zk * zk),
                    -(1.0 + zk.powi(4) - zs.powi(4)) / (6.0 * zk.powi(3)),
                ],
                [0.0, (zk.powi(5) - zs.powi(5) - 1.0) / (24.0 * zk.powi(4))],
                [
                    (1.0 + m * m * zk.powi(4)) / (120.0 * zk.powi(4)),
                    (1.0 + zk.powi(6) - zs.powi(6)) / (120.0 * zk.powi(5)),
                ],
            ],
            third: (m * m + 4.0 * m + 1.0 / (zk * zk)) / 6.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Search;
    use crate::Complex;

    /// f = T x r of a point on the curve, as the product of two power series: those of T1 + T2 and of the way along the curve.
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
            // The third derivative, 6 of its coefficients, wherever the lobe points.
            let most = (0..64)
                .map(|k| m * (0.1 * f64::from(k)).cos())
                .map(|re| search.series[1][0] + search.series[1][1] * re)
                .fold(0.0, |most: f64, x| most.max(x.abs()));
            assert!(most <= search.third && search.third < 2.0 * most, "{most}");
        }
    }
}
