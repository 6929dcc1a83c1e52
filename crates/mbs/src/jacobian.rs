//! Jacobian df/dy of a system, and the linear systems that implicit methods solve with it.
//!
//! For a mechanical system, y = (q, v) with q' = v and v' = a(t, q, v), only K = da/dq and D = da/dv are stored, and a system
//! of the size of v replaces one of twice the size:
//!
//! ```text
//! (s I - [0 I; K D]) (x, w) = (r, p)   =>   (s I - D - K/s) w = p + K r/s,   x = (r + w)/s
//! ```
//! Velocities may be *hubs* and *leaves* (as in [`crate::sliding`]): a leaf has no entry with another leaf. Leaves are
//! eliminated one by one, and the Schur complement of the hubs is factored densely, with pivots. No symmetry is required.

use serde::{Deserialize, Serialize};

use crate::lu::{Lu, dot};

/// Structure of the dependence of f on y.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Structure {
    /// No known structure.
    FirstOrder,
    /// Mechanical system: y = (q, v), both of the length of `is_leaf`, and q' = v.
    SecondOrder {
        /// By velocity: true for a leaf, whose acceleration depends on no other leaf.
        is_leaf: Vec<bool>,
    },
}

/// Square matrix in which no entry joins two leaves.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Arrow {
    places: Vec<Place>,
    /// Hubs x hubs, row by row.
    hubs: Vec<f64>,
    /// Row of a leaf, column of a hub: `[hub * leaves + leaf]`.
    down: Vec<f64>,
    /// Row of a hub, column of a leaf: `[hub * leaves + leaf]`.
    up: Vec<f64>,
    leaves: Vec<f64>,
}

/// Number of a velocity among the hubs or among the leaves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
enum Place {
    Hub(usize),
    Leaf(usize),
}

impl Place {
    /// Returns the places of all velocities, with the numbers of hubs and of leaves.
    fn all(is_leaf: &[bool]) -> (Vec<Self>, usize, usize) {
        let (mut hubs, mut leaves) = (0, 0);
        let places = is_leaf.iter().map(|&leaf| {
            let counter = if leaf { &mut leaves } else { &mut hubs };
            *counter += 1;
            let place = if leaf { Self::Leaf } else { Self::Hub };
            place(*counter - 1)
        });
        (places.collect(), hubs, leaves)
    }
}

impl Arrow {
    fn new(is_leaf: &[bool]) -> Self {
        let (places, hubs, leaves) = Place::all(is_leaf);
        Self {
            places,
            hubs: vec![0.0; hubs * hubs],
            down: vec![0.0; hubs * leaves],
            up: vec![0.0; hubs * leaves],
            leaves: vec![0.0; leaves],
        }
    }

    /// Returns the number of rows, which is that of columns.
    pub fn dimension(&self) -> usize {
        self.places.len()
    }

    fn hub_count(&self) -> usize {
        self.places.len() - self.leaves.len()
    }

    /// True if row and column `k` are those of a leaf.
    pub(crate) fn is_leaf(&self, k: usize) -> bool {
        matches!(self.places[k], Place::Leaf(_))
    }

    pub(crate) fn clear(&mut self) {
        self.hubs.fill(0.0);
        self.down.fill(0.0);
        self.up.fill(0.0);
        self.leaves.fill(0.0);
    }

    /// Adds `value` to an entry; has no effect between two different leaves.
    #[inline]
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let (hubs, leaves) = (self.hub_count(), self.leaves.len());
        match (self.places[row], self.places[column]) {
            (Place::Hub(i), Place::Hub(j)) => self.hubs[i * hubs + j] += value,
            (Place::Leaf(l), Place::Hub(j)) => self.down[j * leaves + l] += value,
            (Place::Hub(i), Place::Leaf(l)) => self.up[i * leaves + l] += value,
            (Place::Leaf(l), Place::Leaf(k)) if l == k => self.leaves[l] += value,
            (Place::Leaf(_), Place::Leaf(_)) => {}
        }
    }

    /// Returns one entry; 0 between different leaves.
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        let (hubs, leaves) = (self.hub_count(), self.leaves.len());
        match (self.places[row], self.places[column]) {
            (Place::Hub(i), Place::Hub(j)) => self.hubs[i * hubs + j],
            (Place::Leaf(l), Place::Hub(j)) => self.down[j * leaves + l],
            (Place::Hub(i), Place::Leaf(l)) => self.up[i * leaves + l],
            (Place::Leaf(l), Place::Leaf(k)) if l == k => self.leaves[l],
            (Place::Leaf(_), Place::Leaf(_)) => 0.0,
        }
    }

    /// Multiplies every row by its factor.
    pub(crate) fn scale_rows(&mut self, factors: &[f64]) {
        let (hubs, leaves) = (self.hub_count(), self.leaves.len());
        for (place, &factor) in self.places.iter().zip(factors) {
            match *place {
                Place::Hub(i) => {
                    let row = &mut self.hubs[i * hubs..(i + 1) * hubs];
                    let up = &mut self.up[i * leaves..(i + 1) * leaves];
                    row.iter_mut().chain(up).for_each(|x| *x *= factor);
                }
                Place::Leaf(l) => {
                    self.leaves[l] *= factor;
                    for i in 0..hubs {
                        self.down[i * leaves + l] *= factor;
                    }
                }
            }
        }
    }
}

/// Vector with its hubs and leaves stored separately.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Parted {
    hubs: Vec<f64>,
    leaves: Vec<f64>,
}

impl Parted {
    fn read(&mut self, places: &[Place], x: &[f64]) {
        for (place, &x) in places.iter().zip(x) {
            match *place {
                Place::Hub(i) => self.hubs[i] = x,
                Place::Leaf(l) => self.leaves[l] = x,
            }
        }
    }

    fn write(&self, places: &[Place], x: &mut [f64]) {
        for (place, x) in places.iter().zip(x) {
            *x = match *place {
                Place::Hub(i) => self.hubs[i],
                Place::Leaf(l) => self.leaves[l],
            };
        }
    }

    /// Adds the product: self += factor matrix x.
    fn add_product(&mut self, factor: f64, matrix: &Arrow, x: &Self) {
        let (m, l) = (self.hubs.len(), self.leaves.len());
        for (i, sum) in self.hubs.iter_mut().enumerate() {
            *sum += factor * dot(&matrix.hubs[i * m..(i + 1) * m], &x.hubs);
            *sum += factor * dot(&matrix.up[i * l..(i + 1) * l], &x.leaves);
        }
        let own = matrix.leaves.iter().zip(&x.leaves);
        for (sum, (d, x)) in self.leaves.iter_mut().zip(own) {
            *sum += factor * d * x;
        }
        for (i, x) in x.hubs.iter().enumerate() {
            let down = &matrix.down[i * l..(i + 1) * l];
            axpy(factor * x, down, &mut self.leaves);
        }
    }
}

/// Adds a multiple of a vector: y += a x.
fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

/// Variable of a derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Variable {
    /// Coordinate, by number.
    Position(usize),
    /// Velocity, by number.
    Rate(usize),
    /// Function of the time, with its rate of change.
    Time(f64),
}

/// Derivatives of a system's f, and the factors of s I - df/dy.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Jacobian {
    /// K of a mechanical system in the order of v, 1/s^2; `None` of a system of first order.
    pub position: Option<Arrow>,
    /// D, 1/s, or the entire df/dy of a system of first order.
    pub rate: Arrow,
    /// da/dt, or df/dt of a system of first order.
    pub time: Vec<f64>,
    shift: f64,
    /// Factors: inverse diagonal of the leaves, border above divided by it, border below.
    inverse: Vec<f64>,
    up: Vec<f64>,
    down: Vec<f64>,
    lu: Lu,
    rhs: Parted,
    known: Parted,
}

impl Jacobian {
    /// Creates a Jacobian of zeros. `dimension` is the length of y.
    pub fn new(structure: &Structure, dimension: usize) -> Self {
        match structure {
            Structure::FirstOrder => Self::of(&vec![false; dimension], false),
            Structure::SecondOrder { is_leaf } => Self::of(is_leaf, true),
        }
    }

    /// Creates a Jacobian of zeros with these leaves; `second` adds K.
    pub(crate) fn of(is_leaf: &[bool], second: bool) -> Self {
        let rate = Arrow::new(is_leaf);
        let parted = Parted {
            hubs: vec![0.0; rate.hub_count()],
            leaves: vec![0.0; rate.leaves.len()],
        };
        Self {
            position: second.then(|| rate.clone()),
            time: vec![0.0; rate.dimension()],
            shift: 0.0,
            inverse: rate.leaves.clone(),
            up: rate.up.clone(),
            down: rate.down.clone(),
            lu: Lu::new(rate.hub_count()),
            known: parted.clone(),
            rhs: parted,
            rate,
        }
    }

    /// Sets all derivatives to 0.
    pub fn clear(&mut self) {
        self.position.iter_mut().for_each(Arrow::clear);
        self.rate.clear();
        self.time.fill(0.0);
    }

    /// Adds `value` to the derivative of the acceleration `row` of a mechanical system with respect to `by`.
    #[inline]
    pub fn add(&mut self, row: usize, by: Variable, value: f64) {
        match by {
            Variable::Position(k) => self.position.iter_mut().for_each(|p| p.add(row, k, value)),
            Variable::Rate(k) => self.rate.add(row, k, value),
            Variable::Time(rate) => self.time[row] += rate * value,
        }
    }

    /// Multiplies every row by its factor.
    pub fn scale_rows(&mut self, factors: &[f64]) {
        self.position.iter_mut().for_each(|p| p.scale_rows(factors));
        self.rate.scale_rows(factors);
        for (time, factor) in self.time.iter_mut().zip(factors) {
            *time *= factor;
        }
    }

    /// Adds `factor` df/dt to `dydt`.
    pub(crate) fn add_time(&self, factor: f64, dydt: &mut [f64]) {
        let first = dydt.len() - self.time.len();
        axpy(factor, &self.time, &mut dydt[first..]);
    }

    /// Factors `shift` I - df/dy. Returns false if the matrix is singular or not finite.
    pub fn factor(&mut self, shift: f64) -> bool {
        self.shift = shift;
        let weight = shift.recip();
        let (m, l) = (self.rate.hub_count(), self.inverse.len());
        let lu = self.lu.entries_mut();
        for (parts, out) in [
            (&self.rate.leaves, &mut self.inverse[..]),
            (&self.rate.up, &mut self.up),
            (&self.rate.down, &mut self.down),
            (&self.rate.hubs, lu),
        ] {
            for (out, rate) in out.iter_mut().zip(parts) {
                *out = -rate;
            }
        }
        if let Some(position) = &self.position {
            axpy(-weight, &position.leaves, &mut self.inverse);
            axpy(-weight, &position.up, &mut self.up);
            axpy(-weight, &position.down, &mut self.down);
            axpy(-weight, &position.hubs, lu);
        }
        for leaf in &mut self.inverse {
            *leaf = (*leaf + shift).recip();
        }
        for i in 0..m {
            lu[i * m + i] += shift;
            let up = &mut self.up[i * l..(i + 1) * l];
            for (up, inverse) in up.iter_mut().zip(&self.inverse) {
                *up *= inverse;
            }
            for j in 0..m {
                lu[i * m + j] -= dot(up, &self.down[j * l..(j + 1) * l]);
            }
        }
        self.inverse.iter().all(|x| x.is_finite()) && self.lu.factor()
    }

    /// Overwrites `x` (the right-hand side, of the length of y) with the solution of the factored system.
    pub fn solve(&mut self, x: &mut [f64]) {
        let Self { rhs, known, .. } = self;
        let (places, n) = (&self.rate.places, self.time.len());
        let weight = self.shift.recip();
        let (positions, rates) = x.split_at_mut(x.len() - n);
        rhs.read(places, rates);
        if let Some(position) = &self.position {
            known.read(places, positions);
            rhs.add_product(weight, position, known);
        }
        let l = rhs.leaves.len();
        for (i, hub) in rhs.hubs.iter_mut().enumerate() {
            *hub -= dot(&self.up[i * l..(i + 1) * l], &rhs.leaves);
        }
        self.lu.solve(&mut rhs.hubs);
        for (i, hub) in rhs.hubs.iter().enumerate() {
            axpy(-hub, &self.down[i * l..(i + 1) * l], &mut rhs.leaves);
        }
        for (leaf, inverse) in rhs.leaves.iter_mut().zip(&self.inverse) {
            *leaf *= inverse;
        }
        rhs.write(places, rates);
        for (x, w) in positions.iter_mut().zip(rates.iter()) {
            *x = (*x + w) * weight;
        }
    }
}
