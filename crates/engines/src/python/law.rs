//! Our contact law as engines see it: a number that stands for a live law.
//!
//! Engines keep a context, and may keep it too long. So the context is no address but a number that
//! is never used twice: behind one whose law is gone there is nothing, and a call with it answers
//! NaN, which every engine's guard sees.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::ContactField;
use pinwheel_mbs::{BodyState, Wrench};

use super::mujoco::detach;

/// A law and the arrays it works on.
pub(super) struct Law {
    field: Box<dyn ContactField>,
    bodies: Vec<BodyState>,
    loads: Vec<Wrench>,
}

impl Law {
    /// Reads states (x, y, angle, vx, vy, rate per body), writes loads (fx, fy, moment per body).
    pub(super) fn evaluate(&mut self, states: &[f64], loads: &mut [f64]) {
        for (body, state) in self.bodies.iter_mut().zip(states.as_chunks::<6>().0) {
            let &[x, y, angle, vx, vy, rate] = state;
            *body = BodyState {
                x,
                y,
                angle,
                vx,
                vy,
                rate,
            };
        }
        self.loads.fill(Wrench::default());
        self.field.add_loads(&self.bodies, &mut self.loads);
        for (out, load) in loads.as_chunks_mut::<3>().0.iter_mut().zip(&self.loads) {
            *out = [load.fx, load.fy, load.moment];
        }
    }
}

/// A law shared between an engine's callbacks.
pub(super) type SharedLaw = Arc<Mutex<Law>>;

/// What stands behind a number.
#[derive(Clone)]
pub(super) struct Entry {
    /// Bodies of the scene; known also after the law is gone.
    pub(super) bodies: usize,
    /// The law while it lives.
    pub(super) law: Option<SharedLaw>,
}

/// All numbers handed out so far. Entries of dead laws stay: they are what tells stale from alive.
static LAWS: Mutex<BTreeMap<usize, Entry>> = Mutex::new(BTreeMap::new());

/// What a lock guards here is valid after a panic, too.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What stands behind a number, or `None` if it was never handed out.
pub(super) fn find(number: usize) -> Option<Entry> {
    locked(&LAWS).get(&number).cloned()
}

/// A law that engines can call; stale from the moment this is dropped.
pub(super) struct Published {
    pub(super) number: usize,
    pub(super) bodies: usize,
    pub(super) law: SharedLaw,
}

impl Published {
    pub(super) fn new(gearbox: &Gearbox, field: Box<dyn ContactField>) -> Self {
        let bodies = gearbox.layout.bodies();
        let law = Arc::new(Mutex::new(Law {
            field,
            bodies: vec![BodyState::default(); bodies],
            loads: vec![Wrench::default(); bodies],
        }));
        let mut laws = locked(&LAWS);
        let number = laws.last_key_value().map_or(1, |(last, _)| last + 1);
        let entry = Entry {
            bodies,
            law: Some(Arc::clone(&law)),
        };
        laws.insert(number, entry);
        Self {
            number,
            bodies,
            law,
        }
    }
}

impl Drop for Published {
    fn drop(&mut self) {
        // However the run ended, by a panic too: MuJoCo may call no more.
        detach(self.number);
        if let Some(entry) = locked(&LAWS).get_mut(&self.number) {
            entry.law = None;
        }
    }
}
