//! The semi-smooth Newton method of [`pinwheel_mbs::sliding::SlidingProblem`] in lanes.
//!
//! ```text
//! minimise over d:  1/2 d' M d + a sum_c L_c v_s H(u_c / v_s),   u_c = u*_c + J_c d,   L = mu F_n
//! ```

use pinwheel_contact::{Lanes, Mask, NormalLaw};
use pulp::Simd;

use super::table::{Leaf, Pair};
use super::{INTERNAL, KINDS, Sliding};

/// Newton steps at most; a gear takes 1 to 4.
const MOST_STEPS: usize = 1000;
/// Line searches end when the slope along the step fell to this share.
const SLOPE_SHARE: f64 = 0.1;
/// Newton ends when no sliding speed moves by more than this share of its ramp.
const RATE_SHARE: f64 = 1e-10;
/// And when no rate moves by more than its rounding.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Hubs that sleeves of a kind touch: only internal ones are carried by the output, the last.
#[inline(always)]
fn touched<const HUBS: usize>(kind: usize) -> usize {
    if kind == INTERNAL { HUBS } else { HUBS - 1 }
}

impl Sliding {
    /// Minimises from the present d. False when something is not finite, or when [`MOST_STEPS`] were not enough.
    /// `HUBS` is wheels + 1.
    #[inline(always)]
    pub(super) fn minimise<S: Simd, L: NormalLaw, const HUBS: usize>(
        &mut self,
        simd: S,
        law: L,
        a: f64,
        rates: &[f64],
    ) -> bool {
        self.start::<S, L, HUBS>(simd, law);
        for _ in 0..MOST_STEPS {
            self.assemble::<S, HUBS>(simd, a);
            self.hubs.solve::<HUBS>();
            self.newton_steps += 1;
            if self.along_step::<S, HUBS>(simd) {
                // Nothing begins to stick or slide: the function is quadratic so far, and this its minimum.
                self.take::<S, HUBS, false>(simd, 1.0);
                return self.is_finite::<HUBS>();
            }
            if self.step_is_rounding(rates) {
                return true;
            }
            let Some(share) = self.line_search::<S, HUBS>(simd, a) else {
                return false;
            };
            if self.take::<S, HUBS, true>(simd, share) && share == 1.0 {
                return self.is_finite::<HUBS>();
            }
        }
        false
    }

    #[inline(always)]
    fn is_finite<const HUBS: usize>(&self) -> bool {
        self.hubs.step[..HUBS].iter().all(|x| x.is_finite())
    }

    /// u and F_n at the rates to begin with: the table has those at v*.
    #[inline(always)]
    fn start<S: Simd, L: NormalLaw, const HUBS: usize>(&mut self, simd: S, law: L) {
        let output = Lanes::splat(simd, self.hubs.change[HUBS - 1]);
        for kind in 0..KINDS {
            for from in self.groups::<S>(kind) {
                let own = self.leaves[kind].leaf(simd, Leaf::Change, from);
                for w in 0..HUBS - 1 {
                    let table = &mut self.pairs[w][kind];
                    if !table.is_active(from) {
                        continue;
                    }
                    let at = table.pairs(simd, from);
                    let wheel = own.like(self.hubs.change[w]);
                    let mut slip = at.get(Pair::Sleeve).mul_add(own, at.get(Pair::Slip));
                    slip = at.get(Pair::Wheel).mul_add(wheel, slip);
                    let closing = at.get(Pair::Closing);
                    let mut closing = at.get(Pair::ClosingWheel).mul_add(wheel, closing);
                    if kind == INTERNAL {
                        slip = at.get(Pair::Output).mul_add(output, slip);
                        closing = at.get(Pair::ClosingOutput).mul_add(output, closing);
                    }
                    let depth = at.get(Pair::Penetration);
                    let force = law.force_lanes(at.get(Pair::Stiffness), depth, closing);
                    let force = force.only(force.like(0.0).less(depth));
                    table.put(Pair::Slip, from, slip);
                    table.put(Pair::Force, from, force);
                }
            }
        }
    }

    /// H and the negative gradient, the leaves eliminated.
    #[inline(always)]
    fn assemble<S: Simd, const HUBS: usize>(&mut self, simd: S, a: f64) {
        let wheels = HUBS - 1;
        let zero = Lanes::splat(simd, 0.0);
        let slope = zero.like(a * self.friction.coefficient / self.friction.ramp);
        let mut matrix = [[zero; HUBS]; HUBS];
        let mut rhs = [zero; HUBS];
        for kind in 0..KINDS {
            for from in self.groups::<S>(kind) {
                let inertia = self.leaves[kind].leaf(simd, Leaf::Inertia, from);
                let change = self.leaves[kind].leaf(simd, Leaf::Change, from);
                let mut diagonal = inertia;
                let mut own = -(inertia * change);
                let mut border = [zero; HUBS];
                for w in 0..wheels {
                    let table = &self.pairs[w][kind];
                    if !table.is_active(from) {
                        continue;
                    }
                    let at = table.pairs(simd, from);
                    let (slip, force) = (at.get(Pair::Slip), at.get(Pair::Force));
                    let (leaf, wheel) = (at.get(Pair::Sleeve), at.get(Pair::Wheel));
                    let push = self.slide(simd, slip) * force * zero.like(a);
                    own = own - leaf * push;
                    rhs[w] = rhs[w] - wheel * push;
                    let sticking = slope * force;
                    let weight = sticking - sticking.only(self.slides(slip));
                    let (on_leaf, on_wheel) = (weight * leaf, weight * wheel);
                    diagonal = on_leaf.mul_add(leaf, diagonal);
                    border[w] = on_leaf.mul_add(wheel, border[w]);
                    matrix[w][w] = on_wheel.mul_add(wheel, matrix[w][w]);
                    if kind == INTERNAL {
                        let output = at.get(Pair::Output);
                        rhs[wheels] = rhs[wheels] - output * push;
                        border[wheels] = on_leaf.mul_add(output, border[wheels]);
                        matrix[wheels][w] = on_wheel.mul_add(output, matrix[wheels][w]);
                        let on_output = weight * output;
                        matrix[wheels][wheels] = on_output.mul_add(output, matrix[wheels][wheels]);
                    }
                }
                let inverse = diagonal.recip();
                let leaves = &mut self.leaves[kind];
                leaves.store(Leaf::Free as usize, from, own * inverse);
                for (i, row) in matrix.iter_mut().enumerate().take(touched::<HUBS>(kind)) {
                    let over = border[i] * inverse;
                    leaves.store(Leaf::Border as usize + i, from, over);
                    rhs[i] = rhs[i] - over * own;
                    for (entry, &other) in row[..=i].iter_mut().zip(&border) {
                        *entry = *entry - over * other;
                    }
                }
            }
        }
        let system = &mut self.hubs;
        for i in 0..HUBS {
            system.step[i] = rhs[i].sum() - system.inertia[i] * system.change[i];
            for (entry, sum) in system.matrix[i].iter_mut().zip(&matrix[i][..=i]) {
                *entry = sum.sum();
            }
            system.matrix[i][i] += system.inertia[i];
        }
    }

    /// The leaves' steps and the change of every sliding speed. True if all contacts stay as they are
    /// at the end of the step.
    #[inline(always)]
    fn along_step<S: Simd, const HUBS: usize>(&mut self, simd: S) -> bool {
        let mut steps = [Lanes::splat(simd, 0.0); HUBS];
        for (step, &x) in steps.iter_mut().zip(&self.hubs.step) {
            *step = Lanes::splat(simd, x);
        }
        let mut same = true;
        for kind in 0..KINDS {
            for from in self.groups::<S>(kind) {
                let leaves = &mut self.leaves[kind];
                let mut own = leaves.leaf(simd, Leaf::Free, from);
                for (i, &step) in steps.iter().enumerate().take(touched::<HUBS>(kind)) {
                    own = own - leaves.load(simd, Leaf::Border as usize + i, from) * step;
                }
                leaves.store(Leaf::Step as usize, from, own);
                for w in 0..HUBS - 1 {
                    let table = &mut self.pairs[w][kind];
                    if !table.is_active(from) {
                        continue;
                    }
                    let at = table.pairs(simd, from);
                    let (slip, force) = (at.get(Pair::Slip), at.get(Pair::Force));
                    let mut change = at.get(Pair::Sleeve) * own;
                    change = at.get(Pair::Wheel).mul_add(steps[w], change);
                    if kind == INTERNAL {
                        change = at.get(Pair::Output).mul_add(steps[HUBS - 1], change);
                    }
                    table.put(Pair::SlipStep, from, change);
                    same &= !self.differs(slip, slip + change, force).any();
                }
            }
        }
        same
    }

    /// Moves by `share` of the step. True if no contact changed between sticking and sliding, or none moved; this
    /// is only looked at with `LOOK`.
    #[inline(always)]
    fn take<S: Simd, const HUBS: usize, const LOOK: bool>(&mut self, simd: S, share: f64) -> bool {
        let part = Lanes::splat(simd, share);
        let mut settled = true;
        for kind in 0..KINDS {
            for from in self.groups::<S>(kind) {
                let leaves = &mut self.leaves[kind];
                let step = leaves.leaf(simd, Leaf::Step, from);
                let change = step.mul_add(part, leaves.leaf(simd, Leaf::Change, from));
                leaves.store(Leaf::Change as usize, from, change);
                for w in 0..HUBS - 1 {
                    let table = &mut self.pairs[w][kind];
                    if !table.is_active(from) {
                        continue;
                    }
                    let at = table.pairs(simd, from);
                    let (before, force) = (at.get(Pair::Slip), at.get(Pair::Force));
                    let after = at.get(Pair::SlipStep).mul_add(part, before);
                    table.put(Pair::Slip, from, after);
                    if !LOOK {
                        continue;
                    }
                    let moved = part
                        .like(RATE_SHARE * self.friction.ramp)
                        .less((after - before).abs());
                    settled &= !self.differs(before, after, force).and(moved).any();
                }
            }
        }
        for (change, step) in self.hubs.change.iter_mut().zip(&self.hubs.step) {
            *change += share * step;
        }
        settled
    }

    /// Where friction is at its limit.
    #[inline(always)]
    fn slides<S: Simd>(&self, slip: Lanes<S>) -> Mask<S> {
        slip.like(self.friction.ramp).less(slip.abs())
    }

    /// Where a pressed contact sticks at one speed and slides at the other, or slides the other way.
    #[inline(always)]
    fn differs<S: Simd>(&self, before: Lanes<S>, after: Lanes<S>, force: Lanes<S>) -> Mask<S> {
        let apart = (self.state(before) - self.state(after)).abs();
        let zero = before.like(0.0);
        zero.less(apart).and(zero.less(force))
    }

    /// -1, 0, 1: sliding backwards, sticking, sliding forwards.
    #[inline(always)]
    fn state<S: Simd>(&self, slip: Lanes<S>) -> Lanes<S> {
        let (one, ramp) = (slip.like(1.0), slip.like(self.friction.ramp));
        one.only(ramp.less(slip)) - one.only(slip.less(-ramp))
    }

    /// True if no rate moves by more than rounding. Rare, so one after the other.
    fn step_is_rounding(&mut self, rates: &[f64]) -> bool {
        let small = |step: f64, change: f64, target: f64| {
            step.abs() <= ROUNDING * ((target + change).abs() + target.abs())
        };
        let hubs = &self.hubs;
        if !(0..hubs.count).all(|k| small(hubs.step[k], hubs.change[k], hubs.target[k])) {
            return false;
        }
        let mut first = 1 + self.wheels;
        for (leaves, &count) in self.leaves.iter_mut().zip(&self.counts) {
            for k in 0..count {
                let step = leaves.column(Leaf::Step as usize)[k];
                let change = leaves.column(Leaf::Change as usize)[k];
                if !small(step, change, rates[first + k]) {
                    return false;
                }
            }
            first += count;
        }
        true
    }

    /// Derivative of the function along the step, at share `s` of it.
    #[inline(always)]
    fn slope<S: Simd, const HUBS: usize>(&self, simd: S, a: f64, s: f64) -> f64 {
        let part = Lanes::splat(simd, s);
        let (mut kinetic, mut friction) = (part.like(0.0), part.like(0.0));
        for kind in 0..KINDS {
            for from in self.groups::<S>(kind) {
                let leaves = &self.leaves[kind];
                let step = leaves.leaf(simd, Leaf::Step, from);
                let change = step.mul_add(part, leaves.leaf(simd, Leaf::Change, from));
                kinetic = (leaves.leaf(simd, Leaf::Inertia, from) * change).mul_add(step, kinetic);
                for w in 0..HUBS - 1 {
                    let table = &self.pairs[w][kind];
                    if !table.is_active(from) {
                        continue;
                    }
                    let at = table.pairs(simd, from);
                    let du = at.get(Pair::SlipStep);
                    let slip = du.mul_add(part, at.get(Pair::Slip));
                    friction = (self.slide(simd, slip) * at.get(Pair::Force)).mul_add(du, friction);
                }
            }
        }
        let hubs = &self.hubs;
        let own: f64 = (0..hubs.count)
            .map(|k| hubs.inertia[k] * (hubs.change[k] + s * hubs.step[k]) * hubs.step[k])
            .sum();
        own + kinetic.sum() + a * friction.sum()
    }

    /// Share of the step to take: 1 where the function still falls there, else near the minimum along it.
    #[inline(always)]
    fn line_search<S: Simd, const HUBS: usize>(&self, simd: S, a: f64) -> Option<f64> {
        let (start, end) = (
            self.slope::<S, HUBS>(simd, a, 0.0),
            self.slope::<S, HUBS>(simd, a, 1.0),
        );
        if !(start.is_finite() && end.is_finite()) {
            return None;
        }
        let enough = SLOPE_SHARE * start.abs();
        if end <= enough {
            return Some(1.0);
        }
        // The slope rises along the step and changes sign: regula falsi, halved where it stalls (Illinois).
        let (mut low, mut high) = ((0.0, start), (1.0, end));
        for _ in 0..60 {
            let s = high.0 - high.1 * (high.0 - low.0) / (high.1 - low.1);
            if !(s > 0.0 && s < 1.0) {
                break;
            }
            let here = self.slope::<S, HUBS>(simd, a, s);
            if here.abs() <= enough {
                return Some(s);
            }
            if here < 0.0 {
                low = (s, here);
                high.1 *= 0.5;
            } else {
                high = (s, here);
                low.1 *= 0.5;
            }
        }
        Some(0.5 * (low.0 + high.0))
    }
}
