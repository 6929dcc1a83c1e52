//! C interface: the functions of `pinwheel_law.h`. All `unsafe` of this crate is in this file.
//!
//! Callers guarantee some facts that no code can check: texts end in a zero byte; arrays have the length of the header, are
//! aligned, do not overlap, and are not used by others during the call. Arrays are not kept after the call. Everything else is
//! checked:
//! - a handle is a unique number, not an address: closed or invented ones are refused, and closing twice has no effect;
//! - a handle's law has a lock, so two threads that share one wait for each other;
//! - null addresses are refused;
//! - no panic leaves the library.
//!
//! A failed call writes NaN to its outputs as far as their length is known; `pinwheel_law_error` returns the reason.

#![allow(unsafe_code)]

use std::cell::RefCell;
use std::convert::identity;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::slice;
use std::sync::{Mutex, PoisonError};

use pinwheel_gearbox::handles::Handles;

use crate::law::{Law, LawError};
use crate::{ABI, LOAD, STATE};

/// Status of a null address, an invalid handle, or an index out of range.
pub const ARGUMENT: i32 = -1;
/// Status of a faulty scene.
pub const SCENE: i32 = -2;
/// Status of states or loads that are not finite.
pub const NOT_FINITE: i32 = -3;
/// Status of a fault of this library.
pub const FAULT: i32 = -4;

/// Law as an opaque type of C; its address is only a number.
#[repr(C)]
pub struct PinwheelLaw {
    _private: [u8; 0],
}

static LAWS: Handles<Mutex<Law>> = Handles::new();

thread_local! {
    static ERROR: RefCell<CString> = RefCell::default();
}

/// Reason for a failed call: its status and message.
#[doc(hidden)]
pub struct Failure(i32, String);

impl From<LawError> for Failure {
    fn from(error: LawError) -> Self {
        let status = match error {
            LawError::Scene(_) | LawError::Gearbox(_) => SCENE,
            LawError::Length { .. } => ARGUMENT,
            LawError::NotFinite { .. } | LawError::Overflow { .. } => NOT_FINITE,
        };
        Self(status, error.to_string())
    }
}

fn argument(what: impl Into<String>) -> Failure {
    Failure(ARGUMENT, what.into())
}

/// Runs a call; a failure returns `failed` of its status.
fn guarded<T>(failed: impl FnOnce(i32) -> T, call: impl FnOnce() -> Result<T, Failure>) -> T {
    let outcome = catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| {
        let what = "a fault in libpinwheel_law, not in your call; please report it with the scene";
        Err(Failure(FAULT, what.to_owned()))
    });
    outcome.unwrap_or_else(|Failure(status, what)| {
        let text = CString::new(what.replace('\0', " ")).unwrap_or_default();
        // A thread that is ending cannot store the message.
        let _ = ERROR.try_with(|error| *error.borrow_mut() = text);
        failed(status)
    })
}

/// Runs a call on the law behind a handle.
#[doc(hidden)]
pub fn on<T>(
    handle: *const PinwheelLaw,
    failed: impl FnOnce(i32) -> T,
    call: impl FnOnce(&mut Law) -> Result<T, Failure>,
) -> T {
    guarded(failed, || {
        let law = LAWS.find(handle);
        let law = law.ok_or_else(|| argument("the handle is not open: null, closed or invalid"))?;
        // The law stays valid after a panic, because it keeps no state between calls.
        let mut law = law.lock().unwrap_or_else(PoisonError::into_inner);
        call(&mut law)
    })
}

/// Runs a call on the law behind a handle; its result is a status.
fn status_of(
    handle: *const PinwheelLaw,
    call: impl FnOnce(&mut Law) -> Result<(), Failure>,
) -> i32 {
    on(handle, identity, |law| call(law).map(|()| 0))
}

/// Returns an array of the caller as a slice.
///
/// # Safety
/// `start` is null or the start of `length` numbers, as the module describes.
unsafe fn array<'a>(start: *const f64, length: usize) -> Option<&'a [f64]> {
    // SAFETY: not null, and the caller promises its length.
    (!start.is_null()).then(|| unsafe { slice::from_raw_parts(start, length) })
}

/// Returns an array of the caller as a mutable slice.
///
/// # Safety
/// `start` is null or the start of `length` numbers, as the module describes.
unsafe fn array_mut<'a>(start: *mut f64, length: usize) -> Option<&'a mut [f64]> {
    // SAFETY: not null, and the caller promises its length.
    (!start.is_null()).then(|| unsafe { slice::from_raw_parts_mut(start, length) })
}

/// Returns the version of this interface.
#[unsafe(no_mangle)]
pub extern "C" fn pinwheel_law_abi() -> u32 {
    ABI
}

/// Opens a job folder, a scene file, the text of a scene, or a preset; `out` becomes its handle, or null.
///
/// # Safety
/// `scene`: null or text that ends in a zero byte. `out`: null or the address of a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pinwheel_law_open(
    scene: *const c_char,
    out: *mut *mut PinwheelLaw,
) -> i32 {
    guarded(identity, || {
        if out.is_null() {
            return Err(argument("`out` is null; give the address of a handle"));
        }
        // SAFETY: not null, and the caller promises an address.
        unsafe { out.write(ptr::null_mut()) };
        if scene.is_null() {
            return Err(argument("`scene` is null; name a scene or a job folder"));
        }
        // SAFETY: not null, and the caller promises its end.
        let scene = unsafe { CStr::from_ptr(scene) }.to_str();
        let scene = scene.map_err(|_| argument("`scene` is not UTF-8 text"))?;
        let law = LAWS.open(Mutex::new(Law::open(scene)?));
        // SAFETY: as above.
        unsafe { out.write(law) };
        Ok(0)
    })
}

/// Returns the number of bodies.
#[unsafe(no_mangle)]
pub extern "C" fn pinwheel_law_bodies(law: *const PinwheelLaw) -> i32 {
    on(law, identity, |law| {
        i32::try_from(law.bodies().len()).map_err(|_| argument("too many bodies"))
    })
}

/// Writes carrier, seat, mass and moment of a body. An address may be null if its value is not required.
///
/// # Safety
/// `carrier`, `mass_kg`, `moment_kg_m2`: null or the address of one number; `seat_m`: null or of two.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pinwheel_law_body(
    law: *const PinwheelLaw,
    body: i32,
    carrier: *mut i32,
    seat_m: *mut f64,
    mass_kg: *mut f64,
    moment_kg_m2: *mut f64,
) -> i32 {
    // SAFETY: the caller promises their lengths.
    let (seat, mass, moment) = unsafe {
        (
            array_mut(seat_m, 2),
            array_mut(mass_kg, 1),
            array_mut(moment_kg_m2, 1),
        )
    };
    let mut numbers = [seat, mass, moment];
    for place in numbers.iter_mut().flatten() {
        place.fill(f64::NAN);
    }
    status_of(law, |law| {
        let part = usize::try_from(body).ok().and_then(|k| law.bodies().get(k));
        let part = part.ok_or_else(|| {
            argument(format!(
                "there is no body {body} among {}",
                law.bodies().len()
            ))
        })?;
        if !carrier.is_null() {
            // SAFETY: not null, and the caller promises an address.
            unsafe { carrier.write(part.carrier.number()) };
        }
        let values: [&[f64]; 3] = [&part.seat_m, &[part.mass_kg], &[part.moment_kg_m2]];
        for (place, values) in numbers.iter_mut().zip(values) {
            if let Some(place) = place {
                place.copy_from_slice(values);
            }
        }
        Ok(())
    })
}

/// Returns the rate of the input shaft, rad/s.
#[unsafe(no_mangle)]
pub extern "C" fn pinwheel_law_rate(law: *const PinwheelLaw) -> f64 {
    on(
        law,
        |_| f64::NAN,
        |law| Ok(law.gearbox.scene.drive.input_speed_rad_s),
    )
}

/// Returns the scene's step, s.
#[unsafe(no_mangle)]
pub extern "C" fn pinwheel_law_step(law: *const PinwheelLaw) -> f64 {
    on(law, |_| f64::NAN, |law| Ok(law.gearbox.scene.solver.step_s))
}

/// Returns the number of samples of the time series, and writes up to `room` of their times.
///
/// # Safety
/// `times_s`: null if `room` is 0, else the address of `room` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pinwheel_law_samples(
    law: *const PinwheelLaw,
    times_s: *mut f64,
    room: i64,
) -> i64 {
    on(law, i64::from, |law| {
        let room = usize::try_from(room).map_err(|_| argument("`room` is below 0"))?;
        let samples = &law.samples;
        let fit = room.min(samples.len());
        if fit > 0 {
            // SAFETY: the caller promises `room` numbers, and no more are accessed.
            let times = unsafe { array_mut(times_s, fit) };
            let times = times.ok_or_else(|| argument("`times_s` is null, but `room` is not 0"))?;
            times.copy_from_slice(&samples[..fit]);
        }
        i64::try_from(samples.len()).map_err(|_| argument("too many samples"))
    })
}

/// Writes the bodies' states at t = 0.
///
/// # Safety
/// `states`: null or the address of six numbers for each body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pinwheel_law_start(law: *const PinwheelLaw, states: *mut f64) -> i32 {
    status_of(law, |law| {
        // SAFETY: the caller promises their length.
        let states = unsafe { array_mut(states, law.start().len()) };
        let states = states.ok_or_else(|| argument("`states` is null"))?;
        states.copy_from_slice(law.start());
        Ok(())
    })
}

/// Evaluates the contact forces at these states.
///
/// # Safety
/// `states`: null or six numbers for each body. `loads`: null or the address of three for each body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pinwheel_law_loads(
    law: *mut PinwheelLaw,
    states: *const f64,
    loads: *mut f64,
) -> i32 {
    status_of(law, |law| {
        let bodies = law.bodies().len();
        // SAFETY: the caller promises their lengths, and that they do not overlap.
        let (states, loads) = unsafe {
            (
                array(states, STATE * bodies),
                array_mut(loads, LOAD * bodies),
            )
        };
        let loads = loads.ok_or_else(|| argument("`loads` is null"))?;
        // NaN stays in the loads if the evaluation panics.
        loads.fill(f64::NAN);
        let states = states.ok_or_else(|| argument("`states` is null"))?;
        law.loads(states, loads)?;
        Ok(())
    })
}

/// Returns the load torque on the output shaft, N m.
#[unsafe(no_mangle)]
pub extern "C" fn pinwheel_law_load_torque(law: *const PinwheelLaw, time_s: f64) -> f64 {
    on(
        law,
        |_| f64::NAN,
        |law| {
            if time_s.is_finite() {
                return Ok(law.gearbox.load_torque(time_s));
            }
            Err(Failure(NOT_FINITE, "the time is not finite".to_owned()))
        },
    )
}

/// Returns the number of calls for forces; 0 for an invalid handle.
#[unsafe(no_mangle)]
pub extern "C" fn pinwheel_law_calls(law: *const PinwheelLaw) -> u64 {
    on(law, |_| 0, |law| Ok(law.calls()))
}

/// Returns the message of this thread's last failed call; empty if no call failed. Valid until its next call.
#[unsafe(no_mangle)]
pub extern "C" fn pinwheel_law_error() -> *const c_char {
    ERROR
        .try_with(|error| error.borrow().as_ptr())
        .unwrap_or(c"".as_ptr())
}

/// Closes a handle. Null and a closed handle are permitted.
#[unsafe(no_mangle)]
pub extern "C" fn pinwheel_law_close(law: *mut PinwheelLaw) {
    guarded(
        |_| (),
        || {
            LAWS.close(law);
            Ok(())
        },
    );
}
