//! Values of variables, and changes of inputs over a step.

use std::ffi::{c_char, c_int, c_uint};

use super::{Component, Instance, OK, Refusal, array, array_mut, none, on};

const REFERENCES: &str = "the list of value references";
const VALUES: &str = "the list of values";

/// Writes a value for each reference.
///
/// # Safety
/// `references` and `values`: null or of `count`.
unsafe fn get<T>(
    component: Component,
    references: *const c_uint,
    count: usize,
    values: *mut T,
    value: impl Fn(&mut Instance, c_uint) -> Result<T, Refusal>,
) -> c_int {
    on(component, |unit| {
        // SAFETY: the caller promises their lengths.
        let (references, values) = unsafe {
            (
                array(REFERENCES, references, count)?,
                array_mut(VALUES, values, count)?,
            )
        };
        for (place, reference) in values.iter_mut().zip(references) {
            *place = value(unit, *reference)?;
        }
        Ok(OK)
    })
}

/// Sets the value of each reference.
///
/// # Safety
/// Requirements of [`get`].
unsafe fn set<T: Copy>(
    component: Component,
    references: *const c_uint,
    count: usize,
    values: *const T,
    put: impl Fn(&mut Instance, c_uint, T) -> Result<(), Refusal>,
) -> c_int {
    on(component, |unit| {
        // SAFETY: the caller promises their lengths.
        let (references, values) = unsafe {
            (
                array(REFERENCES, references, count)?,
                array(VALUES, values, count)?,
            )
        };
        for (reference, value) in references.iter().zip(values) {
            put(unit, *reference, *value)?;
        }
        Ok(OK)
    })
}

/// Returns values of Real variables.
///
/// # Safety
/// `references` and `values`: null or of `count`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    component: Component,
    references: *const c_uint,
    count: usize,
    values: *mut f64,
) -> c_int {
    // SAFETY: as the caller promises.
    unsafe { get(component, references, count, values, Instance::real) }
}

/// Returns values of Boolean variables.
///
/// # Safety
/// Requirements of [`fmi2GetReal`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    component: Component,
    references: *const c_uint,
    count: usize,
    values: *mut c_int,
) -> c_int {
    // SAFETY: as the caller promises.
    unsafe {
        get(component, references, count, values, |unit, reference| {
            unit.boolean(reference).map(c_int::from)
        })
    }
}

/// Sets values of Real variables.
///
/// # Safety
/// Requirements of [`fmi2GetReal`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    component: Component,
    references: *const c_uint,
    count: usize,
    values: *const f64,
) -> c_int {
    // SAFETY: as the caller promises.
    unsafe { set(component, references, count, values, Instance::set_real) }
}

/// Sets values of Boolean variables.
///
/// # Safety
/// Requirements of [`fmi2GetReal`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    component: Component,
    references: *const c_uint,
    count: usize,
    values: *const c_int,
) -> c_int {
    let put = |unit: &mut Instance, reference, value| unit.set_boolean(reference, value != 0);
    // SAFETY: as the caller promises.
    unsafe { set(component, references, count, values, put) }
}

/// Functions for values of a type that no variable has: any reference is refused.
macro_rules! of_no_variable {
    ($($function:ident($values:ty);)*) => {$(
        /// Refuses any reference: no variable has this type.
        #[unsafe(no_mangle)]
        pub extern "C" fn $function(
            component: Component,
            _references: *const c_uint,
            count: usize,
            _values: $values,
        ) -> c_int {
            none(component, stringify!($function), count)
        }
    )*};
}

of_no_variable! {
    fmi2GetInteger(*mut c_int);
    fmi2SetInteger(*const c_int);
    fmi2GetString(*mut *const c_char);
    fmi2SetString(*const *const c_char);
}

/// Not provided: `providesDirectionalDerivative` is false.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetDirectionalDerivative(
    component: Component,
    _unknown: *const c_uint,
    _unknowns: usize,
    _known: *const c_uint,
    _knowns: usize,
    _seed: *const f64,
    _derivative: *mut f64,
) -> c_int {
    none(component, "fmi2GetDirectionalDerivative", 1)
}

/// Sets the first derivatives of inputs over the next step.
///
/// # Safety
/// Arrays: null or of `count`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    component: Component,
    references: *const c_uint,
    count: usize,
    orders: *const c_int,
    values: *const f64,
) -> c_int {
    on(component, |unit| {
        // SAFETY: the caller promises their lengths.
        let (references, orders, values) = unsafe {
            (
                array(REFERENCES, references, count)?,
                array("the list of orders", orders, count)?,
                array(VALUES, values, count)?,
            )
        };
        for ((reference, order), value) in references.iter().zip(orders).zip(values) {
            unit.set_slope(*reference, *order, *value)?;
        }
        Ok(OK)
    })
}

/// Not provided: `maxOutputDerivativeOrder` is 0.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetRealOutputDerivatives(
    component: Component,
    _references: *const c_uint,
    count: usize,
    _orders: *const c_int,
    _values: *mut f64,
) -> c_int {
    none(component, "fmi2GetRealOutputDerivatives", count)
}
