//! The closest-point search of [`closest`](crate::Epitrochoid::penetrating_foot) for several points at once.
//!
//! The same Newton steps and the same certificates, lane by lane; all lanes step until the last has
//! converged. A lane that Newton cannot settle is handed to the scalar search, so the result is the
//! scalar one up to rounding.

use pulp::Simd;

use crate::Epitrochoid;
use crate::closest::{RAY_BESIDE, RAY_MARGIN, RAY_STEPS};
use crate::lanes::{ComplexLanes, Lanes, Mask};

/// Feet of several points; where `inside` is not set the values hold no meaning.
#[derive(Debug, Clone, Copy)]
pub struct FeetLanes<S: Simd> {
    /// Set where the point lies inside the curve.
    pub inside: Mask<S>,
    /// C at the foot, m.
    pub position: ComplexLanes<S>,
    /// Outward unit normal.
    pub normal: ComplexLanes<S>,
    /// Depth below the curve, m (> 0 where inside).
    pub depth: Lanes<S>,
    /// kappa, 1/m.
    pub curvature: Lanes<S>,
}

/// Largest |da| for which the long series of e^{i da} is exact to rounding.
const SERIES_LIMIT: f64 = 0.125;
/// Same for the short one, which then serves e^{i zk da} as well.
const SHORT_LIMIT: f64 = 2e-3;
/// Lanes whose tangential residual is below this share of R, or less on sharp curves, take one more step and are done.
const TANGENTIAL_TOLERANCE: f64 = 4e-9;
const MAX_STEPS: usize = 8;

/// The curve at several parameters.
struct AtLanes<S: Simd> {
    position: ComplexLanes<S>,
    normal: ComplexLanes<S>,
    /// R over the speed.
    inverse: Lanes<S>,
    curvature: Lanes<S>,
}

/// The same without a square root or a division: what Newton's steps need.
struct RoughLanes<S: Simd> {
    position: ComplexLanes<S>,
    /// N = n sqrt(g).
    outward: ComplexLanes<S>,
    /// g = |N|^2, the square of the speed in units of R.
    square: Lanes<S>,
    /// kappa g^{3/2}.
    bend: Lanes<S>,
}

/// 1 - x^2/2 + ..., given the Taylor coefficients of the alternating series in x^2, highest first.
#[inline(always)]
fn alternating<S: Simd>(x2: Lanes<S>, coefficients: &[f64]) -> Lanes<S> {
    let mut sum = x2.like(coefficients[0]);
    for &c in &coefficients[1..] {
        sum = x2.mul_add(-sum, x2.like(c));
    }
    sum
}

/// e^{i x} for |x| <= [`SERIES_LIMIT`].
#[inline(always)]
fn turn_by<S: Simd>(x: Lanes<S>) -> ComplexLanes<S> {
    let x2 = x * x;
    let cos = alternating(
        x2,
        &[
            1.0 / 3_628_800.0,
            1.0 / 40_320.0,
            1.0 / 720.0,
            1.0 / 24.0,
            0.5,
            1.0,
        ],
    );
    let sin = alternating(
        x2,
        &[
            1.0 / 39_916_800.0,
            1.0 / 362_880.0,
            1.0 / 5_040.0,
            1.0 / 120.0,
            1.0 / 6.0,
            1.0,
        ],
    );
    ComplexLanes::new(cos, x * sin)
}

/// e^{i x} for |x| <= [`SHORT_LIMIT`].
#[inline(always)]
fn turn_by_little<S: Simd>(x: Lanes<S>) -> ComplexLanes<S> {
    let x2 = x * x;
    let cos = alternating(x2, &[1.0 / 24.0, 0.5, 1.0]);
    let sin = alternating(x2, &[1.0 / 120.0, 1.0 / 6.0, 1.0]);
    ComplexLanes::new(cos, x * sin)
}

impl Epitrochoid {
    #[inline(always)]
    fn rough_lanes<S: Simd>(
        &self,
        unit: ComplexLanes<S>,
        multiple: ComplexLanes<S>,
    ) -> RoughLanes<S> {
        let c = |x: f64| unit.re.like(x);
        let (r, m, zk) = (self.pitch_radius, self.shortening, f64::from(self.sleeves));
        let cos_lobe = unit.dot(multiple);
        RoughLanes {
            position: multiple.scale_add(c(self.eccentricity), unit.scale(c(r))),
            outward: multiple.scale_add(c(m), unit),
            square: cos_lobe.mul_add(c(2.0 * m), c(1.0 + m * m)),
            bend: cos_lobe.mul_add(c(m * (1.0 + zk) / r), c((1.0 + m * m * zk) / r)),
        }
    }

    #[inline(always)]
    fn refined<S: Simd>(&self, rough: &RoughLanes<S>) -> AtLanes<S> {
        let inverse = rough.square.sqrt().recip();
        AtLanes {
            position: rough.position,
            normal: rough.outward.scale(inverse),
            inverse,
            curvature: rough.bend * (inverse * inverse * inverse),
        }
    }

    #[inline(always)]
    fn at_lanes<S: Simd>(&self, unit: ComplexLanes<S>, multiple: ComplexLanes<S>) -> AtLanes<S> {
        self.refined(&self.rough_lanes(unit, multiple))
    }

    /// Feet of the points `p` that lie inside the curve, searched from e^{ia} = `unit` and
    /// e^{i zk a} = `multiple` (common to all lanes). Lanes that are not `present` are never inside.
    #[must_use]
    #[inline(always)]
    pub fn penetrating_feet<S: Simd>(
        &self,
        p: ComplexLanes<S>,
        unit: ComplexLanes<S>,
        multiple: ComplexLanes<S>,
        present: Mask<S>,
    ) -> FeetLanes<S> {
        let c = |x: f64| p.re.like(x);
        let (mut u, mut v) = (unit, multiple);
        let tolerance = TANGENTIAL_TOLERANCE * self.settling * self.pitch_radius;
        let short = c(SHORT_LIMIT / f64::from(self.sleeves));
        let zk = c(f64::from(self.sleeves));
        let zero = c(0.0);
        // Lanes still looking for their foot, and those Newton gave up: no lane is ever both.
        let mut open = present;
        let mut lost = present.without(present);
        // Lanes whose last step began too far from the foot to end at it.
        let mut far = present;
        let mut last_step = pinwheel_faults::armed(pinwheel_faults::Fault::StaleFoot);
        let mut steps = 0;
        // s and t are r.n and r.(i n); the loop has both times sqrt(g) and compares squares.
        let (rough, big_s) = loop {
            let rough = self.rough_lanes(u, v);
            let g = rough.square;
            let r = p - rough.position;
            let big_s = r.dot(rough.outward);
            // |r|^2 < 2 reach s.
            let (distance, reach) = (r.dot(r), c(2.0 * self.reach_outside) * big_s);
            let outside = zero
                .less(big_s)
                .and((distance * distance * g).less(reach * reach));
            open = open.without(outside);
            if last_step || steps == MAX_STEPS || !open.any() {
                if !last_step {
                    lost = lost.or(open.and(far));
                    open = open.without(far);
                }
                break (rough, big_s);
            }
            let big_t = r.dot(rough.outward.turned());
            // da = t/(speed (1 + kappa s)), both sides of the fraction times g^2.
            let g_square = g * g;
            let slope = rough.bend.mul_add(big_s, g_square);
            let da = big_t * g * (c(self.pitch_radius) * slope).recip();
            // NaN fails both tests and is lost, too.
            let fine = (c(0.05) * g_square)
                .less(slope)
                .and(da.abs().less(c(SERIES_LIMIT)));
            lost = lost.or(open.without(fine));
            open = open.and(fine);
            let da = da.only(open);
            if short.less(da.abs()).any() {
                let turn = turn_by(da);
                u = u * turn;
                v = v * turn.powu(self.sleeves);
            } else {
                u = u * turn_by_little(da);
                v = v * turn_by_little(zk * da);
            }
            far = (c(tolerance * tolerance) * g).less(big_t * big_t);
            last_step = !open.and(far).any();
            steps += 1;
        };
        let at = self.refined(&rough);
        let s = big_s * at.inverse;
        let certain = c(-self.reach_inside)
            .less(s)
            .and(s.less(c(self.reach_outside)));
        lost = lost.or(open.without(certain));
        let mut feet = FeetLanes {
            inside: open.and(certain).and(s.less(c(0.0))),
            position: at.position,
            normal: at.normal,
            depth: -s,
            curvature: at.curvature,
        };
        if lost.any() {
            lost = lost.without(self.outside_by_ray_lanes(p, unit, multiple));
        }
        if lost.any() {
            self.find_lost(p, unit, multiple, lost, &mut feet);
        }
        feet
    }

    /// Where the ray from the origin through `p` certainly leaves the curve before it reaches `p`; see
    /// `outside_by_ray` of the scalar search.
    #[inline(always)]
    fn outside_by_ray_lanes<S: Simd>(
        &self,
        p: ComplexLanes<S>,
        unit: ComplexLanes<S>,
        multiple: ComplexLanes<S>,
    ) -> Mask<S> {
        let c = |x: f64| p.re.like(x);
        let radius = p.dot(p).sqrt();
        let ray = p.scale(radius.recip());
        let (mut u, mut v) = (unit, multiple);
        let mut at = self.at_lanes(u, v);
        for _ in 0..RAY_STEPS {
            // The tangent is n turned; moving along it by w/(tangent x ray) brings C onto the ray.
            let slope = at.normal.turned().cross(ray);
            let da = -at.position.cross(ray) * at.inverse * (c(self.pitch_radius) * slope).recip();
            let turn = turn_by(da.only(da.abs().less(c(SERIES_LIMIT))));
            u = u * turn;
            v = v * turn.powu(self.sleeves);
            at = self.at_lanes(u, v);
        }
        let (along, beside) = (at.position.dot(ray), at.position.cross(ray).abs());
        let margin = beside.mul_add(c(2.0 * self.steepest), c(RAY_MARGIN * self.pitch_radius));
        (along + margin)
            .less(radius)
            .and(beside.less(c(RAY_BESIDE) * radius))
            .and(c(0.0).less(along))
    }

    /// The scalar search for the lanes that need it.
    #[cold]
    #[inline(never)]
    fn find_lost<S: Simd>(
        &self,
        p: ComplexLanes<S>,
        unit: ComplexLanes<S>,
        multiple: ComplexLanes<S>,
        lost: Mask<S>,
        feet: &mut FeetLanes<S>,
    ) {
        let mut inside = p.re.like(1.0).only(feet.inside);
        for k in (0..Lanes::<S>::COUNT).filter(|&k| lost.lane(k)) {
            inside.as_mut_slice()[k] = 0.0;
            if let Some(foot) = self.penetrating_foot(p.lane(k), unit.lane(k), multiple.lane(k)) {
                inside.as_mut_slice()[k] = 1.0;
                feet.position.set_lane(k, foot.at.position);
                feet.normal.set_lane(k, foot.at.normal);
                feet.depth.as_mut_slice()[k] = -foot.distance;
                feet.curvature.as_mut_slice()[k] = foot.at.curvature;
            }
        }
        feet.inside = p.re.like(0.5).less(inside);
    }
}
