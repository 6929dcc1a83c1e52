//! Contacts of a gear one of whose external sleeves is a little smaller than the others.
//!
//! A sleeve whose radius is smaller by c touches a wheel as one of the full radius does that stands off by c along the normal
//! of the contact: penetration, normal and stiffness are the same to first order in c. Where several wheels touch it, the
//! normal is that of the largest force.

use pinwheel_mbs::{BodyState, Wrench};

use super::{ContactEnergy, ContactField, PairContact};
use crate::scene::Scene;
use crate::{Layout, Sleeve};

/// A field whose sleeve is smaller.
pub(super) struct Small {
    field: Box<dyn ContactField>,
    sleeve: Sleeve,
    body: usize,
    /// By how much its radius is smaller, m.
    less: f64,
    moved: Vec<BodyState>,
}

impl Small {
    pub(super) fn new(
        field: Box<dyn ContactField>,
        scene: &Scene,
        number: usize,
        less: f64,
    ) -> Self {
        let sleeve = Sleeve::External(number);
        Self {
            field,
            sleeve,
            body: Layout::of(&scene.gear).sleeve_body(sleeve),
            less,
            moved: Vec::new(),
        }
    }

    /// The states with the sleeve off by what it lacks.
    fn stand_off(&mut self, bodies: &[BodyState]) {
        let (mut most, mut normal) = (0.0, [0.0; 2]);
        let sleeve = self.sleeve;
        self.field.touching(bodies, &mut |pair| {
            if pair.sleeve == sleeve && pair.normal_force_n > most {
                (most, normal) = (pair.normal_force_n, pair.normal);
            }
        });
        self.moved.clear();
        self.moved.extend_from_slice(bodies);
        if let Some(state) = self.moved.get_mut(self.body) {
            state.x -= self.less * normal[0];
            state.y -= self.less * normal[1];
        }
    }
}

impl ContactField for Small {
    fn add_loads(&mut self, bodies: &[BodyState], loads: &mut [Wrench]) {
        self.stand_off(bodies);
        self.field.add_loads(&self.moved, loads);
    }

    fn energy(&mut self, bodies: &[BodyState]) -> ContactEnergy {
        self.stand_off(bodies);
        self.field.energy(&self.moved)
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        self.stand_off(bodies);
        self.field.touching(&self.moved, visit);
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        self.stand_off(bodies);
        self.field.nearest(&self.moved, wheel, sleeve)
    }

    fn normal_force(&self, pair: &PairContact, rate: f64) -> f64 {
        self.field.normal_force(pair, rate)
    }
}
