//! Contact law for engines, identified by a number for the time of a run.
//!
//! Engines store a context, and may use it too late. It is therefore not an address but a number that is never reused. A
//! call with the number of a closed law returns NaN, which every engine's guard detects.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pinwheel_faults::{Fault, armed};
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::handles::Handles;
use pinwheel_law::Evaluator;

use crate::engine::Ending;

/// Law of a number.
pub struct Law {
    /// Number of bodies of the scene; valid also after closing.
    pub bodies: usize,
    /// Number of calls over which MuJoCo gets the same loads: 1, except for the fault of frozen loads.
    pub every: u64,
    evaluator: Mutex<Option<Evaluator>>,
    calls: AtomicU64,
    /// Factor of faulty loads.
    fault: Option<f64>,
}

/// Number of calls before loads are faulty.
const SOUND_CALLS: u64 = 300;

/// All laws so far. Closed laws stay in the list, so that a stale number is recognised.
static LAWS: Handles<Law> = Handles::new();

/// Locks data that are valid after a panic, too.
pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the law of a number, or `None` if it was never issued.
pub fn find(number: usize) -> Option<Arc<Law>> {
    LAWS.find(std::ptr::without_provenance::<u8>(number))
}

impl Law {
    /// Registers the law of a gearbox; returns its number and the law.
    ///
    /// # Errors
    /// A gearbox without a law.
    pub fn open(gearbox: &Gearbox) -> Result<(usize, Arc<Self>), Ending> {
        let field = gearbox.contact_field().map_err(Ending::unsupported)?;
        let bodies = gearbox.layout.bodies();
        let number = LAWS.open::<u8>(Self {
            bodies,
            every: if armed(Fault::FrozenLoads) { 4 } else { 1 },
            evaluator: Mutex::new(Some(Evaluator::new(field, bodies))),
            calls: AtomicU64::new(0),
            fault: match () {
                () if armed(Fault::NanLoads) => Some(f64::NAN),
                () if armed(Fault::HugeLoads) => Some(1e9),
                () => None,
            },
        });
        let number = number.addr();
        let law = find(number).ok_or_else(|| Ending::failed("its law was closed"))?;
        Ok((number, law))
    }

    /// Drops the evaluator; loads are NaN from now on.
    pub fn close(&self) {
        locked(&self.evaluator).take();
    }

    /// Reads 6 numbers a body and writes 3 loads a body; NaN if closed, or after a panic.
    pub fn evaluate(&self, states: &[f64], loads: &mut [f64]) {
        let evaluated = catch_unwind(AssertUnwindSafe(|| {
            let mut law = locked(&self.evaluator);
            law.as_mut().map(|law| law.evaluate(states, loads))
        }));
        if !matches!(evaluated, Ok(Some(()))) {
            loads.fill(f64::NAN);
        }
        if let Some(factor) = self.fault
            && self.calls.fetch_add(1, Ordering::Relaxed) >= SOUND_CALLS
        {
            loads.iter_mut().for_each(|load| *load *= factor);
        }
    }
}
