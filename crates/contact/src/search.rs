//! Constants of a curve for the search of closest points in lanes ([`crate::closest_lanes`]).

/// Constants of a curve for the search, in units of R.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Search {
    pub(crate) zk: f64,
    /// Inverse 1/zk.
    pub(crate) per_zk: f64,
    /// Inverse radius 1/R, 1/m.
    pub(crate) per_radius: f64,
    /// Shortening m.
    pub(crate) shortening: f64,
    /// Bound H of [`Epitrochoid::repulsion`](crate::Epitrochoid::repulsion).
    pub(crate) repulsion: f64,
    /// Coefficients of -f^(n)(0)/(n! zk^(n-1)) for n = 2 to 5: the constant and the factor of m cos or m sin.
    pub series: [[f64; 2]; 4],
    /// Bound of |f'''|/(6 zk^2), for small r.
    pub third: f64,
}

impl Search {
    /// Creates the constants. `radius`: R, m. `repulsion`: H.
    pub fn new(sleeves: u32, m: f64, radius: f64, repulsion: f64) -> Self {
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
