//! Complete states of a unit: saving, restoring, and their form as bytes.

use std::ptr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{Component, Kept, OK, Refusal, STATES, State, array, array_mut, done, null, on};
use std::ffi::c_int;

impl Kept {
    fn bytes(&self) -> MutexGuard<'_, Vec<u8>> {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns a saved state of this unit.
fn kept(component: Component, state: State) -> Result<Arc<Kept>, Refusal> {
    let entry = STATES.find(state);
    let own = entry.filter(|kept| kept.of == component.addr());
    own.ok_or_else(|| Refusal("the state is not one of this unit: null, freed or invalid".into()))
}

/// Stores bytes in an existing state, or in a new one.
fn keep(component: Component, bytes: Vec<u8>, place: &mut State) -> Result<(), Refusal> {
    if place.is_null() {
        *place = STATES.open(Kept {
            of: component.addr(),
            bytes: Mutex::new(bytes),
        });
    } else {
        *kept(component, *place)?.bytes() = bytes;
    }
    Ok(())
}

/// Saves the complete state of the unit.
///
/// # Safety
/// `state`: null or the address of a state, which is null or of this unit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(component: Component, state: *mut State) -> c_int {
    on(component, |unit| {
        // SAFETY: null or an address.
        let state = unsafe { state.as_mut() }.ok_or_else(|| null("the address of the state"))?;
        done(keep(component, unit.save()?, state))
    })
}

/// Restores a saved state.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetFMUstate(component: Component, state: State) -> c_int {
    on(component, |unit| {
        done(unit.restore(&kept(component, state)?.bytes()))
    })
}

/// Frees a state; null is permitted.
///
/// # Safety
/// Requirements of [`fmi2GetFMUstate`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(component: Component, state: *mut State) -> c_int {
    on(component, |_| {
        // SAFETY: null or an address.
        if let Some(state) = unsafe { state.as_mut() }
            && !state.is_null()
        {
            kept(component, *state)?;
            STATES.close(*state);
            *state = ptr::null_mut();
        }
        Ok(OK)
    })
}

/// Writes the size of a state, bytes.
///
/// # Safety
/// `size`: null or an address.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    component: Component,
    state: State,
    size: *mut usize,
) -> c_int {
    on(component, |_| {
        let kept = kept(component, state)?;
        // SAFETY: null or an address.
        let size = unsafe { size.as_mut() }.ok_or_else(|| null("the address of the size"))?;
        *size = kept.bytes().len();
        Ok(OK)
    })
}

/// Writes a state as bytes.
///
/// # Safety
/// `bytes`: null or of `size`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    component: Component,
    state: State,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    on(component, |_| {
        let kept = kept(component, state)?;
        let state = kept.bytes();
        // SAFETY: the caller promises its length.
        let place = unsafe { array_mut("the address of the bytes", bytes, size)? };
        let small = || format!("a state takes {} bytes, not {size}", state.len());
        let room = place.get_mut(..state.len()).ok_or_else(small)?;
        room.copy_from_slice(&state);
        Ok(OK)
    })
}

/// Reads a state from bytes.
///
/// # Safety
/// `bytes`: null or of `size`; `state`: as for [`fmi2GetFMUstate`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    component: Component,
    bytes: *const u8,
    size: usize,
    state: *mut State,
) -> c_int {
    on(component, |unit| {
        // SAFETY: the caller promises its length, and null or an address.
        let (bytes, state) = unsafe { (array("the bytes", bytes, size)?, state.as_mut()) };
        let state = state.ok_or_else(|| null("the address of the state"))?;
        unit.check(bytes)?;
        done(keep(component, bytes.to_vec(), state))
    })
}
