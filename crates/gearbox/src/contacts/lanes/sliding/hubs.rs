//! The few velocities that many contacts share, and their dense system.

/// Wheels and the output.
pub(super) const MOST_HUBS: usize = 5;

/// Hubs: wheels first, the output last.
#[derive(Debug, Clone)]
pub(super) struct Hubs {
    pub(super) count: usize,
    pub(super) inertia: [f64; MOST_HUBS],
    /// v*, rad/s.
    pub(super) target: [f64; MOST_HUBS],
    /// v - v*, rad/s.
    pub(super) change: [f64; MOST_HUBS],
    /// Newton step, rad/s.
    pub(super) step: [f64; MOST_HUBS],
    /// Lower triangle.
    pub(super) matrix: [[f64; MOST_HUBS]; MOST_HUBS],
}

impl Hubs {
    pub(super) fn new(count: usize) -> Self {
        Self {
            count,
            inertia: [0.0; MOST_HUBS],
            target: [0.0; MOST_HUBS],
            change: [0.0; MOST_HUBS],
            step: [0.0; MOST_HUBS],
            matrix: [[0.0; MOST_HUBS]; MOST_HUBS],
        }
    }

    /// Overwrites `step` (the right-hand side) with the solution, by L D L'; destroys the matrix.
    ///
    /// `N` is the number of hubs. One division a column and no root: this stands in the way of everything else.
    #[inline(always)]
    #[expect(clippy::needless_range_loop, reason = "the indices are the formula")]
    pub(super) fn solve<const N: usize>(&mut self) {
        let (l, x) = (&mut self.matrix, &mut self.step);
        let mut inverse = [0.0; N];
        for j in 0..N {
            inverse[j] = 1.0 / l[j][j];
            for i in j + 1..N {
                // Row i of L times D, kept; the rows below are reduced by it.
                let factor = l[i][j] * inverse[j];
                for k in j + 1..=i {
                    l[i][k] -= factor * l[k][j];
                }
                x[i] -= factor * x[j];
            }
        }
        for j in (0..N).rev() {
            let mut known = x[j];
            for i in j + 1..N {
                known -= l[i][j] * x[i];
            }
            x[j] = known * inverse[j];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_positive_definite_system() {
        let mut hubs = Hubs::new(3);
        let matrix = [[4.0, 1.0, -2.0], [1.0, 3.0, 0.5], [-2.0, 0.5, 5.0]];
        let x = [1.0, -2.0, 0.25];
        for i in 0..3 {
            hubs.matrix[i][..=i].copy_from_slice(&matrix[i][..=i]);
            hubs.step[i] = (0..3).map(|j| matrix[i][j] * x[j]).sum();
        }
        hubs.solve::<3>();
        for (found, wanted) in hubs.step.iter().zip(x) {
            assert!((found - wanted).abs() < 1e-15, "{found} {wanted}");
        }
    }
}
