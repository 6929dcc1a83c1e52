//! C interface: the functions of FMI 2.0 for co-simulation, with the names, types and numbers of the standard. All `unsafe` of
//! this crate is in this file and in the files below it.
//!
//! Importers guarantee some facts that no code can check: texts end in a zero byte; arrays are aligned, have the stated length,
//! and are not used by others during the call; the logger is the standard's and outlives the unit. Everything else is checked.
//! A component and a state are unique numbers, not addresses, so that freed or invented ones are refused; null addresses are
//! refused; no panic leaves the library. A refused call reports the reason to the logger, returns `fmi2Error`, and leaves the
//! unit unchanged. Memory is allocated by the library, not by the importer.

#![allow(unsafe_code)]

pub mod states;
pub mod status;
pub mod values;

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::ptr;
use std::slice;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use pinwheel_gearbox::handles::Handles;

use crate::instance::{Instance, Refusal};
use crate::model::Model;

const OK: c_int = 0;
const WARNING: c_int = 1;
const ERROR: c_int = 3;
/// Constant `fmi2CoSimulation` of `fmi2Type`.
const CO_SIMULATION: c_int = 1;

/// Signature of the logger: environment, instance, status, category, message in printf format, its arguments.
type Log =
    unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// Structure `fmi2CallbackFunctions`.
#[repr(C)]
pub struct Callbacks {
    /// Function that receives messages.
    pub logger: Option<Log>,
    /// Not used: `canNotUseMemoryManagementFunctions`.
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Not used.
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Not used: steps are complete when the call returns.
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    /// Value that is passed back to the logger.
    pub environment: *mut c_void,
}

/// Handle of a unit for the importer: a number in the form of an address.
pub type Component = *mut c_void;
/// Handle of a saved state for the importer: a number in the form of an address.
pub type State = *mut c_void;

/// Logger of the importer, which receives refusals.
struct Logger {
    log: Option<Log>,
    environment: *mut c_void,
    name: CString,
}

// SAFETY: by the standard the importer is responsible for its environment in any calling thread; here it is only passed back.
unsafe impl Send for Logger {}
// SAFETY: as above; none of its data change.
unsafe impl Sync for Logger {}

impl Logger {
    fn tell(&self, status: c_int, category: &CStr, message: &str) {
        let Some(log) = self.log else { return };
        // The message is a printf format, in which a percent sign is doubled.
        let text = message.replace('\0', " ").replace('%', "%%");
        let text = CString::new(text).unwrap_or_default();
        let [name, category, text] = [&self.name, category, &text].map(|text: &CStr| text.as_ptr());
        // SAFETY: the importer's logger, with the arguments of the standard.
        unsafe { log(self.environment, name, status, category, text) };
    }
}

struct Unit {
    logger: Logger,
    talks: AtomicBool,
    /// Phase of a step: [`IDLE`], [`STEPPING`] or [`CANCELLED`].
    step: AtomicU8,
    instance: Mutex<Instance>,
}

const IDLE: u8 = 0;
const STEPPING: u8 = 1;
const CANCELLED: u8 = 2;

impl Unit {
    /// Cancels the step that another thread computes; returns true if there was one.
    fn cancel(&self) -> bool {
        let (step, order) = (&self.step, Ordering::Relaxed);
        step.compare_exchange(STEPPING, CANCELLED, order, order)
            .is_ok()
    }
}

/// Saved state and its unit.
struct Kept {
    of: usize,
    bytes: Mutex<Vec<u8>>,
}

static UNITS: Handles<Unit> = Handles::new();
static STATES: Handles<Kept> = Handles::new();

/// Runs a call on a unit and reports a refusal to its logger.
fn on(component: Component, call: impl FnOnce(&mut Instance) -> Result<c_int, Refusal>) -> c_int {
    let Some(unit) = UNITS.find(component) else {
        return ERROR;
    };
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        let mut instance = unit.instance.lock().unwrap_or_else(PoisonError::into_inner);
        call(&mut instance)
    }));
    let outcome = outcome.unwrap_or_else(|_| {
        let what = "a fault in the unit, not in your call; please report it with the scene";
        Err(Refusal(what.to_owned()))
    });
    outcome.unwrap_or_else(|Refusal(what)| {
        unit.logger.tell(ERROR, c"logStatusError", &what);
        ERROR
    })
}

fn done(result: Result<(), Refusal>) -> Result<c_int, Refusal> {
    result.map(|()| OK)
}

fn null(what: &str) -> Refusal {
    Refusal(format!("{what} is null"))
}

/// Returns an array of the caller as a slice.
///
/// # Safety
/// `start` is null or the start of `length` values, as the module describes.
unsafe fn array<'a, T>(what: &str, start: *const T, length: usize) -> Result<&'a [T], Refusal> {
    if length == 0 {
        return Ok(&[]);
    }
    if start.is_null() {
        return Err(null(what));
    }
    // SAFETY: not null, and the caller promises its length.
    Ok(unsafe { slice::from_raw_parts(start, length) })
}

/// Returns an array of the caller as a mutable slice.
///
/// # Safety
/// `start` is null or the start of `length` values, as the module describes.
unsafe fn array_mut<'a, T>(
    what: &str,
    start: *mut T,
    length: usize,
) -> Result<&'a mut [T], Refusal> {
    if length == 0 {
        return Ok(&mut []);
    }
    if start.is_null() {
        return Err(null(what));
    }
    // SAFETY: not null, and the caller promises its length.
    Ok(unsafe { slice::from_raw_parts_mut(start, length) })
}

/// Returns a text of the caller; `None` if it is null or not UTF-8.
///
/// # Safety
/// Null, or text that ends in a zero byte.
unsafe fn text<'a>(start: *const c_char) -> Option<&'a str> {
    if start.is_null() {
        return None;
    }
    // SAFETY: not null, and the caller promises its end.
    unsafe { CStr::from_ptr(start) }.to_str().ok()
}

/// Returns the folder of an FMI address: `file:///folder`, `file:/folder`, or a bare path.
fn folder(address: &str) -> PathBuf {
    let path = match address.strip_prefix("file:") {
        None => return PathBuf::from(address),
        Some(rest) => rest.strip_prefix("//").unwrap_or(rest),
    };
    let path = path.strip_prefix("localhost").unwrap_or(path);
    let path = percent_encoding::percent_decode_str(path).decode_utf8_lossy();
    // A drive letter follows the slash.
    let drive = cfg!(windows) && path.as_bytes().get(2) == Some(&b':');
    PathBuf::from(if drive { &path[1..] } else { &*path })
}

/// Returns the platform of the types, `"default"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// Returns the version of the standard, `"2.0"`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Switches messages beyond refusals on or off.
///
/// # Safety
/// `categories`: null or `count` texts, which are not read, because there is one category.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    component: Component,
    on: c_int,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    let Some(unit) = UNITS.find(component) else {
        return ERROR;
    };
    unit.talks.store(on != 0, Ordering::Relaxed);
    OK
}

/// Creates a unit; returns null if that fails.
///
/// # Safety
/// Texts: null or zero-terminated. `callbacks`: null or the standard's structure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    talks: c_int,
) -> Component {
    // SAFETY: null or the standard's structure.
    let callbacks = unsafe { callbacks.as_ref() };
    // SAFETY: null or zero-terminated texts.
    let (name, guid, resources) = unsafe { (text(name), text(guid), text(resources)) };
    let logger = Logger {
        log: callbacks.and_then(|callbacks| callbacks.logger),
        environment: callbacks.map_or(ptr::null_mut(), |callbacks| callbacks.environment),
        name: CString::new(name.unwrap_or("pinwheel")).unwrap_or_default(),
    };
    let begin = || -> Result<Instance, String> {
        if name.is_none_or(str::is_empty) {
            return Err("fmi2Instantiate: the instance needs a name".to_owned());
        }
        if kind != CO_SIMULATION {
            return Err("fmi2Instantiate: this unit is for co-simulation".to_owned());
        }
        let resources = resources.ok_or("fmi2Instantiate: the resources have no address")?;
        let model = Model::read(&folder(resources))?;
        if guid != Some(model.guid()) {
            let (given, own) = (guid.unwrap_or("that was given"), model.guid());
            return Err(format!(
                "fmi2Instantiate: the GUID {given} is not that of this unit, {own}"
            ));
        }
        Ok(Instance::new(Arc::new(model)))
    };
    let begun = catch_unwind(AssertUnwindSafe(begin))
        .unwrap_or_else(|_| Err("fmi2Instantiate: a fault in the unit; please report it".into()));
    match begun {
        Ok(instance) => UNITS.open(Unit {
            logger,
            talks: AtomicBool::new(talks != 0),
            step: AtomicU8::new(IDLE),
            instance: Mutex::new(instance),
        }),
        Err(what) => {
            logger.tell(ERROR, c"logStatusError", &what);
            ptr::null_mut()
        }
    }
}

/// Frees a unit with its states and ends a step that another thread computes. Null and a freed unit are permitted.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeInstance(component: Component) {
    // A panic while the unit is dropped does not reach the caller.
    let _ = catch_unwind(|| {
        if let Some(unit) = UNITS.close(component) {
            unit.cancel();
        }
        STATES.close_all(|kept| kept.of == component.addr());
    });
}

/// Sets times and tolerance of the simulation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetupExperiment(
    component: Component,
    has_tolerance: c_int,
    tolerance: f64,
    start: f64,
    has_stop: c_int,
    stop: f64,
) -> c_int {
    on(component, |unit| {
        let tolerance = (has_tolerance != 0).then_some(tolerance);
        done(unit.setup(tolerance, start, (has_stop != 0).then_some(stop)))
    })
}

/// Enters the initialisation: builds the gear.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterInitializationMode(component: Component) -> c_int {
    on(component, |unit| done(unit.enter_initialization()))
}

/// Ends the initialisation: steps may follow.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2ExitInitializationMode(component: Component) -> c_int {
    on(component, |unit| {
        unit.exit_initialization()?;
        if let Some(own) = UNITS.find(component) {
            if let Some(what) = unit.unheeded() {
                own.logger.tell(WARNING, c"logStatusWarning", &what);
            }
            if own.talks.load(Ordering::Relaxed) {
                own.logger.tell(OK, c"logAll", &unit.method());
            }
        }
        Ok(OK)
    })
}

/// Ends the simulation: no more steps.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Terminate(component: Component) -> c_int {
    on(component, |unit| done(unit.terminate()))
}

/// Returns the unit to its state after instantiation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Reset(component: Component) -> c_int {
    on(component, |unit| {
        unit.reset();
        Ok(OK)
    })
}

/// Refuses references to variables of a type that no variable has.
fn none(component: Component, call: &str, count: usize) -> c_int {
    on(component, |_| {
        if count == 0 {
            return Ok(OK);
        }
        Err(Refusal(format!(
            "{call}: the unit has no variable of this type"
        )))
    })
}

/// Advances the unit to the next communication point.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2DoStep(
    component: Component,
    from: f64,
    step: f64,
    _no_way_back: c_int,
) -> c_int {
    on(component, |instance| {
        // The unit is absent only while another thread frees it.
        let Some(unit) = UNITS.find(component) else {
            return Ok(ERROR);
        };
        unit.step.store(STEPPING, Ordering::Relaxed);
        let cancelled = || unit.step.load(Ordering::Relaxed) == CANCELLED;
        let stepped = instance.step_unless(from, step, &cancelled);
        unit.step.store(IDLE, Ordering::Relaxed);
        done(stepped)
    })
}

/// Cancels a step in another thread: it returns as failed, and the unit continues from an earlier state or after a reset.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2CancelStep(component: Component) -> c_int {
    if UNITS.find(component).is_some_and(|unit| unit.cancel()) {
        return OK;
    }
    on(component, |_| {
        Err(Refusal("fmi2CancelStep: no step is under way".into()))
    })
}
