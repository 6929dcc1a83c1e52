//! C functions as called by an importer: loaded from the library at run time, with a logger.
#![allow(unsafe_code, reason = "this is what an importer does")]

use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::path::Path;
use std::ptr;
use std::sync::Mutex;

use libloading::{Library, Symbol};
use pinwheel_fmu::Model;
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;

use crate::library;

static HEARD: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Logger of an importer; variable arguments are never used.
unsafe extern "C" fn hear(
    _environment: *mut c_void,
    name: *const c_char,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: texts of the unit.
    let words = unsafe {
        [name, category, message].map(|text| CStr::from_ptr(text).to_string_lossy().into_owned())
    };
    HEARD
        .lock()
        .expect("heard")
        .push(format!("{status} {}", words.join(" ")));
}

#[repr(C)]
struct Callbacks {
    logger: *const c_void,
    others: [*const c_void; 4],
}

type Component = *mut c_void;
type Instantiate = unsafe extern "C" fn(
    *const c_char,
    c_int,
    *const c_char,
    *const c_char,
    *const Callbacks,
    c_int,
    c_int,
) -> Component;
type Plain = unsafe extern "C" fn(Component) -> c_int;
type Setup = unsafe extern "C" fn(Component, c_int, f64, f64, c_int, f64) -> c_int;
type Get = unsafe extern "C" fn(Component, *const c_uint, usize, *mut f64) -> c_int;
type Set = unsafe extern "C" fn(Component, *const c_uint, usize, *const f64) -> c_int;
type Step = unsafe extern "C" fn(Component, f64, f64, c_int) -> c_int;
type KeepState = unsafe extern "C" fn(Component, *mut *mut c_void) -> c_int;
type SetState = unsafe extern "C" fn(Component, *mut c_void) -> c_int;
type StateSize = unsafe extern "C" fn(Component, *mut c_void, *mut usize) -> c_int;
type Write = unsafe extern "C" fn(Component, *mut c_void, *mut u8, usize) -> c_int;
type Read = unsafe extern "C" fn(Component, *const u8, usize, *mut *mut c_void) -> c_int;
type Text = unsafe extern "C" fn() -> *const c_char;
type RealStatus = unsafe extern "C" fn(Component, c_int, *mut f64) -> c_int;

/// Names of all functions of the standard for co-simulation.
const ALL: [&str; 34] = [
    "fmi2GetTypesPlatform",
    "fmi2GetVersion",
    "fmi2SetDebugLogging",
    "fmi2Instantiate",
    "fmi2FreeInstance",
    "fmi2SetupExperiment",
    "fmi2EnterInitializationMode",
    "fmi2ExitInitializationMode",
    "fmi2Terminate",
    "fmi2Reset",
    "fmi2GetReal",
    "fmi2GetInteger",
    "fmi2GetBoolean",
    "fmi2GetString",
    "fmi2SetReal",
    "fmi2SetInteger",
    "fmi2SetBoolean",
    "fmi2SetString",
    "fmi2GetFMUstate",
    "fmi2SetFMUstate",
    "fmi2FreeFMUstate",
    "fmi2SerializedFMUstateSize",
    "fmi2SerializeFMUstate",
    "fmi2DeSerializeFMUstate",
    "fmi2GetDirectionalDerivative",
    "fmi2SetRealInputDerivatives",
    "fmi2GetRealOutputDerivatives",
    "fmi2DoStep",
    "fmi2CancelStep",
    "fmi2GetStatus",
    "fmi2GetRealStatus",
    "fmi2GetIntegerStatus",
    "fmi2GetBooleanStatus",
    "fmi2GetStringStatus",
];

/// Writes the resources of a unit of the paper's gear; returns their address and GUID.
fn resources(folder: &Path) -> (CString, CString) {
    let scene = Scene::load("paper", &[]).expect("paper");
    let model = Model::of(&Gearbox::new(&scene).expect("gearbox")).expect("model");
    let place = folder.join("a folder");
    std::fs::create_dir(&place).expect("folder");
    std::fs::write(place.join("scene.toml"), model.text()).expect("scene");
    let address = format!("file://{}", place.display()).replace(' ', "%20");
    (
        CString::new(address).expect("address"),
        CString::new(model.guid()).expect("guid"),
    )
}

#[test]
fn crossval_the_loaded_library_runs_rolls_back_and_refuses() {
    let folder = tempfile::tempdir().expect("folder");
    let (address, guid) = resources(folder.path());
    let callbacks = Callbacks {
        logger: hear as *const c_void,
        others: [ptr::null(); 4],
    };
    let last = || {
        HEARD
            .lock()
            .expect("heard")
            .last()
            .cloned()
            .unwrap_or_default()
    };
    // SAFETY: the functions of the standard with its types, on arrays of their lengths.
    unsafe {
        let library = Library::new(library()).expect("loads");
        for name in ALL {
            assert!(library.get::<Plain>(name.as_bytes()).is_ok(), "{name}");
        }
        macro_rules! function {
            ($kind:ty, $name:literal) => {{
                let symbol: Symbol<'_, $kind> = library.get($name).expect("there");
                symbol
            }};
        }
        let version = function!(Text, b"fmi2GetVersion");
        assert_eq!(CStr::from_ptr(version()).to_bytes(), b"2.0");
        let instantiate = function!(Instantiate, b"fmi2Instantiate");
        let free = function!(unsafe extern "C" fn(Component), b"fmi2FreeInstance");
        let name = c"gear %s";
        let new = |guid: &CStr, address: &CStr| {
            let (guid, address) = (guid.as_ptr(), address.as_ptr());
            instantiate(name.as_ptr(), 1, guid, address, &raw const callbacks, 0, 1)
        };
        assert!(new(c"{other}", &address).is_null());
        assert!(last().contains("GUID {other}"), "{}", last());
        assert!(new(&guid, c"file:///nowhere").is_null());
        assert!(last().contains("/nowhere/scene.toml"), "{}", last());
        let unit = new(&guid, &address);
        assert!(!unit.is_null(), "{}", last());

        let setup = function!(Setup, b"fmi2SetupExperiment");
        let enter = function!(Plain, b"fmi2EnterInitializationMode");
        let exit = function!(Plain, b"fmi2ExitInitializationMode");
        let step = function!(Step, b"fmi2DoStep");
        let get = function!(Get, b"fmi2GetReal");
        let set = function!(Set, b"fmi2SetReal");
        assert_eq!(step(unit, 0.0, 1e-3, 1), 3, "too early");
        assert!(
            last().starts_with("3 gear %s logStatusError fmi2DoStep"),
            "{}",
            last()
        );
        assert_eq!(setup(unit, 0, 0.0, 5.0, 0, 0.0), 0);
        assert_eq!((enter(unit), exit(unit)), (0, 0));
        assert!(
            last().contains("etd-adams") || last().contains("rk2"),
            "{}",
            last()
        );
        assert_eq!(step(unit, 5.0, 1e-3, 0), 0, "{}", last());

        let keep = function!(KeepState, b"fmi2GetFMUstate");
        let back = function!(SetState, b"fmi2SetFMUstate");
        let forget = function!(KeepState, b"fmi2FreeFMUstate");
        let size = function!(StateSize, b"fmi2SerializedFMUstateSize");
        let write = function!(Write, b"fmi2SerializeFMUstate");
        let read = function!(Read, b"fmi2DeSerializeFMUstate");
        let mut state = ptr::null_mut();
        assert_eq!(keep(unit, &raw mut state), 0);
        let references: Vec<c_uint> = (4..12).collect();
        let values = || {
            let mut values = vec![f64::NAN; references.len()];
            let status = get(unit, references.as_ptr(), values.len(), values.as_mut_ptr());
            assert_eq!(status, 0, "{}", last());
            values.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(step(unit, 5.001, 1e-3, 0), 0);
        let wanted = values();
        assert_eq!((back(unit, state), step(unit, 5.001, 1e-3, 0)), (0, 0));
        assert_eq!(values(), wanted);
        let mut length = 0;
        assert_eq!(size(unit, state, &raw mut length), 0);
        let mut bytes = vec![0; length];
        assert_eq!(
            write(unit, state, bytes.as_mut_ptr(), length - 1),
            3,
            "too short"
        );
        assert_eq!(write(unit, state, bytes.as_mut_ptr(), length), 0);
        let mut again = ptr::null_mut();
        assert_eq!(read(unit, bytes.as_ptr(), length, &raw mut again), 0);
        assert_eq!((back(unit, again), step(unit, 5.001, 1e-3, 0)), (0, 0));
        assert_eq!(values(), wanted);
        bytes[7] ^= 1;
        let mut none = ptr::null_mut();
        assert_eq!(read(unit, bytes.as_ptr(), length, &raw mut none), 3);
        assert!(none.is_null() && last().contains("damaged"), "{}", last());
        assert_eq!((forget(unit, &raw mut state), state.is_null()), (0, true));
        assert_eq!(back(unit, ptr::without_provenance_mut(77)), 3, "made up");

        let unknown = [99_999 as c_uint];
        let mut place = [0.0];
        assert_eq!(get(unit, unknown.as_ptr(), 1, place.as_mut_ptr()), 3);
        assert!(last().contains("99999"), "{}", last());
        assert_eq!(set(unit, [0 as c_uint].as_ptr(), 1, [f64::NAN].as_ptr()), 3);
        assert!(last().contains("finite"), "{}", last());
        assert_eq!(set(unit, ptr::null(), 1, place.as_ptr()), 3);
        assert!(last().contains("null"), "{}", last());
        let status = function!(RealStatus, b"fmi2GetRealStatus");
        assert_eq!(status(unit, 2, place.as_mut_ptr()), 0);
        assert!((place[0] - 5.002).abs() < 1e-12);

        // The paper's method has a fixed step, so a tolerance has no effect, with a note.
        let reset = function!(Plain, b"fmi2Reset");
        assert_eq!((reset(unit), setup(unit, 1, 1e-9, 0.0, 0, 0.0)), (0, 0));
        assert_eq!((enter(unit), exit(unit)), (0, 0));
        let text = "1 gear %s logStatusWarning the tolerance 1e-9 has no effect on the scene's method (rk2, steps of 1e-5 s)";
        let heard = HEARD.lock().expect("heard").clone();
        assert!(heard.iter().any(|line| line.starts_with(text)), "{heard:?}");

        free(unit);
        free(unit);
        free(ptr::null_mut());
        assert_eq!(step(unit, 0.0, 1e-3, 0), 3, "freed");
        assert_eq!(step(ptr::null_mut(), 0.0, 1e-3, 0), 3, "null");
    }
}

/// Handle shared between threads; it is a number.
#[derive(Clone, Copy)]
struct Shared(Component);

// SAFETY: the unit is looked up by its number and locked.
unsafe impl Send for Shared {}

impl Shared {
    fn get(self) -> Component {
        self.0
    }
}

/// Units in several threads, one unit in several threads, and steps that another thread ends by cancelling or freeing.
#[test]
fn hard_units_under_threads() {
    let folder = tempfile::tempdir().expect("folder");
    let (address, guid) = resources(folder.path());
    // SAFETY: the functions of the standard with its types, on arrays of their lengths.
    unsafe {
        let library = Library::new(library()).expect("loads");
        macro_rules! function {
            ($kind:ty, $name:literal) => {{
                let symbol: Symbol<'_, $kind> = library.get($name).expect("there");
                *symbol
            }};
        }
        let instantiate = function!(Instantiate, b"fmi2Instantiate");
        let free = function!(unsafe extern "C" fn(Component), b"fmi2FreeInstance");
        let setup = function!(Setup, b"fmi2SetupExperiment");
        let enter = function!(Plain, b"fmi2EnterInitializationMode");
        let exit = function!(Plain, b"fmi2ExitInitializationMode");
        let step = function!(Step, b"fmi2DoStep");
        let cancel = function!(Plain, b"fmi2CancelStep");
        let reset = function!(Plain, b"fmi2Reset");
        let get = function!(Get, b"fmi2GetReal");
        let begin = move |unit| {
            assert_eq!(setup(unit, 0, 0.0, 0.0, 0, 0.0), 0);
            assert_eq!((enter(unit), exit(unit)), (0, 0));
        };
        let new = || {
            let (guid, address) = (guid.as_ptr(), address.as_ptr());
            let unit = instantiate(c"gear".as_ptr(), 1, guid, address, ptr::null(), 0, 0);
            assert!(!unit.is_null());
            begin(unit);
            Shared(unit)
        };
        let values = move |unit: Component| {
            let references: Vec<c_uint> = (4..12).collect();
            let mut values = vec![f64::NAN; references.len()];
            let place = values.as_mut_ptr();
            assert_eq!(get(unit, references.as_ptr(), references.len(), place), 0);
            values.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
        };
        // One unit for each thread: equal to the bit.
        let alone = new().get();
        for k in 0..20 {
            assert_eq!(step(alone, f64::from(k) * 1e-3, 1e-3, 1), 0);
        }
        let wanted = values(alone);
        let each = (0..8).map(|_| {
            let unit = new();
            std::thread::spawn(move || {
                for k in 0..20 {
                    assert_eq!(step(unit.get(), f64::from(k) * 1e-3, 1e-3, 1), 0);
                }
                values(unit.get())
            })
        });
        for thread in each.collect::<Vec<_>>() {
            assert_eq!(thread.join().expect("no panic"), wanted);
        }
        // One unit for all threads: every step is computed once.
        let one = new();
        let each = (0..8).map(|_| {
            std::thread::spawn(move || {
                let step = |k| step(one.get(), f64::from(k) * 1e-3, 1e-3, 1);
                (0..20).filter(|&k| step(k) == 0).count()
            })
        });
        let done = each.collect::<Vec<_>>().into_iter();
        let done: usize = done.map(|thread| thread.join().expect("no panic")).sum();
        assert!((1..=20).contains(&done), "{done}");
        // A step of a day ends when cancelled.
        let long = new();
        assert_eq!(cancel(long.get()), 3, "no step is under way");
        for freed in [false, true] {
            let thread = std::thread::spawn(move || step(long.get(), 0.0, 86_400.0, 1));
            std::thread::sleep(std::time::Duration::from_millis(50));
            if freed {
                free(long.get());
            } else {
                while cancel(long.get()) != 0 {}
            }
            assert_eq!(thread.join().expect("no panic"), 3);
            if !freed {
                assert_eq!(
                    step(long.get(), 0.0, 1e-3, 1),
                    3,
                    "an earlier state or a reset"
                );
                assert_eq!(reset(long.get()), 0);
                begin(long.get());
            }
        }
    }
}
