//! Our contact law as engines see it: a number that stands for a live law.
//!
//! Engines keep a context, and may keep it too long. So the context is no address but a number that
//! is never used twice: behind one whose law is gone there is nothing, and a call with it answers
//! NaN, which every engine's guard sees.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pinwheel_law::Evaluator;

/// A law shared between an engine's callbacks.
pub(super) type SharedLaw = Arc<Mutex<Evaluator>>;

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

/// Hands out a number for a law on so many bodies.
pub(super) fn enter(law: &SharedLaw, bodies: usize) -> usize {
    let mut laws = locked(&LAWS);
    let number = laws.last_key_value().map_or(1, |(last, _)| last + 1);
    let law = Some(Arc::clone(law));
    laws.insert(number, Entry { bodies, law });
    number
}

/// From now on nothing stands behind the number.
pub(super) fn leave(number: usize) {
    if let Some(entry) = locked(&LAWS).get_mut(&number) {
        entry.law = None;
    }
}
