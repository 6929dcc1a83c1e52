//! Closest point on the epitrochoid: Newton's method where it is certain, a global search elsewhere.
//!
//! With r = P - C(a), s = r . n and t = r . tangent, the foot has t = 0 and
//! dt/d(arc) = -(1 + kappa s), so one Newton step moves along the arc by t/(1 + kappa s).
//!
//! Two certificates make the local search exact, both from the reach rho of the curve:
//! * *outside*: a ball of radius rho that touches C from outside contains no point of C. If P
//!   lies in the one touching at C(a), that is if `|r|^2 < 2 rho s`, P is outside, for any a. In the concentric ball
//!   that is smaller by L, that is if `|r|^2 < 2 rho (s - L) + L^2`, P is farther from C than L.
//! * *foot*: a stationary point with |s| < rho is the closest point of the entire curve.
//!
//! Where Newton's method fails (pins lifted off a pit by backlash are near its centre of curvature), a third test usually
//! decides. C is star-shaped about the origin, so that P is outside if the ray through it leaves the curve earlier.

use crate::{Complex, Epitrochoid, Foot, Scalar};

/// Tangential residual, as a share of R, below which Newton has converged; smaller on sharp curves. The step that follows
/// squares the error.
const TANGENTIAL_TOLERANCE: f64 = 1.5e-8;
/// Tangential residual, as a share of R, and distance, as a share of the reach, below which a Newton step ends nearer to the foot
/// than any two points of a discrete profile are to each other.
const NEAR_TANGENTIAL: f64 = 1e-3;
const NEAR_REACH: f64 = 0.5;
/// Newton steps before the global search takes over; the usual number is 1 to 3.
const MAX_STEPS: usize = 12;

/// Newton steps towards the point of the curve on a ray.
const RAY_STEPS: usize = 3;
/// Distance that a point must lie beyond the curve to be outside for certain, relative to R.
const RAY_MARGIN: f64 = 1e-12;
/// Largest distance from the ray after these steps, relative to the distance of P. The bound of the radius is proved up to it
/// (the steepest slope is at least 1e-3), and is wrong far from the ray.
const RAY_BESIDE: f64 = 1e-3;

/// Result of the local search.
enum Local {
    /// P is certainly outside.
    Outside,
    /// Closest point of the entire curve.
    Foot(Foot),
    /// No certain result.
    Unknown,
}

impl Epitrochoid {
    /// Returns the foot of `p` if its signed distance from the curve is below `limit`, m: 0 for points inside the curve, other
    /// values for a pin whose radius is not the offset of the edge.
    ///
    /// The search begins at e^{ia} and e^{i zk a} of a parameter, which affect the result only by rounding.
    #[inline]
    pub fn foot_within(&self, p: Complex, start: [Complex; 2], limit: f64) -> Option<Foot> {
        self.within::<false>(p, start, limit)
    }

    /// Returns e^{ia} near the foot of `p` if its signed distance from the curve may be below `limit`, m, for a search of discrete
    /// points from there; arguments as in [`foot_within`](Self::foot_within).
    #[inline]
    pub fn unit_within(&self, p: Complex, start: [Complex; 2], limit: f64) -> Option<Complex> {
        let foot = self.within::<true>(p, start, limit)?;
        Some(foot.unit)
    }

    #[inline]
    fn within<const NEAR: bool>(
        &self,
        p: Complex,
        start: [Complex; 2],
        limit: f64,
    ) -> Option<Foot> {
        let result = match self.has_offset() {
            true => self.local_search::<true, NEAR>(p, start, limit),
            false => self.local_search::<false, NEAR>(p, start, limit),
        };
        match result {
            Local::Outside => None,
            Local::Foot(foot) => (foot.distance < limit).then_some(foot),
            Local::Unknown if self.outside_by_ray(p, start, limit.max(0.0)) => None,
            Local::Unknown => self.foot_by_search(p, limit),
        }
    }

    /// True if the ray from the origin through `p` certainly leaves the curve before it reaches `p`, and `p` is farther from
    /// the curve than `away`, m.
    ///
    /// C(a) is moved along its tangent onto the ray. The remaining distance w from the ray changes the radius by less than w
    /// times the steepest slope of the curve against circles. Points within `away` of `p` lie within asin(away/|p|) of the ray,
    /// and |p| - away or more from the origin. That is too far for the curve, whose radius grows by e^(slope angle) at most.
    #[doc(hidden)]
    pub fn outside_by_ray(&self, p: Complex, start: [Complex; 2], away: f64) -> bool {
        let radius = p.norm();
        let ray = p.scale(1.0 / radius);
        let [mut u, mut v] = start;
        for _ in 0..RAY_STEPS {
            let at = self.place(u, v);
            let da = -at.position.cross(ray) / (at.normal.turned().cross(ray) * at.speed);
            if !(da.abs() < 0.5) {
                return false;
            }
            let turn = Complex::unit_near_zero(da);
            u = u * turn;
            v = v * turn.powu(self.sleeves);
        }
        let at = self.place(u, v);
        let (along, beside) = (at.position.dot(ray), at.position.cross(ray).abs());
        let margin = 2.0 * self.steepest * beside + RAY_MARGIN * self.pitch_radius;
        let growth = (self.steepest * (away / radius).asin()).exp();
        along > 0.0 && beside < RAY_BESIDE * radius && (along + margin) * growth < radius - away
    }

    /// Searches globally; this case is rare and kept out of the hot path.
    #[cold]
    #[inline(never)]
    fn foot_by_search(&self, p: Complex, limit: f64) -> Option<Foot> {
        if p.norm() >= self.pitch_radius + self.eccentricity + self.moved() + limit.max(0.0) {
            return None;
        }
        let foot = self.closest(p);
        (foot.distance < limit).then_some(foot)
    }

    /// Searches by Newton's method; with `NEAR` the last step is not evaluated, and the distance is a lower bound.
    fn local_search<const OFFSET: bool, const NEAR: bool>(
        &self,
        p: Complex,
        start: [Complex; 2],
        limit: f64,
    ) -> Local {
        let [mut u, mut v] = start;
        let tolerance = TANGENTIAL_TOLERANCE * self.settling * self.pitch_radius;
        let away = limit.max(0.0);
        let mut last_step = pinwheel_faults::armed(pinwheel_faults::Fault::StaleFoot);
        for _ in 0..MAX_STEPS {
            let at = match OFFSET {
                true => self.place(u, v),
                false => self.at_unit(u, v),
            };
            let r = p - at.position;
            let s = r.dot(at.normal);
            // P is beyond the limit if it lies in the ball that is smaller by `away`.
            let room = self.reach_outside - away;
            if room > 0.0 && r.norm2() < 2.0 * self.reach_outside * (s - away) + away * away {
                return Local::Outside;
            }
            if last_step {
                let certain = s > -self.reach_inside && s < self.reach_outside;
                return if certain {
                    Local::Foot(Foot {
                        unit: u,
                        at,
                        distance: s,
                    })
                } else {
                    Local::Unknown
                };
            }
            let t = r.dot(at.normal.turned());
            let slope = 1.0 + at.curvature * s;
            if slope < 0.05 {
                return Local::Unknown; // near the evolute: Newton does not know where to go
            }
            let da = t / (slope * at.speed);
            if !(da.abs() < 0.5) {
                return Local::Unknown;
            }
            let turn = Complex::unit_near_zero(da);
            u = u * turn;
            if NEAR
                && t.abs() < NEAR_TANGENTIAL * self.settling * self.pitch_radius
                && s > -NEAR_REACH * self.reach_inside
                && s < NEAR_REACH * self.reach_outside
            {
                // The foot is at most 2 t along the tangent, where the curve has left it by less than this.
                let bend = 4.0 * t * t / self.reach_inside.min(self.reach_outside);
                return Local::Foot(Foot {
                    unit: u,
                    at,
                    distance: s - bend,
                });
            }
            v = v * turn.powu(self.sleeves);
            last_step = t.abs() < tolerance;
        }
        Local::Unknown
    }

    /// Returns the foot of `p`, with its derivatives, from the foot `unit` of its value: one Newton step, exact to first order,
    /// for a curve without an offset.
    pub fn foot_beside<S: Scalar>(&self, unit: Complex, p: Complex<S>) -> Foot<S> {
        let at = self.at_unit(unit, unit.powu(self.sleeves));
        let r = p - at.position.like(p.re);
        let (s, t) = (
            r.dot(at.normal.like(p.re)),
            r.dot(at.normal.turned().like(p.re)),
        );
        let da = t / ((p.re.like(1.0) + p.re.like(at.curvature) * s) * p.re.like(at.speed));
        let unit = unit.like(p.re) * Complex::unit(da);
        let at = self.at_unit(unit, unit.powu(self.sleeves));
        Foot {
            unit,
            at,
            distance: (p - at.position).dot(at.normal),
        }
    }

    /// Returns the closest point of the entire curve to any `p`.
    ///
    /// Samples the part of the curve that can be closer than the best known point, brackets every local minimum of the
    /// distance, and refines each by bisection-safeguarded Newton.
    pub fn closest(&self, p: Complex) -> Foot {
        let per_lobe = f64::from(self.samples(40));
        let tau = std::f64::consts::TAU;
        // The closest point is not farther than the one at P's own polar angle, which bounds its polar angle;
        // the polar angle of C(a) differs from a by at most asin((e + |w|)/R).
        let start = p.arg();
        let bound = (p - self.at(start).position).norm();
        let half = if bound < p.norm() {
            ((bound / p.norm()).asin()
                + ((self.eccentricity + self.moved()) / self.pitch_radius).asin())
                * 1.001
        } else {
            std::f64::consts::PI
        };
        let step = tau / (per_lobe * f64::from(self.lobes()));
        let count = (half / step).ceil() as i64 + 1;
        let squared = |a: f64| (p - self.at(a).position).norm2();
        let mut best: Option<(f64, f64)> = None;
        let (mut before, mut here) = (
            squared(start - (count as f64 + 1.0) * step),
            squared(start - count as f64 * step),
        );
        for k in -count..=count {
            let a = start + k as f64 * step;
            let after = squared(a + step);
            if here <= before && here <= after {
                let refined = self.refine(p, a - step, a + step);
                let value = squared(refined);
                if best.is_none_or(|(least, _)| value < least) {
                    best = Some((value, refined));
                }
            }
            (before, here) = (here, after);
        }
        // A full turn always has a minimum; the start replaces the impossible case without one.
        let a = best.map_or(start, |(_, a)| a);
        let unit = Complex::unit(a);
        let at = self.place(unit, unit.powu(self.sleeves));
        Foot {
            unit,
            at,
            distance: (p - at.position).dot(at.normal),
        }
    }

    /// Returns the minimum of |P - C(a)| between `low` and `high`, where (P - C) . C' falls through zero.
    fn refine(&self, p: Complex, mut low: f64, mut high: f64) -> f64 {
        let mut a = 0.5 * (low + high);
        for _ in 0..80 {
            let at = self.at(a);
            let r = p - at.position;
            let t = r.dot(at.normal.turned());
            if t > 0.0 {
                low = a;
            } else {
                high = a;
            }
            let slope = 1.0 + at.curvature * r.dot(at.normal);
            let newton = a + t / (slope * at.speed);
            let inside = slope > 0.0 && newton > low && newton < high;
            let next = if inside { newton } else { 0.5 * (low + high) };
            if (next - a).abs() <= 1e-16 * a.abs().max(1.0) {
                return next;
            }
            a = next;
        }
        a
    }
}
