//! Contact law on plain arrays for foreign solvers.

use pinwheel_gearbox::contacts::ContactField;
use pinwheel_mbs::{BodyState, Wrench};

/// Length of a state: x, y (m), angle (rad), vx, vy (m/s), rate (rad/s).
pub const STATE: usize = 6;
/// Length of a load: fx, fy (N), moment about the centre (N m).
pub const LOAD: usize = 3;

/// Contact field with its work arrays.
pub struct Evaluator {
    field: ContactField,
    bodies: Vec<BodyState>,
    loads: Vec<Wrench>,
}

impl Evaluator {
    /// Creates the evaluator for `bodies` bodies.
    pub fn new(field: ContactField, bodies: usize) -> Self {
        Self {
            field,
            bodies: vec![BodyState::default(); bodies],
            loads: vec![Wrench::default(); bodies],
        }
    }

    /// Reads [`STATE`] numbers and writes [`LOAD`] numbers for each body; equal states give equal bits.
    pub fn evaluate(&mut self, states: &[f64], loads: &mut [f64]) {
        for (body, state) in self.bodies.iter_mut().zip(states.as_chunks::<STATE>().0) {
            let &[x, y, angle, vx, vy, rate] = state;
            *body = BodyState::new([x, y, angle], [vx, vy, rate]);
        }
        self.loads.fill(Wrench::default());
        self.field.add_loads(&self.bodies, &mut self.loads);
        for (out, load) in loads.as_chunks_mut::<LOAD>().0.iter_mut().zip(&self.loads) {
            *out = [load.fx, load.fy, load.moment];
        }
    }
}

/// Returns a state as [`STATE`] numbers.
pub fn numbers(body: &BodyState) -> [f64; STATE] {
    [body.x, body.y, body.angle, body.vx, body.vy, body.rate]
}
