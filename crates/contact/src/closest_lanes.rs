//! The closest-point search of [`closest`](crate::Epitrochoid::penetrating_foot) for eight points at once.
//!
//! The same Newton steps and the same certificates, lane by lane; all lanes step until the last has
//! converged. A lane that Newton cannot settle is handed to the scalar search, so the result is the
//! scalar one up to rounding.

use crate::lanes::{ComplexLanes, LANES, Lanes, Mask};
use crate::{Complex, Epitrochoid};

/// Feet of eight points; lanes whose mask is 0 are not inside the curve and hold no meaning.
#[derive(Debug, Clone, Copy)]
pub struct FeetLanes {
    /// 1 where the point lies inside the curve.
    pub inside: Mask,
    /// C at the foot, m.
    pub position: ComplexLanes,
    /// Outward unit normal.
    pub normal: ComplexLanes,
    /// Depth below the curve, m (> 0 where inside).
    pub depth: Lanes,
    /// kappa, 1/m.
    pub curvature: Lanes,
}

/// Largest |da| for which the series of e^{i da} below is exact to rounding.
const SERIES_LIMIT: f64 = 0.125;
/// As in the scalar search, relative to R.
const TANGENTIAL_TOLERANCE: f64 = 1.5e-8;
const MAX_STEPS: usize = 8;

/// The curve at eight parameters.
struct AtLanes {
    position: ComplexLanes,
    normal: ComplexLanes,
    inverse_speed: Lanes,
    curvature: Lanes,
}

/// e^{i x} for |x| <= [`SERIES_LIMIT`].
#[inline(always)]
fn small_turn(x: Lanes) -> ComplexLanes {
    let c = Lanes::splat;
    let x2 = x * x;
    let cos = c(1.0)
        - x2 * (c(0.5) - x2 * (c(1.0 / 24.0) - x2 * (c(1.0 / 720.0) - x2 * (c(1.0 / 40_320.0) - x2 * c(1.0 / 3_628_800.0)))));
    let sin = x
        * (c(1.0)
            - x2 * (c(1.0 / 6.0)
                - x2 * (c(1.0 / 120.0) - x2 * (c(1.0 / 5_040.0) - x2 * (c(1.0 / 362_880.0) - x2 * c(1.0 / 39_916_800.0))))));
    ComplexLanes::new(cos, sin)
}

impl Epitrochoid {
    #[inline(always)]
    fn at_lanes(&self, unit: ComplexLanes, multiple: ComplexLanes) -> AtLanes {
        let c = Lanes::splat;
        let (r, m, zk) = (self.pitch_radius, self.shortening, f64::from(self.sleeves));
        let cos_lobe = unit.dot(multiple);
        let inverse = (c(1.0 + m * m) + c(2.0 * m) * cos_lobe).sqrt().recip();
        let bend = c((1.0 + m * m * zk) / r) + c(m * (1.0 + zk) / r) * cos_lobe;
        AtLanes {
            position: unit.scale(c(r)) + multiple.scale(c(self.eccentricity)),
            normal: (unit + multiple.scale(c(m))).scale(inverse),
            inverse_speed: c(1.0 / r) * inverse,
            curvature: bend * (inverse * inverse * inverse),
        }
    }

    /// Feet of the points `p` that lie inside the curve, searched from e^{ia} = `unit` and
    /// e^{i zk a} = `multiple` (common to all lanes).
    #[must_use]
    #[inline(always)]
    pub fn penetrating_feet(&self, p: ComplexLanes, unit: ComplexLanes, multiple: Complex) -> FeetLanes {
        let c = Lanes::splat;
        let (mut u, mut v) = (unit, ComplexLanes::splat(multiple));
        let tolerance = TANGENTIAL_TOLERANCE * self.pitch_radius;
        let twice_reach = c(2.0 * self.reach_outside);
        // Lanes still looking for their foot.
        let mut open = c(1.0);
        let mut lost = Lanes::ZERO;
        let mut last_step = false;
        let mut steps = 0;
        let (at, s) = loop {
            let at = self.at_lanes(u, v);
            let r = p - at.position;
            let s = r.dot(at.normal);
            let outside = r.dot(r).less(twice_reach * s);
            open = Lanes::ZERO.or_where_not(outside, open);
            if last_step || steps == MAX_STEPS || !open.any() {
                if !last_step {
                    lost = open;
                }
                break (at, s);
            }
            let t = r.dot(at.normal.turned());
            let slope = c(1.0) + at.curvature * s;
            let da = t * at.inverse_speed * slope.recip();
            // NaN fails both tests and is lost, too.
            let fine = c(0.05).less(slope) * da.abs().less(c(SERIES_LIMIT));
            let follow = open * fine;
            lost = lost + (open - follow);
            open = follow;
            let turn = small_turn(da.or_where_not(follow, Lanes::ZERO));
            u = u * turn;
            v = v * turn.powu(self.sleeves);
            last_step = !(open * c(tolerance).less(t.abs())).any();
            steps += 1;
        };
        let certain = c(-self.reach_inside).less(s) * s.less(c(self.reach_outside));
        lost = lost + (open - open * certain);
        let inside = open * certain * s.less(Lanes::ZERO);
        let mut feet =
            FeetLanes { inside, position: at.position, normal: at.normal, depth: -s, curvature: at.curvature };
        if lost.any() {
            self.find_lost(p, unit, multiple, lost, &mut feet);
        }
        feet
    }

    /// The scalar search for the lanes that need it.
    #[cold]
    #[inline(never)]
    fn find_lost(&self, p: ComplexLanes, unit: ComplexLanes, multiple: Complex, lost: Mask, feet: &mut FeetLanes) {
        for k in (0..LANES).filter(|&k| lost.0[k] != 0.0) {
            feet.inside.0[k] = 0.0;
            if let Some(foot) = self.penetrating_foot(p.lane(k), unit.lane(k), multiple) {
                feet.inside.0[k] = 1.0;
                feet.position.set_lane(k, foot.at.position);
                feet.normal.set_lane(k, foot.at.normal);
                feet.depth.0[k] = -foot.distance;
                feet.curvature.0[k] = foot.at.curvature;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]

        /// Lane by lane the scalar search, for any gear, pose and backlash.
        #[test]
        fn lanes_are_the_scalar_search(
            zk in 3_u32..60, m in 0.2_f64..0.95, backlash in 0.0_f64..1e-3, first in 0_u32..60,
            input in 0.0_f64..7.0, lag in -0.02_f64..0.02, shift in 0.0_f64..2e-4, towards in 0.0_f64..7.0,
        ) {
            let curve = Epitrochoid::new(0.0028, zk, m).unwrap();
            let theta = (std::f64::consts::PI - input) / f64::from(curve.lobes()) + lag;
            let centre = Complex::unit(input).scale(0.0028) + Complex::unit(towards).scale(shift);
            let back = Complex::unit(-theta);
            let multiple = back.powu(zk);
            let mut p = ComplexLanes::splat(Complex::default());
            let mut unit = p;
            for k in 0..LANES {
                let beta = std::f64::consts::TAU * f64::from((first + k as u32) % zk) / f64::from(zk);
                p.set_lane(k, (Complex::unit(beta).scale(curve.pitch_radius() + backlash) - centre) * back);
                unit.set_lane(k, Complex::unit(beta) * back);
            }
            let feet = curve.penetrating_feet(p, unit, multiple);
            for k in 0..LANES {
                let scalar = curve.penetrating_foot(p.lane(k), unit.lane(k), multiple);
                // On the curve itself rounding decides; nothing acts there.
                let depth = scalar.map_or(0.0, |foot| -foot.distance);
                if depth > 1e-15 {
                    prop_assert!(feet.inside.0[k] != 0.0);
                }
                if feet.inside.0[k] != 0.0 {
                    prop_assert!((feet.depth.0[k] - depth).abs() < 1e-15, "{} {depth}", feet.depth.0[k]);
                    if let Some(foot) = scalar {
                        prop_assert!((feet.normal.lane(k) - foot.at.normal).norm() < 1e-11);
                        prop_assert!((feet.curvature.0[k] / foot.at.curvature - 1.0).abs() < 1e-9 || foot.at.curvature.abs() < 1.0);
                    }
                }
            }
        }
    }
}
