//! Library as used by foreign programs: loaded at run time, and linked by a program in C.

use std::ffi::{CStr, CString, c_char, c_void};
use std::path::{Path, PathBuf};
use std::process::Command;

use pinwheel_law::Law;

/// Returns the path of `libpinwheel_law` of this build, beside the tests.
fn library() -> PathBuf {
    let name = format!(
        "{}pinwheel_law{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    let here = std::env::current_exe().expect("this test");
    let library = here.parent().expect("its folder").join(name);
    assert!(library.is_file(), "{} is not there", library.display());
    library
}

fn wanted(scene: &str) -> Vec<f64> {
    let mut law = Law::open(scene).expect(scene);
    let states = law.start().to_vec();
    let mut loads = vec![0.0; states.len() / 2];
    law.loads(&states, &mut loads).expect("forces");
    loads
}

#[test]
#[allow(unsafe_code, reason = "this is what a foreign program does")]
fn crossval_the_loaded_library_gives_the_forces_of_the_crate() {
    type Open = unsafe extern "C" fn(*const c_char, *mut *mut c_void) -> i32;
    type Numbers = unsafe extern "C" fn(*mut c_void, *mut f64) -> i32;
    type Loads = unsafe extern "C" fn(*mut c_void, *const f64, *mut f64) -> i32;
    type Words = unsafe extern "C" fn() -> *const c_char;
    let scene = CString::new("paper-friction").expect("text");
    let expected = wanted("paper-friction");
    let mut states = vec![0.0; 2 * expected.len()];
    let mut loads = vec![0.0; expected.len()];
    // SAFETY: the functions of the header with its types, on arrays of their lengths.
    unsafe {
        let library = libloading::Library::new(library()).expect("loads");
        let open: libloading::Symbol<'_, Open> = library.get(b"pinwheel_law_open").expect("open");
        let start: libloading::Symbol<'_, Numbers> =
            library.get(b"pinwheel_law_start").expect("start");
        let forces: libloading::Symbol<'_, Loads> =
            library.get(b"pinwheel_law_loads").expect("loads");
        let error: libloading::Symbol<'_, Words> =
            library.get(b"pinwheel_law_error").expect("error");
        let mut law = std::ptr::null_mut();
        assert_eq!(open(scene.as_ptr(), &raw mut law), 0);
        assert_eq!(start(law, states.as_mut_ptr()), 0);
        assert_eq!(forces(law, states.as_ptr(), loads.as_mut_ptr()), 0);
        assert_eq!(open(c"papre".as_ptr(), &raw mut law), -2);
        assert!(CStr::from_ptr(error()).to_string_lossy().contains("papre"));
    }
    assert_eq!(loads, expected);
}

/// The header compiles as C and as C++ without a warning, and the program links and runs.
#[test]
#[cfg(unix)]
fn crossval_a_program_in_c_gives_the_forces_of_the_crate() {
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let source = crate_folder.join("tests/c/caller.c");
    let folder = tempfile::tempdir().expect("folder");
    let library = library();
    let beside = library.parent().expect("its folder");
    for (compiler, language) in [
        ("cc", &["-std=c99", "-D_POSIX_C_SOURCE=200809L"][..]),
        ("c++", &["-x", "c++"]),
    ] {
        if Command::new(compiler).arg("--version").output().is_err() {
            println!("skipped: no `{compiler}` here");
            continue;
        }
        let program = folder.path().join(compiler);
        let compiled = Command::new(compiler)
            .args(language)
            .args(["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-pthread"])
            .arg("-I")
            .arg(crate_folder.join("include"))
            .arg(&source)
            .args(["-x", "none"])
            .arg(&library)
            .arg(format!("-Wl,-rpath,{}", beside.display()))
            .args(["-lm", "-o"])
            .arg(&program)
            .output()
            .expect("it is there");
        let words = String::from_utf8_lossy(&compiled.stderr);
        assert!(compiled.status.success(), "{compiler}: {words}");
        for scene in ["paper", "paper-friction"] {
            let ran = Command::new(&program).arg(scene).output().expect("runs");
            let words = String::from_utf8_lossy(&ran.stderr);
            assert!(ran.status.success(), "{compiler} {scene}: {words}");
            let given: Vec<f64> = String::from_utf8_lossy(&ran.stdout)
                .lines()
                .map(|line| line.parse().expect("a number"))
                .collect();
            assert_eq!(given, wanted(scene), "{compiler} {scene}");
        }
    }
}

/// The library exports exactly the functions of the header.
#[test]
fn the_header_names_what_the_library_has() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let header = std::fs::read_to_string(folder.join("include/pinwheel_law.h")).expect("header");
    let ffi = std::fs::read_to_string(folder.join("src/ffi.rs")).expect("ffi");
    let names = |text: &str, before: &str| -> Vec<String> {
        let mut names: Vec<String> = text
            .lines()
            .filter(|line| !line.starts_with([' ', '/', '#']))
            .filter_map(|line| {
                let (head, _) = line.split_once('(')?;
                let name = head.rsplit([' ', '*']).next()?;
                (name.starts_with("pinwheel_law_") && head.contains(before))
                    .then(|| name.to_owned())
            })
            .collect();
        names.sort();
        names
    };
    let declared = names(&header, "");
    assert_eq!(declared.len(), 13);
    assert_eq!(declared, names(&ffi, "extern \"C\" fn"));
}
