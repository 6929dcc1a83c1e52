//! Contact forces summed body by body.

use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::{Layout, Sleeve};

/// Contact forces in the ground frame, N, summed over the pairs.
pub struct Evaluation {
    pub layout: Layout,
    /// Forces on each pin, external then internal.
    pub sleeves: Vec<[f64; 2]>,
    /// Forces on each disc.
    wheels: Vec<[f64; 2]>,
    /// Moment on the input shaft, except by discs that it carries, N m.
    input_n_m: f64,
    /// Moment on the output shaft, except by its pins, N m.
    pub output_n_m: f64,
}

impl Evaluation {
    pub fn new(layout: Layout) -> Self {
        Self {
            layout,
            sleeves: vec![[0.0; 2]; layout.external_sleeves + layout.internal_sleeves],
            wheels: vec![[0.0; 2]; layout.wheels],
            input_n_m: 0.0,
            output_n_m: 0.0,
        }
    }

    /// Adds the force of a pair on its pin, and the opposite to the disc.
    pub fn add(&mut self, wheel: usize, sleeve: Sleeve, force: [f64; 2]) {
        let slot = sleeve_slot(self.layout, sleeve);
        let [fx, fy] = force;
        self.sleeves[slot][0] += fx;
        self.sleeves[slot][1] += fy;
        self.wheels[wheel][0] -= fx;
        self.wheels[wheel][1] -= fy;
    }

    /// Sets the sums from the loads of all bodies.
    pub fn take(&mut self, loads: &[Wrench]) {
        let wheels = self.layout.wheel_bodies();
        let sleeves = &loads[self.layout.external_bodies().start..];
        for (sums, loads) in [
            (&mut self.wheels, &loads[wheels]),
            (&mut self.sleeves, sleeves),
        ] {
            for (sum, load) in sums.iter_mut().zip(loads) {
                *sum = [load.fx, load.fy];
            }
        }
        self.input_n_m = loads[Layout::INPUT].moment;
        self.output_n_m = loads[Layout::OUTPUT].moment;
    }

    /// Returns the force on a body, N; 0 for the shafts, which have no contacts.
    pub fn on_body(&self, body: usize) -> [f64; 2] {
        let (wheels, sleeves) = (
            self.layout.wheel_bodies(),
            self.layout.external_bodies().start,
        );
        if body >= sleeves {
            self.sleeves[body - sleeves]
        } else if wheels.contains(&body) {
            self.wheels[body - wheels.start]
        } else {
            [0.0; 2]
        }
    }

    pub fn clear(&mut self) {
        self.sleeves.fill([0.0; 2]);
        self.wheels.fill([0.0; 2]);
        (self.input_n_m, self.output_n_m) = (0.0, 0.0);
    }

    /// Returns the torque of the driver on the input shaft, N m, by virtual work: each eccentric transmits its disc's contact
    /// force F to the shaft, T = -sum E x F. The disc's own inertia force points along E and does no work at constant speed.
    /// For discs that `float` the bearings load the shaft.
    pub fn driver_torque(&self, bodies: &[BodyState], float: bool) -> f64 {
        let shaft = &bodies[Layout::INPUT];
        let wheels = self.layout.wheel_bodies().zip(&self.wheels);
        let by_wheels = wheels.map(|(wheel, [fx, fy])| {
            (bodies[wheel].x - shaft.x) * fy - (bodies[wheel].y - shaft.y) * fx
        });
        let held = if float { 0.0 } else { by_wheels.sum() };
        -held - self.input_n_m
    }
}

/// Returns the index of a pin among all pins, external before internal.
pub fn sleeve_slot(layout: Layout, sleeve: Sleeve) -> usize {
    match sleeve {
        Sleeve::External(j) => j,
        Sleeve::Internal(k) => layout.external_sleeves + k,
    }
}
