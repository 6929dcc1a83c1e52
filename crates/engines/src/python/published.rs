//! A law for the time of a run.

use std::sync::{Arc, Mutex};

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::ContactField;
use pinwheel_law::Evaluator;

use super::law::{SharedLaw, enter, leave};
use super::mujoco::detach;

/// A law that engines can call; stale from the moment this is dropped.
pub(super) struct Published {
    pub(super) number: usize,
    pub(super) bodies: usize,
    pub(super) law: SharedLaw,
}

impl Published {
    pub(super) fn new(gearbox: &Gearbox, field: Box<dyn ContactField>) -> Self {
        let bodies = gearbox.layout.bodies();
        let law = Arc::new(Mutex::new(Evaluator::new(field, bodies)));
        Self {
            number: enter(&law, bodies),
            bodies,
            law,
        }
    }
}

impl Drop for Published {
    fn drop(&mut self) {
        // However the run ended, by a panic too: MuJoCo may call no more.
        detach(self.number);
        leave(self.number);
    }
}
