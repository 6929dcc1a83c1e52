//! Columns of one friction stage: one entry a pair, or one a sleeve.

use pinwheel_contact::Lanes;
use pulp::Simd;

use super::super::columns::PADDING;

/// Columns of a pair of wheel and sleeve; 0 where there is no contact.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pair {
    /// Sliding speed per rate of the sleeve, m.
    Sleeve,
    /// ... of the wheel, m.
    Wheel,
    /// ... of the output, m.
    Output,
    /// Closing speed per rate of the wheel, m.
    ClosingWheel,
    /// ... of the output, m.
    ClosingOutput,
    /// Closing speed at the target rates v*, m/s.
    Closing,
    /// K, N/m^1.5.
    Stiffness,
    /// delta, m.
    Penetration,
    /// F_n at v*, N.
    Listed,
    /// F_n at the rates of the last pass, N.
    Force,
    /// u, sliding speed at the present rates, m/s.
    Slip,
    /// Change of u along the Newton step, m/s.
    SlipStep,
}
const PAIR_COLUMNS: usize = Pair::SlipStep as usize + 1;

/// Columns of a sleeve.
#[derive(Debug, Clone, Copy)]
pub(super) enum Leaf {
    /// Moment of inertia, kg m^2; 1 where there is no sleeve.
    Inertia,
    /// Its inverse.
    Inverse,
    /// v - v*, rad/s.
    Change,
    /// Newton step, rad/s.
    Step,
    /// Right-hand side over the diagonal, rad/s.
    Free,
    /// Border over the diagonal, by hub, 1. The last of the columns: there are as many as hubs.
    Border,
}

/// The pairs of one group of lanes.
#[derive(Clone, Copy)]
pub(super) struct Pairs<'a, S: Simd> {
    table: &'a Table,
    simd: S,
    from: usize,
}

impl<S: Simd> Pairs<'_, S> {
    #[inline(always)]
    pub(super) fn get(&self, column: Pair) -> Lanes<S> {
        self.table.load(self.simd, column as usize, self.from)
    }
}

/// Columns side by side in one block of memory, padded to whole groups of lanes.
#[derive(Debug, Clone)]
pub(super) struct Table {
    length: usize,
    data: Vec<f64>,
    /// By entry: the group that starts there has contacts. Values of others are left over.
    active: Vec<bool>,
}

impl Table {
    fn new(count: usize, columns: usize) -> Self {
        let length = count.next_multiple_of(PADDING);
        Self {
            length,
            data: vec![0.0; length * columns],
            active: vec![false; length],
        }
    }

    pub(super) fn of_pairs(count: usize) -> Self {
        Self::new(count, PAIR_COLUMNS)
    }

    pub(super) fn of_leaves(count: usize, hubs: usize) -> Self {
        let mut table = Self::new(count, Leaf::Border as usize + hubs);
        let length = table.length;
        table.data[..2 * length].fill(1.0); // inertia and its inverse
        table
    }

    /// No group has contacts.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.active.fill(false);
    }

    /// The group that starts at `from` has contacts.
    #[inline(always)]
    pub(super) fn activate(&mut self, from: usize) {
        self.active[from] = true;
    }

    /// Whether the group that starts at `from` has contacts.
    #[inline(always)]
    pub(super) fn is_active(&self, from: usize) -> bool {
        self.active[from]
    }

    #[inline(always)]
    pub(super) fn column(&mut self, column: usize) -> &mut [f64] {
        &mut self.data[column * self.length..(column + 1) * self.length]
    }

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, column: usize, from: usize) -> Lanes<S> {
        let at = column * self.length + from;
        Lanes::load(simd, &self.data[at..at + Lanes::<S>::COUNT])
    }

    #[inline(always)]
    pub(super) fn store<S: Simd>(&mut self, column: usize, from: usize, value: Lanes<S>) {
        let at = column * self.length + from;
        value.store(&mut self.data[at..at + Lanes::<S>::COUNT]);
    }

    /// The pairs of the group that starts at `from`.
    #[inline(always)]
    pub(super) fn pairs<S: Simd>(&self, simd: S, from: usize) -> Pairs<'_, S> {
        Pairs {
            table: self,
            simd,
            from,
        }
    }

    #[inline(always)]
    pub(super) fn put<S: Simd>(&mut self, column: Pair, from: usize, value: Lanes<S>) {
        self.store(column as usize, from, value);
    }

    #[inline(always)]
    pub(super) fn leaf<S: Simd>(&self, simd: S, column: Leaf, from: usize) -> Lanes<S> {
        self.load(simd, column as usize, from)
    }

    /// Starts of the groups.
    #[inline(always)]
    pub(super) fn groups<S: Simd>(&self) -> impl Iterator<Item = usize> + use<S> {
        (0..self.length).step_by(Lanes::<S>::COUNT)
    }
}
