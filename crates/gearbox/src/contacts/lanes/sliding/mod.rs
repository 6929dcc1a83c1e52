//! Implicit friction of all pairs at once: what [`pinwheel_mbs::sliding`] does contact by contact, in lanes.
//!
//! The convex problem, its Newton steps and its passes are those of that module, which stays as the oracle
//! (test: the same rates and accelerations to rounding). The structure is the gearbox's: sleeves are the leaves, wheels
//! and the output the hubs, and a pair touches one leaf, one wheel and, if the sleeve is internal, the output.
//! Unknown is the change d = v - v* of the free rates, so sliding speeds are those at v* plus `J d`.

mod hubs;
mod newton;
mod split;
mod table;

use pinwheel_contact::{Lanes, NormalLaw, RegularisedCoulomb};
use pinwheel_faults::{Fault, factor};
use pinwheel_mbs::sliding::RateStage;
use pulp::Simd;

use crate::Layout;
use hubs::{Hubs, MOST_HUBS};
pub(super) use split::Split;
use table::{Leaf, Pair, Table};

/// External, internal.
const KINDS: usize = 2;
const INTERNAL: usize = 1;

/// Pairs, sleeves and hubs of one stage.
#[derive(Debug, Clone)]
pub(super) struct Sliding {
    wheels: usize,
    /// By wheel and kind.
    pairs: Vec<[Table; KINDS]>,
    leaves: [Table; KINDS],
    /// Sleeves of each kind.
    counts: [usize; KINDS],
    hubs: Hubs,
    /// Of the free bodies, as the tables hold them; empty before the first stage.
    inertia: Vec<f64>,
    friction: RegularisedCoulomb,
    /// Of the stage at hand.
    newton_steps: u64,
}

impl Sliding {
    /// `None` for more wheels than there is room for.
    pub(super) fn new(layout: Layout, friction: RegularisedCoulomb) -> Option<Self> {
        let counts = [layout.external_sleeves, layout.internal_sleeves];
        let wheels = layout.wheels;
        (wheels < MOST_HUBS).then(|| Self {
            wheels,
            pairs: vec![counts.map(Table::of_pairs); wheels],
            leaves: counts.map(|count| Table::of_leaves(count, wheels + 1)),
            counts,
            hubs: Hubs::new(wheels + 1),
            inertia: Vec::with_capacity(1 + wheels + counts.iter().sum::<usize>()),
            friction,
            newton_steps: 0,
        })
    }

    /// Forgets the contacts of the stage before.
    pub(super) fn clear(&mut self) {
        for table in self.pairs.iter_mut().flatten() {
            table.clear();
        }
    }

    /// Starts of the groups of a kind.
    #[inline(always)]
    fn groups<S: Simd>(&self, kind: usize) -> impl Iterator<Item = usize> + use<S> {
        self.leaves[kind].groups::<S>()
    }

    /// Reads the inertias, where they are not those of the stage before, and the rates; the changes start where the
    /// guess of the friction's accelerations has them.
    /// Free bodies are all but the input, in body order: output, wheels, external and internal sleeves.
    fn begin(&mut self, stage: &RateStage<'_>) {
        if self.inertia != stage.inertia {
            self.read_inertia(stage.inertia);
        }
        let wheels = &stage.rates[1..=self.wheels];
        for (k, &rate) in wheels.iter().chain(&stage.rates[..1]).enumerate() {
            self.hubs.target[k] = rate;
        }
        if stage.a <= 0.0 {
            self.hubs.change.fill(0.0);
            for leaves in &mut self.leaves {
                leaves.column(Leaf::Change as usize).fill(0.0);
            }
            return;
        }
        let (hubs, mut sleeves) = stage.implicit.split_at(1 + self.wheels);
        for (k, guess) in hubs[1..].iter().chain(&hubs[..1]).enumerate() {
            self.hubs.change[k] = stage.a * guess;
        }
        for (leaves, &count) in self.leaves.iter_mut().zip(&self.counts) {
            let (own, rest) = sleeves.split_at(count);
            let changes = &mut leaves.column(Leaf::Change as usize)[..count];
            for (change, guess) in changes.iter_mut().zip(own) {
                *change = stage.a * guess;
            }
            sleeves = rest;
        }
    }

    fn read_inertia(&mut self, inertia: &[f64]) {
        self.inertia.clear();
        self.inertia.extend_from_slice(inertia);
        let (hubs, mut sleeves) = inertia.split_at(1 + self.wheels);
        // Wheels first, the output last.
        for (k, &inertia) in hubs[1..].iter().chain(&hubs[..1]).enumerate() {
            self.hubs.inertia[k] = inertia;
        }
        for (leaves, &count) in self.leaves.iter_mut().zip(&self.counts) {
            let (own, rest) = sleeves.split_at(count);
            leaves.column(Leaf::Inertia as usize)[..count].copy_from_slice(own);
            let inverse = &mut leaves.column(Leaf::Inverse as usize)[..count];
            for (inverse, inertia) in inverse.iter_mut().zip(own) {
                *inverse = inertia.recip();
            }
            sleeves = rest;
        }
    }

    /// Solves the stage of the contacts that a [`Split`] listed. False if there is no solution.
    pub(super) fn solve<L: NormalLaw>(
        &mut self,
        arch: pulp::Arch,
        law: L,
        stage: &mut RateStage<'_>,
    ) -> bool {
        self.begin(stage);
        self.newton_steps = 0;
        let solved = match self.wheels {
            1 => arch.dispatch(Solve::<L, 2>(self, law, stage)),
            2 => arch.dispatch(Solve::<L, 3>(self, law, stage)),
            3 => arch.dispatch(Solve::<L, 4>(self, law, stage)),
            _ => arch.dispatch(Solve::<L, 5>(self, law, stage)),
        };
        stage.newton_steps = self.newton_steps;
        solved
    }

    /// Writes the rates and the accelerations.
    #[inline(always)]
    fn finish<S: Simd>(&mut self, simd: S, stage: &mut RateStage<'_>) {
        let wheels = self.wheels;
        let zero = Lanes::splat(simd, 0.0);
        let sign = zero.like(factor(Fault::FrictionSign, -1.0));
        let (mut friction, mut pressure) = ([zero; MOST_HUBS], [zero; MOST_HUBS]);
        for kind in 0..KINDS {
            for from in self.groups::<S>(kind) {
                let mut own = zero;
                for (w, tables) in self.pairs.iter().enumerate() {
                    if !tables[kind].is_active(from) {
                        continue;
                    }
                    let at = tables[kind].pairs(simd, from);
                    let slide = self.slide(simd, at.get(Pair::Slip)) * at.get(Pair::Force) * sign;
                    let change = at.get(Pair::Force) - at.get(Pair::Listed);
                    own = own - at.get(Pair::Sleeve) * slide;
                    friction[w] = friction[w] - at.get(Pair::Wheel) * slide;
                    friction[wheels] = friction[wheels] - at.get(Pair::Output) * slide;
                    pressure[w] = pressure[w] - at.get(Pair::ClosingWheel) * change;
                    pressure[wheels] = pressure[wheels] - at.get(Pair::ClosingOutput) * change;
                }
                let leaves = &mut self.leaves[kind];
                let inverse = leaves.leaf(simd, Leaf::Inverse, from);
                leaves.store(Leaf::Step as usize, from, own * inverse);
            }
        }
        let mut first = 1 + wheels;
        for (leaves, &count) in self.leaves.iter_mut().zip(&self.counts) {
            let here = first..first + count;
            let changes = &leaves.column(Leaf::Change as usize)[..count];
            for (rate, change) in stage.rates[here.clone()].iter_mut().zip(changes) {
                *rate += change;
            }
            let accelerations = &leaves.column(Leaf::Step as usize)[..count];
            stage.implicit[here].copy_from_slice(accelerations);
            first += count;
        }
        for hub in 0..=wheels {
            let dof = if hub < wheels { 1 + hub } else { 0 };
            stage.rates[dof] += self.hubs.change[hub];
            stage.implicit[dof] = friction[hub].sum() / self.hubs.inertia[hub];
            stage.explicit[dof] = pressure[hub].sum() / self.hubs.inertia[hub];
        }
    }

    /// mu clamp(u/v_s, -1, 1): friction against the sliding per normal force.
    #[inline(always)]
    fn slide<S: Simd>(&self, simd: S, slip: Lanes<S>) -> Lanes<S> {
        let one = Lanes::splat(simd, 1.0);
        let share = slip * one.like(1.0 / self.friction.ramp);
        share.max(-one).min(one) * one.like(self.friction.coefficient)
    }
}

/// The whole stage, compiled once per instruction set, law and number of hubs.
struct Solve<'a, 'b, L, const HUBS: usize>(&'a mut Sliding, L, &'a mut RateStage<'b>);

impl<L: NormalLaw, const HUBS: usize> pulp::WithSimd for Solve<'_, '_, L, HUBS> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self(sliding, law, stage) = self;
        let solved =
            stage.a <= 0.0 || sliding.minimise::<S, L, HUBS>(simd, law, stage.a, stage.rates);
        if solved {
            sliding.finish(simd, stage);
        }
        solved
    }
}
