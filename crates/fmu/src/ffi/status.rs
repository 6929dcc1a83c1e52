//! Status of a step. Steps are complete when their call returns.

use std::ffi::{c_char, c_int};

use super::{Component, Instance, null, on};

/// Constant `fmi2Discard` of `fmi2Status`: the requested status does not exist.
const DISCARD: c_int = 2;
/// Constant `fmi2LastSuccessfulTime` of `fmi2StatusKind`.
const LAST_SUCCESSFUL_TIME: c_int = 2;
/// Constant `fmi2Terminated` of `fmi2StatusKind`.
const TERMINATED: c_int = 3;

/// Functions on the status of pending steps; there are no pending steps.
macro_rules! of_no_step {
    ($($function:ident($value:ty);)*) => {$(
        /// Returns `fmi2Discard`: no step is pending.
        #[unsafe(no_mangle)]
        pub extern "C" fn $function(component: Component, _kind: c_int, _value: $value) -> c_int {
            on(component, |_| Ok(DISCARD))
        }
    )*};
}

of_no_step! {
    fmi2GetStatus(*mut c_int);
    fmi2GetIntegerStatus(*mut c_int);
    fmi2GetStringStatus(*mut *const c_char);
}

/// Writes a value of the unit, if `kind` is the requested one.
///
/// # Safety
/// `value`: null or an address.
unsafe fn tell<T>(
    component: Component,
    known: bool,
    value: *mut T,
    of: impl FnOnce(&Instance) -> T,
) -> c_int {
    on(component, |unit| {
        if !known {
            return Ok(DISCARD);
        }
        // SAFETY: null or an address.
        let value = unsafe { value.as_mut() }.ok_or_else(|| null("the address of the value"))?;
        *value = of(unit);
        Ok(super::OK)
    })
}

/// Writes the time of the last successful step, s.
///
/// # Safety
/// `value`: null or an address.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    component: Component,
    kind: c_int,
    value: *mut f64,
) -> c_int {
    let known = kind == LAST_SUCCESSFUL_TIME;
    // SAFETY: as the caller promises.
    unsafe { tell(component, known, value, |unit| unit.time_s()) }
}

/// Writes false: the unit never requests the end of a simulation.
///
/// # Safety
/// `value`: null or an address.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    component: Component,
    kind: c_int,
    value: *mut c_int,
) -> c_int {
    // SAFETY: as the caller promises.
    unsafe { tell(component, kind == TERMINATED, value, |_| 0) }
}
