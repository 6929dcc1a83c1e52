//! State last projected onto the constraints.

/// State last projected onto the constraints, valid while bodies and arms have it.
#[derive(Debug, Clone)]
pub(super) struct Projected {
    pub(super) valid: bool,
    time: f64,
    y: Vec<f64>,
}

impl Projected {
    pub(super) fn new(dimension: usize) -> Self {
        Self {
            valid: false,
            time: 0.0,
            y: vec![0.0; dimension],
        }
    }

    pub(super) fn set(&mut self, time: f64, y: &[f64]) {
        (self.valid, self.time) = (true, time);
        self.y.copy_from_slice(y);
    }

    pub(super) fn is(&self, time: f64, y: &[f64]) -> bool {
        // All components are compared, because without an early exit the comparison processes several at a time.
        let same = |all: bool, (a, b): (&f64, &f64)| all & (a == b);
        self.valid && self.time == time && self.y.iter().zip(y).fold(true, same)
    }
}
