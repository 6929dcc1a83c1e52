//! Normal contact laws: force as a function of stiffness, penetration and its rate.

/// A penalty law F_n(K, delta, d(delta)/dt) for delta > 0.
///
/// Laws are small copyable values; the contact loop is compiled for each of them.
pub trait NormalLaw: Copy + Send + Sync + 'static {
    /// Normal force, N, never negative. `stiffness` K in N/m^1.5, `penetration` in m (> 0), `rate` in m/s.
    fn force(&self, stiffness: f64, penetration: f64, rate: f64) -> f64;
}

/// S of Eq. 22: 0 below 0, 1 above `width`, linear between.
#[must_use]
#[inline]
pub fn ramp(x: f64, width: f64) -> f64 {
    (x / width).clamp(0.0, 1.0)
}

/// The paper's law (Eq. 20): `F_n = max(0, S(delta) (K delta^1.5 + C v_n))`.
///
/// The maximum is ours: as printed the law pulls when the bodies part quickly.
/// Valid for delta well below the radii. Because K varies along the profile while the force is
/// normal only, the law has no potential and creates about 1 % energy on the paper's gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperLaw {
    /// C, N s/m.
    pub damping: f64,
    /// Width of S, m.
    pub ramp: f64,
}

impl NormalLaw for PaperLaw {
    #[inline]
    fn force(&self, stiffness: f64, penetration: f64, rate: f64) -> f64 {
        let elastic = stiffness * penetration * penetration.sqrt();
        (ramp(penetration, self.ramp) * (elastic + self.damping * rate)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paper_law_values() {
        let law = PaperLaw {
            damping: 8.0,
            ramp: 1e-5,
        };
        assert_eq!(law.force(1e8, 4e-4, 0.0), 1e8 * 4e-4 * 0.02);
        // Half way up the ramp everything counts half.
        assert!((law.force(1e8, 5e-6, 0.1) - 0.5 * (1e8 * 5e-6_f64.powf(1.5) + 0.8)).abs() < 1e-12);
        assert_eq!(law.force(1e8, 1e-6, -10.0), 0.0);
    }
}
