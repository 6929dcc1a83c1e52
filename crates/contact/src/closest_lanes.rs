//! Closest-point search of [`closest`](crate::Epitrochoid::foot_within) for several points at once.
//!
//! A point P is taken relative to C(a0), a0 near its foot, in directions turned by a0 and in units of R: with q the offset,
//! E = e^{i zs a0}, and for a = a0 + d
//!
//! ```text
//! T1 = e^{id},  T2 = m E e^{i zk d},  T = T1 + T2,  r = q - (T1 - 1) - (T2 - m E)/zk     C' = R i T,  r = P - C
//! f(d) = T x r = 0                        the foot: three sinusoids, whose n-th derivative is (g = |T|^2)
//! -f'  = g + r.T1 + zk r.T2,    f'' = 3 zs T1 x T2 - T1 x r - zk^2 T2 x r
//! f^(n)(0) =  +-(lobe's constants, times m cos zs a0 or m sin zs a0)  +- (zk^n m) q.E or q.iE      for n >= 3
//! ```
//! The Taylor series of f is reversed to fifth order; the remainder for a usual offset is below rounding after one step of
//! third order (Halley's, by f''). The error of that step decides whether it was the last: twice (f''/2f')^2 d^3, and f'''
//! d^3/6f'. Offsets are small against R, so that no digits are lost to the radius.
//!
//! Certificates are those of the scalar search. The outside one is reduced to one number: a ball that touches C(a) from outside
//! may have the radius rho(a), and P is outside where `H |r|^2 < r.T`, `H = max sqrt(g)/(2 rho)` over the curve. Lanes that do
//! not converge are passed to the scalar search, so the results are equal up to rounding.

use pinwheel_faults::{Fault, factor};
use pulp::Simd;

use crate::lanes::{ComplexLanes, Lanes, Mask};
use crate::search::Search;
use crate::{Complex, Epitrochoid, Real};

/// Feet of several points; values are undefined where `inside` is not set.
#[derive(Debug, Clone, Copy)]
pub struct FeetLanes<S: Simd> {
    /// C at the foot, m.
    pub position: ComplexLanes<S>,
    /// Outward unit normal.
    pub normal: ComplexLanes<S>,
    /// Quantities of the foot that do not depend on the directions.
    pub foot: LocalFeet<S>,
}

/// Feet relative to C(a0), in directions turned by a0; values are undefined where `inside` is not set.
#[derive(Debug, Clone, Copy)]
pub struct LocalFeet<S: Simd> {
    /// Set where the point lies inside the curve.
    pub inside: Mask<S>,
    /// Depth below the curve, m (> 0 where inside).
    pub depth: Lanes<S>,
    /// Outward normal times sqrt(g): T.
    pub outward: ComplexLanes<S>,
    /// e^{i(a - a0)}.
    pub turn: ComplexLanes<S>,
    /// m cos(zs a).
    pub cos: Lanes<S>,
    /// m sin(zs a).
    pub sin: Lanes<S>,
    /// 1/sqrt(g), g = 1 + m^2 + 2 m cos(zs a).
    pub inverse: Lanes<S>,
    /// kappa, 1/m.
    pub curvature: Lanes<S>,
}

/// Longest step, as zk d, for which all terms of the series of e^{i zk d} are exact to rounding.
const LONGEST: f64 = 0.3;
/// Step, as zk d, up to which fewer terms suffice, mainly for e^{id}, as zk is at least 3.
const SHORT: f64 = 0.1;
/// Length, as zk d, up to which a last step needs the fewest terms.
const LAST: f64 = 1e-4;
/// Terms for e^{id} and e^{i zk d}.
const ALL_TERMS: [usize; 2] = [5, 5];
const SHORT_TERMS: [usize; 2] = [3, 4];
const LAST_TERMS: [usize; 2] = [1, 1];
/// Largest remainder after a last step, as zk d.
const SETTLED: f64 = 1e-14;
/// Least share of g that -f' counts as. Smaller values occur near the evolute, where Newton's step is unreliable, and prevent
/// convergence.
const STEEP: f64 = 0.05;
const MAX_STEPS: usize = 8;

/// Coefficients of (1 - cos x)/x^2 and of sin x/x in x^2, alternating, highest first.
const COS: [f64; 5] = [
    1.0 / 3_628_800.0,
    1.0 / 40_320.0,
    1.0 / 720.0,
    1.0 / 24.0,
    0.5,
];
const SIN: [f64; 6] = [
    1.0 / 39_916_800.0,
    1.0 / 362_880.0,
    1.0 / 5_040.0,
    1.0 / 120.0,
    1.0 / 6.0,
    1.0,
];

/// Returns the sum of an alternating series in x^2, coefficients highest first.
#[inline(always)]
fn alternating<S: Simd>(x2: Lanes<S>, coefficients: &[f64]) -> Lanes<S> {
    let mut sum = x2.like(coefficients[0]);
    for &c in &coefficients[1..] {
        sum = x2.mul_add(-sum, x2.like(c));
    }
    sum
}

/// Returns e^{ix} - 1 by the last terms of the series.
#[inline(always)]
fn turned_by<S: Simd>(x: Lanes<S>, terms: usize) -> ComplexLanes<S> {
    let x2 = x * x;
    let cos = alternating(x2, &COS[COS.len() - terms..]);
    let sin = alternating(x2, &SIN[SIN.len() - terms - 1..]);
    ComplexLanes::new(-(x2 * cos), x * sin)
}

/// T1, T2 and r.
#[derive(Clone, Copy)]
struct Pose<S: Simd> {
    turn: ComplexLanes<S>,
    lobe: ComplexLanes<S>,
    offset: ComplexLanes<S>,
}

impl<S: Simd> Pose<S> {
    /// Advances the foot by `step` = zk d.
    #[inline(always)]
    fn step(&mut self, step: Lanes<S>, per_zk: f64, terms: [usize; 2]) {
        let share = step.like(per_zk);
        let turn = self.turn * turned_by(step * share, terms[0]);
        let lobe = self.lobe * turned_by(step, terms[1]);
        self.turn = self.turn + turn;
        self.lobe = self.lobe + lobe;
        self.offset = self.offset - turn - lobe.scale(share);
    }
}

impl Epitrochoid {
    /// Returns the feet of the points `p` inside the curve, searched from e^{ia} = `unit` and e^{i zk a} = `multiple` (common
    /// to all lanes). Lanes that are not `present` are never inside.
    #[inline(always)]
    pub fn penetrating_feet<S: Simd>(
        &self,
        p: ComplexLanes<S>,
        unit: ComplexLanes<S>,
        multiple: ComplexLanes<S>,
        present: Mask<S>,
    ) -> FeetLanes<S> {
        let c = |x: f64| p.re.like(x);
        let start = multiple.scale_add(c(self.eccentricity), unit.scale(c(self.pitch_radius)));
        let offset = (p - start).times_conj(unit);
        let offset = offset.scale(c(self.search.per_radius));
        let phase = multiple.times_conj(unit);
        let along = offset.dot(phase.scale(c(self.shortening)));
        let outside = (c(self.search.repulsion) * offset.dot(offset)).less(offset.re + along);
        let foot = self.local_feet(offset, phase, present.without(outside));
        // C = R T1 + (e/m) T2, and e/m = R/zk.
        let lobe = foot.outward - foot.turn;
        let local = lobe.scale_add(c(self.search.per_zk), foot.turn);
        FeetLanes {
            position: (local * unit).scale(c(self.pitch_radius)),
            normal: (foot.outward * unit).scale(foot.inverse),
            foot,
        }
    }

    /// Returns the feet of the points at `offset` (in units of R) from C(a0), in directions turned by a0, with `phase` = e^{i
    /// zs a0}. Only lanes that are `present` are searched; lanes that are certainly outside by [`repulsion`](Self::repulsion)
    /// may be omitted or not.
    #[inline(always)]
    pub fn local_feet<S: Simd>(
        &self,
        offset: ComplexLanes<S>,
        phase: ComplexLanes<S>,
        present: Mask<S>,
    ) -> LocalFeet<S> {
        let Search {
            zk,
            per_zk,
            shortening: m,
            repulsion,
            per_radius,
            series: [second, third, fourth, fifth],
            third: bend,
        } = self.search;
        let q = offset;
        let c = |x: f64| q.re.like(x);
        let lobe = phase.scale(c(m));
        let (along, across) = (q.dot(lobe), lobe.cross(q));
        let mut open = present;

        // -f' and the other derivatives at a0.
        let (along, across) = (along * c(zk), across * c(zk));
        let g = lobe.re.mul_add(c(2.0), c(1.0 + m * m));
        let slope = g + q.re + along;
        let far = slope.less(c(STEEP) * g);
        let inverse = slope.max(c(STEEP) * g).recip();
        let x = q.im.mul_add(c(zk), across) * inverse;
        let b2 = lobe
            .im
            .mul_add(c(second[1]), (across + q.im * c(per_zk)) * c(0.5))
            * inverse;
        let b3 = lobe
            .re
            .mul_add(c(third[1]), c(third[0]) - along * c(1.0 / 6.0))
            * inverse;
        let b4 = lobe.im.mul_add(c(fourth[1]), -(across * c(1.0 / 24.0))) * inverse;
        let b5 = lobe
            .re
            .mul_add(c(fifth[1]), along.mul_add(c(1.0 / 120.0), c(fifth[0])))
            * inverse;
        let squared = b2 * b2;
        let c3 = squared.mul_add(c(2.0), -b3);
        let c4 = b2.mul_add(b3.mul_add(c(5.0), squared * c(-5.0)), -b4);
        let c5 = b2.mul_add(b4 * c(6.0), b3 * b3 * c(3.0)) - b5
            + squared * squared.mul_add(c(14.0), b3 * c(-21.0));
        let sum = x.mul_add(x.mul_add(x.mul_add(c5, c4), c3), -b2);
        let sum = x.mul_add(sum.only(open.without(far)), c(1.0));

        let mut pose = Pose {
            turn: ComplexLanes::new(c(1.0), c(0.0)),
            lobe,
            offset: q,
        };
        let moves = factor(Fault::StaleFoot, 0.0);
        let mut lost = present.without(present);
        let mut step = x * sum * c(moves);
        let mut steps = 0;
        loop {
            if c(SHORT).less(step.abs()).and(open).any() {
                step = step.max(c(-LONGEST)).min(c(LONGEST));
                pose.step(step.only(open), per_zk, ALL_TERMS);
            } else {
                pose.step(step.only(open), per_zk, SHORT_TERMS);
            }
            let (turn, lobe, r) = (pose.turn, pose.lobe, pose.offset);
            let (along, across) = (lobe.dot(r), lobe.cross(r));
            let (height, beside) = (turn.dot(r), turn.cross(r));
            let g = turn.dot(lobe).mul_add(c(2.0), c(1.0 + m * m));
            let slope = g + along.mul_add(c(zk), height);
            let fine = (c(STEEP) * g).less(slope);
            // A division costs less than another step, which an inaccurate inverse would require.
            let inverse = slope.max(c(STEEP) * g).recip();
            let first = (beside + across) * inverse * c(zk);
            let bending = turn.cross(lobe) * c(1.5 - 1.5 * per_zk)
                - across.mul_add(c(0.5 * zk), beside * c(0.5 * per_zk));
            let share = bending * inverse * first;
            step = share.mul_add(first, first) * c(moves);
            let rest = (share * share).mul_add(c(2.0), first * first * inverse * c(bend));
            let settled = (rest * first.abs())
                .less(c(SETTLED))
                .and(first.abs().less(c(LAST)));
            steps += 1;
            let mut unsettled = open.without(settled.and(fine));
            if !unsettled.any() {
                break;
            }
            // Points that are certainly outside need not converge.
            let outside = (c(repulsion) * r.dot(r)).less(height + along);
            (open, unsettled) = (open.without(outside), unsettled.without(outside));
            if !unsettled.any() {
                break;
            }
            if steps == MAX_STEPS {
                lost = unsettled;
                open = open.without(unsettled);
                break;
            }
        }
        pose.step(step.only(open), per_zk, LAST_TERMS);

        let height = (pose.turn + pose.lobe).dot(pose.offset);
        let mut inside = open.and(height.less(c(0.0)));
        // Beyond either reach the foot may not be the closest point.
        let r = pose.offset;
        let near = c(-self.reach_inside * per_radius * (1.0 - m)).less(height);
        if open.without(near.and(inside)).any() {
            let outside = (c(repulsion) * r.dot(r)).less(height);
            lost = lost.or(open.without(near.and(inside.or(outside))));
        }
        if lost.any() {
            self.find_lost(q, phase, lost, &mut pose, &mut inside);
        }
        let outward = pose.turn + pose.lobe;
        let (cos, sin) = (pose.turn.dot(pose.lobe), pose.turn.cross(pose.lobe));
        let inverse = cos.mul_add(c(2.0), c(1.0 + m * m)).inverse_sqrt();
        let bend = cos.mul_add(
            c((1.0 + zk) * per_radius),
            c((1.0 + m * m * zk) * per_radius),
        );
        LocalFeet {
            inside,
            depth: outward.dot(pose.offset) * inverse * c(-self.pitch_radius),
            outward,
            turn: pose.turn,
            cos,
            sin,
            inverse,
            curvature: bend * (inverse * inverse * inverse),
        }
    }

    /// Runs the scalar search for the lanes that need it.
    #[cold]
    #[inline(never)]
    fn find_lost<S: Simd>(
        &self,
        offset: ComplexLanes<S>,
        phase: ComplexLanes<S>,
        lost: Mask<S>,
        pose: &mut Pose<S>,
        inside: &mut Mask<S>,
    ) {
        let (r, zk) = (self.pitch_radius, self.search.zk);
        let mut mark = offset.re.like(1.0).only(*inside);
        for k in (0..Lanes::<S>::COUNT).filter(|&k| lost.lane(k)) {
            mark.as_mut_slice()[k] = 0.0;
            // Unit number e^{i a0} for any a0 of this phase.
            let phase = phase.lane(k);
            let start = Complex::unit(phase.arg() / (zk - 1.0));
            let local = Complex::ONE + phase.scale(self.shortening / zk) + offset.lane(k);
            let p = (local * start).scale(r);
            if let Some(foot) = self.foot_within(p, [start, start * phase], 0.0) {
                mark.as_mut_slice()[k] = 1.0;
                let turn = foot.unit * start.conj();
                let lobe = foot.unit.powu(self.sleeves) * start.conj();
                let lobe = lobe.scale(self.shortening);
                pose.turn.set_lane(k, turn);
                pose.lobe.set_lane(k, lobe);
                pose.offset.set_lane(k, local - turn - lobe.scale(1.0 / zk));
            }
        }
        // A point on the curve to rounding is inside if the resulting depth is above 0.
        let height = (pose.turn + pose.lobe).dot(pose.offset);
        let mark = offset.re.like(0.5).less(mark);
        *inside = mark.and(height.less(offset.re.like(0.0)));
    }
}
