//! Energy account of a run: distribution of the driver's work.
//!
//! ```text
//! kinetic + stored, end - start  =  work of driver + work of load - lost by damping - lost by sliding + remainder
//! ```
//! Stored energy is the integral of the force at rest over the penetration, at the local stiffness. For a law with a potential
//! the remainder is the error of the run. For the paper's law, whose stiffness varies along the profile while the force is
//! normal only, it is the energy created by the law (about 0.95 %).
//!
//! Works are integrals of powers over equally spaced states of the run by a rule that is exact for cubics (each interval from
//! the cubic through its neighbours). They converge with order 4, and the states with the integrator's order. States are at
//! most `STEPS` steps apart, for any sampling. Where the load jumps, its power jumps: there are two states at that time, one
//! with each load, and no interval's cubic crosses it. Entries between samples are added to the works at once, so that the
//! stored data grow with the samples, not with the steps. States within a method's steps with known forces are entries, too.
//!
//! The uncertainty by the variation between entries is stated with the works (`scatter`).

mod scatter;

use pinwheel_mbs::Observation;
use pinwheel_timeseries::sampling::SAFETY;
use scatter::{Scatter, Two};

use crate::Layout;
use crate::contacts::ContactEnergy;
use crate::scene::Scene;

/// Largest number of steps between two entries: 1e-4 s at the paper's step is 8 entries a period of its fastest oscillation
/// (1.2 kHz), and costs a few per cent of the run.
const STEPS: f64 = 10.0;

/// Relative excess over this number of steps that is rounding.
const ROUNDING: f64 = 1e-6;

/// Relative difference below which intervals are equal: sample times are products and sums of decimal numbers.
const EQUAL: f64 = 1e-9;

/// Least distance of an intermediate entry from one neighbour, relative to the distance to the other. A nearer one adds no
/// information.
const NEAR: f64 = 0.1;

/// Powers, W, or works, J, of driver, load, damping, and friction of contacts, bearings, pins and seals.
type Flows = [f64; 7];

/// Works and energies at the samples of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EnergyAccount {
    /// True for friction of contacts, bearings, pins and seals, if present.
    rubbing: [bool; 4],
    /// Works up to the start of the present segment, J.
    before_segment: Flows,
    segment: Segment,
    /// Intermediate entry, kept until the next entry decides whether their distance suffices.
    passed: Option<(f64, Flows)>,
    scatter: Scatter,
    marks: Vec<Mark>,
}

/// Entry of the account at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Mark {
    time: f64,
    /// Works since the start, J.
    works: Flows,
    /// Kinetic and stored energy, J.
    energies: [f64; 2],
    /// Squares of the uncertainties of the works since the start, J^2.
    off: Two,
}

pub use pinwheel_timeseries::EnergyAudit;

impl EnergyAccount {
    /// Creates an empty account of a run of `scene` with capacity for `samples` samples.
    pub(crate) fn new(scene: &Scene, samples: usize) -> Self {
        Self {
            rubbing: scene.rubbing(),
            marks: Vec::with_capacity(samples),
            ..Self::default()
        }
    }

    /// True if the account needs no entry between two samples.
    #[inline]
    pub(crate) fn is_short(from: f64, to: f64, step: f64) -> bool {
        to - from <= (1.0 + ROUNDING) * STEPS * step
    }

    /// Returns the times between two samples at which entries are due, both ends excluded. `least`: least number of intervals.
    pub fn between(from: f64, to: f64, step: f64, least: u64) -> impl Iterator<Item = f64> {
        let parts = ((to - from) / (STEPS * step) - ROUNDING).ceil();
        let parts = parts.max(least as f64);
        (1..parts as u64).map(move |k| from + (to - from) * k as f64 / parts)
    }

    /// Starts a new segment: its first entry has the time of the last one.
    pub fn restart_at(&mut self) {
        self.before_segment = add(self.before_segment, self.segment.work());
        self.segment = Segment::default();
        self.scatter.restart();
    }

    /// Adds an entry between samples. `load`: N m on the output shaft; `contacts`: energy of the same state.
    pub(crate) fn add(&mut self, load: f64, observed: &Observation<'_>, contacts: &ContactEnergy) {
        self.enter(observed.time, powers(load, observed, contacts));
    }

    /// Adds an intermediate entry, unless another one is close to it.
    pub(crate) fn pass(&mut self, load: f64, observed: &Observation<'_>, contacts: &ContactEnergy) {
        self.settle_passed(observed.time);
        self.passed = Some((observed.time, powers(load, observed, contacts)));
    }

    /// Enters the intermediate entry if it is far enough from the entries before it and at `next`, s.
    #[inline]
    fn settle_passed(&mut self, next: f64) {
        let (Some((time, powers)), Some(last)) = (self.passed.take(), self.segment.last()) else {
            return;
        };
        let (before, after) = (time - last, next - time);
        if before > NEAR * after && after > NEAR * before {
            self.settle(time, powers);
        }
    }

    /// Adds the entry of a sample, at which the account can begin or end.
    pub(crate) fn add_sample(
        &mut self,
        load: f64,
        observed: &Observation<'_>,
        contacts: &ContactEnergy,
    ) {
        self.add(load, observed, contacts);
        self.mark(observed.time, [observed.kinetic_j, contacts.stored_j]);
    }

    /// Marks the last entry as the sample at `time`, s, with kinetic and stored energy, J.
    pub fn mark(&mut self, time: f64, energies: [f64; 2]) {
        self.segment.mark(self.marks.len());
        self.marks.push(Mark {
            time,
            works: add(self.before_segment, self.segment.work()),
            energies,
            off: self.scatter.squares(),
        });
    }

    /// Adds an entry by its powers, W: driver, load, damping, and friction of contacts, bearings, pins and seals.
    #[inline]
    pub fn enter(&mut self, time: f64, powers: Flows) {
        self.settle_passed(time);
        self.settle(time, powers);
    }

    /// Adds an entry and completes the works up to the last samples, whose last intervals it makes more accurate.
    #[inline]
    fn settle(&mut self, time: f64, powers: Flows) {
        let [driver, load, lost @ ..] = powers;
        let lost = lost.iter().sum::<f64>();
        self.scatter.add(time, [driver + load - lost, lost]);
        for entry in self.segment.add(time, powers) {
            if let Some(mark) = entry.mark {
                self.marks[mark].works = add(self.before_segment, entry.work);
            }
        }
    }

    /// Returns the account between the samples nearest to `from` and `to`, s. `None` with fewer than two samples there.
    pub fn audit(&self, from: f64, to: f64) -> Option<EnergyAudit> {
        let marks = &self.marks;
        let nearest = |t: f64| {
            let k = marks.partition_point(|mark| mark.time < t);
            match (k.checked_sub(1), marks.get(k)) {
                (Some(low), Some(high)) if t - marks[low].time < high.time - t => low,
                (Some(low), None) => low,
                _ => k,
            }
        };
        let (from, to) = (nearest(from), nearest(to));
        if from >= to {
            return None;
        }
        Some(self.between_marks(&marks[from], &marks[to]))
    }

    /// Returns the account between the last two samples.
    #[inline]
    pub(crate) fn latest(&self) -> Option<EnergyAudit> {
        match self.marks.as_slice() {
            [.., before, last] if before.time < last.time => Some(self.between_marks(before, last)),
            _ => None,
        }
    }

    /// Returns the account from one sample to another.
    #[inline]
    fn between_marks(&self, a: &Mark, b: &Mark) -> EnergyAudit {
        let [driver_j, load_j, damping_j, rubbed @ ..] =
            std::array::from_fn::<_, 7, _>(|k| b.works[k] - a.works[k]);
        let friction_j: f64 = rubbed.iter().sum();
        let cause = |k: usize| self.rubbing[k].then_some(rubbed[k]);
        let energy = |k: usize| b.energies[k] - a.energies[k];
        let (kinetic_j, stored_j) = (energy(0), energy(1));
        let remainder_j = kinetic_j + stored_j + damping_j + friction_j - driver_j - load_j;
        let energies = [a.energies, b.energies];
        let each = energies.as_flattened().iter();
        let held_j = each.fold(0.0, |most: f64, e| most.max(e.abs()));
        let off = |k: usize| SAFETY * (b.off[k] - a.off[k]).max(0.0).sqrt();
        EnergyAudit {
            from_s: a.time,
            to_s: b.time,
            driver_j,
            load_j,
            kinetic_j,
            stored_j,
            damping_j,
            friction_j,
            contact_friction_j: cause(0),
            bearing_friction_j: cause(1),
            sleeve_friction_j: cause(2),
            seal_friction_j: cause(3),
            remainder_j,
            remainder_share: EnergyAudit::share(remainder_j, driver_j, load_j, held_j),
            remainder_off_j: off(0),
            lost_off_j: off(1),
        }
    }

    /// Returns the account of the entire run.
    pub fn total(&self) -> Option<EnergyAudit> {
        self.audit(f64::NEG_INFINITY, f64::INFINITY)
    }
}

#[inline]
fn powers(load: f64, observed: &Observation<'_>, contacts: &ContactEnergy) -> Flows {
    let driver = observed.driver_torques.first().copied().unwrap_or(0.0);
    let [in_contacts, in_bearings, by_sleeves, by_seals] = contacts.by_cause_w();
    [
        driver * observed.bodies[Layout::INPUT].rate,
        load * observed.bodies[Layout::OUTPUT].rate,
        contacts.damping_w,
        in_contacts,
        in_bearings,
        by_sleeves,
        by_seals,
    ]
}

/// Entry of a segment at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Entry {
    time: f64,
    powers: Flows,
    /// Work from the segment's start, J; of the last entry, as far as its power is known.
    work: Flows,
    /// Index of the sample at this entry, if it is one.
    mark: Option<usize>,
}

/// Last entries of a segment, as many as one interval's cubic needs; earlier ones are included in their works.
#[derive(Debug, Clone, PartialEq, Default)]
struct Segment {
    /// Number of stored entries, the oldest first.
    len: usize,
    /// True if the segment had more entries than are stored.
    cut: bool,
    entries: [Entry; 4],
}

impl Segment {
    /// Adds an entry and returns the entries whose works have changed.
    #[inline]
    fn add(&mut self, time: f64, powers: Flows) -> &[Entry] {
        let new = Entry {
            time,
            powers,
            ..Entry::default()
        };
        if self.len == 4 {
            self.entries.copy_within(1.., 0);
            self.cut = true;
        } else {
            self.len += 1;
        }
        self.entries[self.len - 1] = new;
        // The cubic of an inner interval extends one entry farther on each side. The last interval but one is now final, and
        // with the fourth entry of a segment all before it.
        let first = if self.cut { 2 } else { 1 };
        let even = is_even(&self.entries[..self.len]);
        for k in first..self.len {
            let interval = interval(&self.entries[..self.len], k - 1, even);
            self.entries[k].work = add(self.entries[k - 1].work, interval);
        }
        &self.entries[first.min(self.len)..self.len]
    }

    /// Returns the time of the last entry, s.
    fn last(&self) -> Option<f64> {
        Some(self.entries[self.len.checked_sub(1)?].time)
    }

    /// Returns the works so far, J.
    fn work(&self) -> Flows {
        let last = self.len.checked_sub(1);
        last.map_or([0.0; 7], |k| self.entries[k].work)
    }

    /// Marks the last entry as sample `mark`.
    fn mark(&mut self, mark: usize) {
        if let Some(last) = self.len.checked_sub(1) {
            self.entries[last].mark = Some(mark);
        }
    }
}

fn add(a: Flows, b: Flows) -> Flows {
    std::array::from_fn(|k| a[k] + b[k])
}

/// True for four entries of equal intervals, the usual case.
#[inline]
fn is_even(entries: &[Entry]) -> bool {
    let [a, b, c, d] = entries else {
        return false;
    };
    let h = b.time - a.time;
    let equal = |one: &Entry, next: &Entry| (next.time - one.time - h).abs() < EQUAL * h;
    equal(b, c) && equal(c, d)
}

/// Integrates over [t_k, t_k+1] the polynomial through two to four entries, whose intervals are equal if `even`.
#[inline]
fn interval(entries: &[Entry], k: usize, even: bool) -> Flows {
    let (low, h) = (entries[k].time, entries[k + 1].time - entries[k].time);
    if even {
        // Closed form of the integral for equal intervals.
        let [a, b, c, d]: [f64; 4] = match k {
            0 => [9.0, 19.0, -5.0, 1.0],
            1 => [-1.0, 13.0, 13.0, -1.0],
            _ => [1.0, -5.0, 19.0, 9.0],
        };
        let share = h / 24.0;
        return weighted(entries, [share * a, share * b, share * c, share * d]);
    }
    // Gauss' rule with three points, exact for the cubic.
    let x = 0.5 * 0.6_f64.sqrt();
    let points = [(0.5 - x, 5.0), (0.5, 8.0), (0.5 + x, 5.0)];
    let lagrange = |i: usize, t: f64| -> f64 {
        let others = (0..entries.len()).filter(|&j| j != i);
        let factor = |j: usize| (t - entries[j].time) / (entries[i].time - entries[j].time);
        others.map(factor).product()
    };
    let mut weights = [0.0; 4];
    for (i, weight) in weights.iter_mut().enumerate().take(entries.len()) {
        let parts = points
            .iter()
            .map(|(at, weight)| weight * lagrange(i, low + h * at));
        *weight = h * parts.sum::<f64>() / 18.0;
    }
    weighted(entries, weights)
}

fn weighted(entries: &[Entry], weights: [f64; 4]) -> Flows {
    let mut sum = [0.0; 7];
    for (entry, w) in entries.iter().zip(weights) {
        sum = add(sum, entry.powers.map(|power| w * power));
    }
    sum
}
