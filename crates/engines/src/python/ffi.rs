//! Boundary of C functions by which engines call the contact law. All `unsafe` of the Python engines is in this file.
//!
//! Contract of [`law`] (engines call it from any thread, one at a time for each context):
//! - `context` is the number of a [`Published`](super::published::Published) law, not an address;
//! - for a number of any present or earlier law, `states` points to 6 and `loads` to 3 doubles for each body of its scene,
//!   aligned, not overlapping, alive and not otherwise used for the time of the call, or is null; loads of an earlier law
//!   become NaN;
//! - with an unknown number, or a null address, the call does nothing;
//! - neither address is stored.
//!
//! Contract of [`passive`] (MuJoCo's `mjcb_passive`, also called by exudyn's force function, on the thread that steps `data`):
//! - while a run with this `data` is attached, its [`Addresses`](super::mujoco::Addresses) are valid, of the lengths given,
//!   aligned, apart from one another, and used by no other thread;
//! - any other `data` is not accessed, so a late callback does nothing.
//!
//! Neither function lets a panic out: the answer is NaN then.

#![allow(unsafe_code)]

use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

use super::law::{find, locked};
use super::mujoco::ATTACHED;

/// Evaluates the law of `context`; NaN if it is closed.
///
/// # Safety
/// See the module.
pub unsafe extern "C" fn law(
    context: *mut c_void,
    _time_s: f64,
    states: *const f64,
    loads: *mut f64,
) {
    let Some(entry) = find(context.addr()) else {
        return;
    };
    if states.is_null() || loads.is_null() {
        return;
    }
    // SAFETY: the number was issued, so the contract gives both arrays their lengths.
    let (states, loads) = unsafe {
        (
            slice::from_raw_parts(states, 6 * entry.bodies),
            slice::from_raw_parts_mut(loads, 3 * entry.bodies),
        )
    };
    entry.evaluate(states, loads);
}

/// Adds the contact torques of the run that belongs to `data`.
///
/// # Safety
/// See the module.
pub unsafe extern "C" fn passive(_model: *const c_void, data: *mut c_void) {
    let mut attached = locked(&ATTACHED);
    let Some(run) = attached
        .iter_mut()
        .find(|run| run.addresses.data == data.addr())
    else {
        return;
    };
    let at = run.addresses;
    let count = at.coordinates;
    let pointer = |address: usize| std::ptr::with_exposed_provenance_mut::<f64>(address);
    // SAFETY: the run is attached, so the contract makes its addresses valid.
    let (q, v, torques, counters) = unsafe {
        (
            slice::from_raw_parts(pointer(at.qpos).cast_const(), count),
            slice::from_raw_parts(pointer(at.qvel).cast_const(), count),
            slice::from_raw_parts_mut(pointer(at.qfrc_passive), count),
            slice::from_raw_parts_mut(pointer(at.counters).cast::<i64>(), 2),
        )
    };
    match catch_unwind(AssertUnwindSafe(|| run.add_torques(q, v, torques))) {
        Ok(counted) => {
            counters[0] += i64::from(counted.evaluated);
            counters[1] += i64::from(counted.moved);
        }
        Err(_) => torques.fill(f64::NAN),
    }
}

/// Address of [`law`].
pub fn law_address() -> usize {
    (law as *const ()).expose_provenance()
}

/// Address of [`passive`].
pub fn passive_address() -> usize {
    (passive as *const ()).expose_provenance()
}
