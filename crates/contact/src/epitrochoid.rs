//! Epitrochoid C on which pin centres lie in contact.
//!
//! ```text
//! C(a)  = R e^{ia} + e e^{i zk a},           R = e zk/m            (Eq. 1 without the offset q)
//! C'(a) = i T,  T = R (e^{ia} + m e^{i zk a}),  |T|^2 = R^2 (1 + m^2 + 2 m c),  c = cos(zs a)
//! n     = T/|T|            outward unit normal, at angle a + gamma of Eq. 1
//! kappa = (1 + m^2 zk + m (1 + zk) c) / (R (1 + m^2 + 2 m c)^{3/2})
//! ```
//! The disc's profile is C - q n. The penetration of a pin of radius q is minus the signed distance of its centre from C, so
//! contact is one closest-point problem on this smooth curve. kappa > 0 where C bulges outwards (lobe), < 0 in a pit.
//!
//! With an offset w(zs a) along the inward normal the curve is C - w n instead. From t = R90 n and n' = kappa s t, s = |C'|:
//!
//! ```text
//! (C - w n)' = A t + B n,   A = s (1 - w kappa),  B = -w'
//! kappa      = (B A' - A B')/(A^2 + B^2)^{3/2} + kappa s/(A^2 + B^2)^{1/2}
//! ```

use crate::lobe_offset::LobeOffset;
use crate::search::Search;
use crate::{Complex, Real, Scalar};

/// Position, direction and curvature at one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint<R = f64> {
    /// C(a), m.
    pub position: Complex<R>,
    /// Outward unit normal.
    pub normal: Complex<R>,
    /// |dC/da|, m.
    pub speed: R,
    /// kappa, 1/m.
    pub curvature: R,
}

/// Point of the curve closest to a given point P.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot<R = f64> {
    /// e^{ia} at the foot; its argument is the parameter a.
    pub unit: Complex<R>,
    /// Curve at the foot.
    pub at: CurvePoint<R>,
    /// (P - C) . n, m: positive outside.
    pub distance: R,
}

impl Foot {
    /// Returns the parameter a in (-pi, pi].
    pub fn parameter(&self) -> f64 {
        self.unit.arg()
    }
}

/// Epitrochoid C for given R, e, zk (m = e zk/R), with the radii inside which closest points are certain.
///
/// ```
/// use pinwheel_contact::{Complex, Epitrochoid};
///
/// let curve = Epitrochoid::new(0.0028, 16, 0.7).unwrap(); // the paper's: R = e zk/m = 64 mm, 15 lobes
/// assert!((curve.pitch_radius() - 0.064).abs() < 1e-15);
/// // A point 0.1 mm outside a lobe's flank, and its closest point.
/// let at = curve.at(0.1);
/// let foot = curve.closest(at.position + at.normal.scale(1e-4));
/// assert!((foot.distance - 1e-4).abs() < 1e-15 && (foot.parameter() - 0.1).abs() < 1e-10);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Epitrochoid {
    pub(crate) pitch_radius: f64,
    pub(crate) eccentricity: f64,
    pub(crate) sleeves: u32,
    pub(crate) shortening: f64,
    /// Radius of a ball that touches C from outside (inside) and meets C nowhere else, m.
    #[doc(hidden)]
    pub reach_outside: f64,
    #[doc(hidden)]
    pub reach_inside: f64,
    /// Largest |d(radius)/d(polar angle)| / radius: tan of the angle between normal and radius.
    #[doc(hidden)]
    pub steepest: f64,
    /// Share of the searches' tolerances that this curve requires, at most 1; see `settling_share`.
    #[doc(hidden)]
    pub settling: f64,
    /// Constants of the search in lanes.
    pub(crate) search: Search,
    /// Offset along the inward normal, with its largest size, m, and the extremes of the curvature, 1/m.
    own: Option<(LobeOffset, f64, [f64; 2])>,
}

impl Epitrochoid {
    /// Creates the curve of eccentricity `e` (m), `sleeves` = zk ring pins, 3 or more, and shortening m (0 < m < 1); `None` if
    /// a value is out of range or not finite.
    pub fn new(eccentricity: f64, sleeves: u32, shortening: f64) -> Option<Self> {
        Self::with_offset(eccentricity, sleeves, shortening, None)
    }

    /// Creates the curve with an offset along its inward normal; `None` also if the offset folds the curve, or makes it leave a
    /// ray from the centre twice.
    pub fn with_offset(
        eccentricity: f64,
        sleeves: u32,
        shortening: f64,
        offset: Option<LobeOffset>,
    ) -> Option<Self> {
        let valid = eccentricity.is_finite()
            && eccentricity > 0.0
            && shortening > 0.0
            && shortening < 1.0
            && (3..=100_000).contains(&sleeves);
        if !valid {
            return None;
        }
        let mut curve = Self::unsearched(eccentricity, sleeves, shortening);
        let pitch_radius = curve.pitch_radius;
        if let Some(offset) = offset {
            curve.own = Some((offset.clone(), offset.largest(), [0.0; 2]));
            let bends = curve.bends(&offset)?;
            curve.own.as_mut()?.2 = bends;
        }
        let repulsion;
        (curve.reach_outside, curve.reach_inside, repulsion) = curve.reaches();
        curve.search = Search::new(sleeves, shortening, pitch_radius, repulsion * pitch_radius);
        curve.steepest = curve.steepest_slope();
        curve.settling = curve.settling_share();
        Some(curve)
    }

    /// Creates the curve for its points only, from any numbers; [`closest`](Self::closest) is not available.
    pub fn unsearched(eccentricity: f64, sleeves: u32, shortening: f64) -> Self {
        Self {
            pitch_radius: eccentricity * f64::from(sleeves) / shortening,
            eccentricity,
            sleeves,
            shortening,
            reach_outside: 0.0,
            reach_inside: 0.0,
            steepest: 0.0,
            settling: 1.0,
            search: Search::default(),
            own: None,
        }
    }

    /// True if [`new`](Self::new) makes an equal curve of these parameters.
    pub fn is_of(
        &self,
        eccentricity: f64,
        sleeves: u32,
        shortening: f64,
        offset: Option<&LobeOffset>,
    ) -> bool {
        (self.eccentricity, self.sleeves, self.shortening) == (eccentricity, sleeves, shortening)
            && self.own.as_ref().map(|own| &own.0) == offset
    }

    /// True if the curve has an offset along its normal.
    pub fn has_offset(&self) -> bool {
        self.own.is_some()
    }

    /// Returns the largest distance from the curve without its offset, m.
    pub(crate) fn moved(&self) -> f64 {
        self.own.as_ref().map_or(0.0, |own| own.1)
    }

    /// Returns the number of samples of a lobe that resolve the curve.
    pub(crate) fn samples(&self, usual: u32) -> u32 {
        self.own
            .as_ref()
            .map_or(usual, |own| usual.max(own.0.samples()))
    }

    /// Returns bounds of the curvature: the extremes of samples, widened by the change between them; `None` where the offset
    /// folds the curve, or makes it leave a ray from the centre twice.
    fn bends(&self, offset: &LobeOffset) -> Option<[f64; 2]> {
        // Multiple of the knots, at which the curvature has kinks.
        let samples = offset.samples() * 960_u32.div_ceil(offset.samples());
        let step = std::f64::consts::TAU / f64::from(samples * self.lobes());
        let mut bends = [f64::INFINITY, f64::NEG_INFINITY];
        let mut last = [-2, -1].map(|k| self.at(f64::from(k) * step).curvature);
        for k in 0..samples {
            let a = f64::from(k) * step;
            let (at, unit) = (self.at(a), Complex::unit(a));
            let bare = self.at_unit(unit, unit.powu(self.sleeves));
            let folds = at.normal.dot(bare.normal) <= 0.0 || at.position.dot(at.normal) <= 0.0;
            if folds || !at.curvature.is_finite() {
                return None;
            }
            let [before, here] = last;
            let margin = (before - 2.0 * here + at.curvature).abs();
            bends = [bends[0].min(here - margin), bends[1].max(here + margin)];
            last = [here, at.curvature];
        }
        Some(bends)
    }

    /// Returns R, m.
    pub fn pitch_radius(&self) -> f64 {
        self.pitch_radius
    }

    /// Returns H: a point P is certainly outside where `H |r|^2 < r.T` for any a, with `r = (P - C(a))/R` and `T = e^{ia} + m
    /// e^{i zk a}`.
    pub fn repulsion(&self) -> f64 {
        self.search.repulsion
    }

    /// Returns the number of lobes zs = zk - 1.
    pub fn lobes(&self) -> u32 {
        self.sleeves - 1
    }

    /// Returns the curve at parameter `a`, rad.
    pub fn at(&self, a: f64) -> CurvePoint {
        let unit = Complex::unit(a);
        self.place(unit, unit.powu(self.sleeves))
    }

    /// Returns the curve at e^{ia} = `unit`, with e^{i zk a} = `multiple`, its offset included.
    #[inline]
    pub(crate) fn place(&self, unit: Complex, multiple: Complex) -> CurvePoint {
        let at = self.at_unit(unit, multiple);
        match &self.own {
            None => at,
            Some((offset, ..)) => self.moved_point(offset, at, [unit, multiple]),
        }
    }

    /// Returns the point of the modified curve, from the point `at` of the unmodified curve.
    #[inline(never)]
    fn moved_point(
        &self,
        offset: &LobeOffset,
        at: CurvePoint,
        [unit, multiple]: [Complex; 2],
    ) -> CurvePoint {
        let (zs, sin_lobe) = (f64::from(self.lobes()), unit.cross(multiple));
        let [w, first, second] = offset.at(sin_lobe.atan2(unit.dot(multiple)));
        let (slope, bend) = (zs * first, zs * zs * second);
        let (s, kappa, n) = (at.speed, at.curvature, at.normal);
        let s_slope = -self.pitch_radius * self.pitch_radius * self.shortening * zs * sin_lobe / s;
        let kappa_slope = self.bare_slope(unit, multiple);
        let (along, inward) = (s * (1.0 - w * kappa), -slope);
        let along_slope = s_slope * (1.0 - w * kappa) - s * (slope * kappa + w * kappa_slope);
        let speed = along.hypot(inward);
        CurvePoint {
            position: at.position - n.scale(w),
            normal: (n.scale(along) + n.turned().scale(slope)).scale(1.0 / speed),
            speed,
            curvature: (inward * along_slope + along * bend) / speed.powi(3) + kappa * s / speed,
        }
    }

    /// Returns the curve without its offset at e^{ia} = `unit`, with e^{i zk a} = `multiple`.
    #[inline]
    pub fn at_unit<R: Real>(&self, unit: Complex<R>, multiple: Complex<R>) -> CurvePoint<R> {
        let cos_lobe = unit.dot(multiple); // cos(zs a)
        let c = |x: f64| cos_lobe.like(x);
        let (r, m) = (c(self.pitch_radius), self.shortening);
        let stretch2 = c(1.0 + m * m) + c(2.0 * m) * cos_lobe; // (|T|/R)^2
        let stretch = stretch2.sqrt();
        let inverse = c(1.0) / stretch;
        CurvePoint {
            position: unit.scale(r) + multiple.scale(c(self.eccentricity)),
            normal: (unit + multiple.scale(c(m))).scale(inverse),
            speed: r * stretch,
            curvature: self.bend(cos_lobe) * inverse * inverse * inverse / r,
        }
    }

    /// Returns kappa R (1 + m^2 + 2 m c)^{3/2}, the numerator of the curvature.
    #[inline]
    fn bend<R: Real>(&self, cos_lobe: R) -> R {
        let (m, zk) = (self.shortening, f64::from(self.sleeves));
        cos_lobe.like(1.0 + m * m * zk) + cos_lobe.like(m * (1.0 + zk)) * cos_lobe
    }

    /// Returns kappa as a function of c = cos(zs a), 1/m.
    pub fn curvature(&self, cos_lobe: f64) -> f64 {
        let m = self.shortening;
        self.bend(cos_lobe) / (self.pitch_radius * (1.0 + m * m + 2.0 * m * cos_lobe).powf(1.5))
    }

    /// Returns d kappa/da at e^{ia} = `unit`, with e^{i zk a} = `multiple`, 1/m.
    pub fn curvature_slope<S: Scalar>(&self, unit: Complex<S>, multiple: Complex<S>) -> S {
        /// Step of the finite differences for a curve with an offset, rad of a lobe's phase.
        const STEP: f64 = 1e-4;
        if self.own.is_none() {
            return self.bare_slope(unit, multiple);
        }
        let a = unit.im.value().atan2(unit.re.value());
        let step = STEP / f64::from(self.lobes());
        let change = self.at(a + step).curvature - self.at(a - step).curvature;
        unit.re.like(0.5 * change / step)
    }

    /// Returns d kappa/da of the curve without its offset.
    fn bare_slope<R: Real>(&self, unit: Complex<R>, multiple: Complex<R>) -> R {
        let (m, zk) = (self.shortening, f64::from(self.sleeves));
        let (cos_lobe, sin_lobe) = (unit.dot(multiple), unit.cross(multiple));
        let c = |x: f64| cos_lobe.like(x);
        let stretch2 = c(1.0 + m * m) + c(2.0 * m) * cos_lobe;
        let slope = c(m) * (c(1.0 + zk) * stretch2 - c(3.0) * self.bend(cos_lobe))
            / (c(self.pitch_radius) * stretch2 * stretch2 * stretch2.sqrt());
        -slope * c(zk - 1.0) * sin_lobe
    }

    /// Returns the largest curvature of the curve, 1/m: an offset q at or beyond its inverse undercuts the profile.
    ///
    /// Between the ends c = +-1 the extremum has d kappa/dc = 0, that is
    /// `(1 + zk)(1 + m^2 + 2 m c) = 3 (1 + m^2 zk + m (1 + zk) c)`, linear in c. It lies above -1 by
    /// `(1 - m)(zk - 2 + (2 zk - 1) m)/(m (1 + zk))`, and kappa is larger at 1 than at -1 as `zk (1 + m^2) > 2`.
    pub fn largest_curvature(&self) -> f64 {
        if let Some((_, _, [_, largest])) = self.own {
            return largest;
        }
        let (m, zk) = (self.shortening, f64::from(self.sleeves));
        let cos_lobe = ((1.0 + zk) * (1.0 + m * m) - 3.0 * (1.0 + m * m * zk)) / (m * (1.0 + zk));
        let tip = self.curvature(1.0);
        if cos_lobe < 1.0 {
            tip.max(self.curvature(cos_lobe))
        } else {
            tip
        }
    }

    /// Returns tan of the largest angle between normal and radius, from samples of half a lobe, or of all with an offset, with a
    /// margin.
    fn steepest_slope(&self) -> f64 {
        let half = std::f64::consts::PI / f64::from(self.lobes());
        let samples = 2 * self.samples(64);
        let last = if self.has_offset() { samples } else { 64 };
        let slope = |k: u32| {
            let at = self.at(f64::from(k) / f64::from(samples / 2) * half);
            (at.position.cross(at.normal) / at.position.dot(at.normal)).abs()
        };
        1.1 * (0..=last).map(slope).fold(0.0, f64::max) + 1e-3
    }

    /// A Newton step from the tangential residual t ends beside the foot by about `t^2 |speed'|/(2 speed^2)`, where the normal
    /// differs by kappa times that. The result is exact to rounding only if t is small against both. Sharp pits and many lobes
    /// require smaller residuals, in proportion to 1/sqrt of the product (in units of R), from samples of half a lobe.
    fn settling_share(&self) -> f64 {
        /// Largest product for which the tolerances suffice unchanged; the paper's curve has 1942.
        const GENTLE: f64 = 2000.0;
        let (m, half) = (
            self.shortening,
            std::f64::consts::PI / f64::from(self.lobes()),
        );
        if self.has_offset() {
            let samples = self.samples(128);
            let step = 2.0 * half / f64::from(samples);
            let product = |k: u32| {
                let [at, next] = [k, k + 1].map(|k| self.at(f64::from(k) * step));
                let uneven = 0.5 * (next.speed - at.speed) / (step * at.speed * at.speed);
                (uneven * at.curvature).abs() * self.pitch_radius.powi(2)
            };
            let largest = (0..samples).map(product).fold(0.0, f64::max);
            return (GENTLE / largest).sqrt().min(1.0);
        }
        let product = |k: u32| {
            let a = f64::from(k) / 64.0 * half;
            let (sin_lobe, cos_lobe) = (f64::from(self.lobes()) * a).sin_cos();
            let stretch2 = 1.0 + m * m + 2.0 * m * cos_lobe;
            let uneven =
                0.5 * m * f64::from(self.lobes()) * sin_lobe / (stretch2 * stretch2.sqrt());
            (uneven * self.curvature(cos_lobe) * self.pitch_radius).abs()
        };
        let largest = (0..=64).map(product).fold(0.0, f64::max);
        (GENTLE / largest).sqrt().min(1.0)
    }

    /// Returns the reach of the curve to either side [Federer 1959]: inf |y - x|^2 / (2 |(y - x) . n_x|), outside and inside,
    /// m. The third value is the largest sqrt(g)/(2 rho), with rho the local reach outside, 1/m.
    ///
    /// Samples of half a lobe, which mirrors the other half, are compared with the entire curve. The result is lowered by a
    /// margin for the sampling; the curvature bound, which the samples approach last, is exact.
    fn reaches(&self) -> (f64, f64, f64) {
        const LANES: usize = 4;
        let lobes = self.lobes();
        let per_lobe = self.samples(48);
        // Distant lobes matter only across the disc; thinning them keeps huge gears cheap.
        let stride = (lobes / 256).max(1);
        let step = std::f64::consts::TAU / f64::from(lobes * per_lobe);
        let (mut xs, mut ys) = (Vec::new(), Vec::new());
        for k in 0..lobes * per_lobe {
            if k / per_lobe < 3 || k / per_lobe >= lobes - 3 || k % stride == 0 {
                let other = self.at(f64::from(k) * step).position;
                xs.push(other.re);
                ys.push(other.im);
            }
        }
        // Padding to full lanes with the first place, which changes nothing.
        let padded = xs.len().next_multiple_of(LANES);
        xs.resize(padded, xs[0]);
        ys.resize(padded, ys[0]);
        let (mut outside, mut inside) = (f64::INFINITY, f64::INFINITY);
        let mut repulsion: f64 = 0.0;
        // Lobes with an offset are not symmetric.
        let last = if self.has_offset() {
            per_lobe
        } else {
            per_lobe / 2
        };
        for k in 0..=last {
            let x = self.at(f64::from(k) * step);
            let mut here = 10.0 * self.pitch_radius;
            if x.curvature < 0.0 {
                here = here.min(-1.0 / x.curvature);
            }
            // Half the curvatures of the balls that touch here and meet the curve there, by side; NaN for the place itself,
            // which affects no extreme.
            let (mut most, mut least) = ([0.0; LANES], [0.0; LANES]);
            for (xs, ys) in xs.chunks_exact(LANES).zip(ys.chunks_exact(LANES)) {
                for lane in 0..LANES {
                    let (cx, cy) = (xs[lane] - x.position.re, ys[lane] - x.position.im);
                    let bend = (cx * x.normal.re + cy * x.normal.im) / (cx * cx + cy * cy);
                    most[lane] = if bend > most[lane] { bend } else { most[lane] };
                    least[lane] = if bend < least[lane] {
                        bend
                    } else {
                        least[lane]
                    };
                }
            }
            here = here.min(0.5 / most.into_iter().fold(0.0, f64::max));
            inside = inside.min(0.5 / least.into_iter().fold(0.0, f64::min).abs());
            outside = outside.min(here);
            repulsion = repulsion.max(x.speed / (2.0 * here * self.pitch_radius));
        }
        let sharpest_pit = -self
            .own
            .as_ref()
            .map_or(self.curvature(-1.0), |own| own.2[0]);
        if sharpest_pit > 0.0 {
            outside = outside.min(1.0 / sharpest_pit);
        }
        inside = inside.min(1.0 / self.largest_curvature());
        // A convex curve has no bound outside; the value stays finite.
        (
            0.9 * outside.min(10.0 * self.pitch_radius),
            0.9 * inside,
            repulsion / 0.9,
        )
    }
}
