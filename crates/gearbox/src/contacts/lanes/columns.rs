//! States and loads of the pins as columns, padded to full groups of lanes.

use pinwheel_contact::{Complex, ComplexLanes, Lanes, Mask};
use pinwheel_mbs::{BodyState, Wrench};
use pulp::Simd;

/// Padding of columns: a multiple of the widest group (two AVX-512 registers).
pub(super) const PADDING: usize = 16;

/// Column of planar vectors.
#[derive(Debug, Clone, Default)]
pub(super) struct Column {
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
}

impl Column {
    pub(super) fn padded(values: impl Iterator<Item = Complex>) -> Self {
        let (mut x, mut y): (Vec<f64>, Vec<f64>) = values.map(|z| (z.re, z.im)).unzip();
        let length = x.len().next_multiple_of(PADDING);
        x.resize(length, 0.0);
        y.resize(length, 0.0);
        Self { x, y }
    }

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, from: usize) -> ComplexLanes<S> {
        let to = from + Lanes::<S>::COUNT;
        ComplexLanes::new(
            Lanes::load(simd, &self.x[from..to]),
            Lanes::load(simd, &self.y[from..to]),
        )
    }

    #[inline(always)]
    pub(super) fn add<S: Simd>(&mut self, simd: S, from: usize, value: ComplexLanes<S>) {
        let sum = self.load(simd, from) + value;
        sum.re.store(&mut self.x[from..]);
        sum.im.store(&mut self.y[from..]);
    }
}

/// Pins of one kind: states in, loads out.
#[derive(Debug, Clone)]
pub(super) struct Sleeves {
    first: usize,
    count: usize,
    pub(super) position: Column,
    pub(super) velocity: Column,
    pub(super) rate: Vec<f64>,
    pub(super) force: Column,
    pub(super) moment: Vec<f64>,
}

impl Sleeves {
    pub(super) fn new(bodies: std::ops::Range<usize>) -> Self {
        let column = Column::padded(bodies.clone().map(|_| Complex::default()));
        let scalars = vec![0.0; column.x.len()];
        Self {
            first: bodies.start,
            count: bodies.len(),
            position: column.clone(),
            velocity: column.clone(),
            rate: scalars.clone(),
            force: column,
            moment: scalars,
        }
    }

    #[inline(always)]
    pub(super) fn gather(&mut self, bodies: &[BodyState]) {
        let n = self.count;
        // Slices of one known length, so that bounds are not checked for each element.
        let bodies = &bodies[self.first..][..n];
        let (x, y) = (&mut self.position.x[..n], &mut self.position.y[..n]);
        let (vx, vy) = (&mut self.velocity.x[..n], &mut self.velocity.y[..n]);
        let rate = &mut self.rate[..n];
        for k in 0..n {
            let b = &bodies[k];
            (x[k], y[k]) = (b.x, b.y);
            (vx[k], vy[k]) = (b.vx, b.vy);
            rate[k] = b.rate;
        }
        self.force.x.fill(0.0);
        self.force.y.fill(0.0);
        self.moment.fill(0.0);
    }

    #[inline(always)]
    pub(super) fn scatter(&self, loads: &mut [Wrench]) {
        let n = self.count;
        let loads = &mut loads[self.first..][..n];
        let (fx, fy, moment) = (&self.force.x[..n], &self.force.y[..n], &self.moment[..n]);
        for k in 0..n {
            let load = &mut loads[k];
            load.fx += fx[k];
            load.fy += fy[k];
            load.moment += moment[k];
        }
    }

    /// Returns the starts of the groups, with the mask of lanes that are pins.
    #[inline(always)]
    pub(super) fn groups<S: Simd>(
        &self,
        simd: S,
    ) -> impl Iterator<Item = (usize, Mask<S>)> + use<S> {
        let count = self.count;
        (0..count)
            .step_by(Lanes::<S>::COUNT)
            .map(move |from| (from, Mask::first(simd, count - from)))
    }
}
