//! Functions of the header, called as from C.
#![allow(unsafe_code, reason = "this is what a caller in C does")]

use std::ffi::{CStr, CString};
use std::ptr;

use pinwheel_gearbox::Gearbox;
use pinwheel_law::ffi::*;
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::Scene;

fn error() -> String {
    // SAFETY: the text of this thread, copied before any other call.
    unsafe { CStr::from_ptr(pinwheel_law_error()) }
        .to_string_lossy()
        .into_owned()
}

fn open(scene: &str) -> Result<*mut PinwheelLaw, (i32, String)> {
    let text = CString::new(scene).expect("no zero byte");
    let mut law = ptr::null_mut();
    // SAFETY: a text and a place.
    match unsafe { pinwheel_law_open(text.as_ptr(), &raw mut law) } {
        0 => Ok(law),
        status => {
            assert!(law.is_null());
            Err((status, error()))
        }
    }
}

fn start(law: *mut PinwheelLaw) -> Vec<f64> {
    let mut states = vec![f64::NAN; 6 * pinwheel_law_bodies(law) as usize];
    // SAFETY: six numbers for each body.
    assert_eq!(unsafe { pinwheel_law_start(law, states.as_mut_ptr()) }, 0);
    states
}

fn loads(law: *mut PinwheelLaw, states: &[f64]) -> (i32, Vec<f64>) {
    let mut loads = vec![7.0; states.len() / 2];
    // SAFETY: six and three numbers for each body.
    let status = unsafe { pinwheel_law_loads(law, states.as_ptr(), loads.as_mut_ptr()) };
    (status, loads)
}

/// Presets without and with friction, with points, another law, more bodies and floating discs.
#[test]
fn crossval_forces_are_the_native_ones_to_the_bit() {
    for (scene, sets) in [
        ("paper", &[][..]),
        ("paper-friction", &[]),
        ("forty-pins", &[]),
        ("paper", &["contact.detection=points"]),
        ("paper", &["contact.law=paper-conservative"]),
        ("paper-bearings", &["contact.friction_coefficient=0.05"]),
        ("needle-bearings", &[]),
    ] {
        let sets: Vec<_> = sets
            .iter()
            .map(|s: &&str| s.parse().expect("one"))
            .collect();
        let checked = Scene::load(scene, &sets).expect(scene);
        let gearbox = Gearbox::new(&checked).expect(scene);
        let law = open(&checked.to_toml()).expect(scene);
        let mut states = start(law);
        let body = |k: usize, states: &[f64]| -> BodyState {
            let s = &states[6 * k..][..6];
            BodyState {
                x: s[0],
                y: s[1],
                angle: s[2],
                vx: s[3],
                vy: s[4],
                rate: s[5],
            }
        };
        let bodies: Vec<BodyState> = (0..states.len() / 6).map(|k| body(k, &states)).collect();
        assert_eq!(bodies, gearbox.initial_states(), "{scene}");
        // Pressed together, sliding and rotating.
        for (k, x) in states.iter_mut().enumerate() {
            *x += [3e-6, -2e-6, 1e-3, 0.01, 0.02, -0.7][k % 6] * (1.0 + 0.1 * (k as f64).sin());
        }
        let bodies: Vec<BodyState> = (0..bodies.len()).map(|k| body(k, &states)).collect();
        let mut wanted = vec![Wrench::default(); bodies.len()];
        gearbox
            .contact_field()
            .expect(scene)
            .add_loads(&bodies, &mut wanted);
        let wanted: Vec<f64> = wanted.iter().flat_map(|w| [w.fx, w.fy, w.moment]).collect();
        let (status, given) = loads(law, &states);
        assert_eq!((status, &given), (0, &wanted), "{scene}");
        assert!(
            given.iter().filter(|x| x.abs() > 1.0).count() > 10,
            "{scene}: no contacts"
        );
        assert_eq!(loads(law, &states).1, given, "history");
        assert_eq!(pinwheel_law_calls(law), 2);
        pinwheel_law_close(law);
    }
}

#[test]
fn a_scene_as_its_caller_sees_it() {
    let law = open("paper").expect("preset");
    assert_eq!(pinwheel_law_bodies(law), 28);
    assert_eq!(
        (pinwheel_law_rate(law), pinwheel_law_step(law)),
        (52.34, 1e-5)
    );
    assert_eq!(pinwheel_law_load_torque(law, 0.3), 22.0);
    // SAFETY: no room, then room for three.
    unsafe {
        assert_eq!(pinwheel_law_samples(law, ptr::null_mut(), 0), 6001);
        let mut times = [9.0; 4];
        assert_eq!(pinwheel_law_samples(law, times.as_mut_ptr(), 3), 6001);
        assert_eq!(times, [0.0, 1e-4, 2e-4, 9.0]);
    }
    // Every centre is at its carrier's seat, and moves with it.
    let states = start(law);
    for k in 0..28 {
        let (mut carrier, mut seat, mut mass, mut moment) = (7, [0.0; 2], 0.0, 0.0);
        // SAFETY: places of their lengths.
        let status = unsafe {
            pinwheel_law_body(
                law,
                k,
                &raw mut carrier,
                seat.as_mut_ptr(),
                &raw mut mass,
                &raw mut moment,
            )
        };
        assert_eq!(status, 0);
        assert!(mass > 0.0 && moment > 0.0);
        let expected = match k {
            0 | 1 | 4..20 => -1,
            2 | 3 => 0,
            _ => 1,
        };
        assert_eq!(carrier, expected, "body {k}");
        let on = usize::try_from(carrier)
            .map_or([0.0; 6], |c| std::array::from_fn(|i| states[6 * c + i]));
        let (s, c) = on[2].sin_cos();
        let (x, y) = (c * seat[0] - s * seat[1], s * seat[0] + c * seat[1]);
        let own = &states[6 * k as usize..][..6];
        for (is, should) in [
            (own[0], on[0] + x),
            (own[1], on[1] + y),
            (own[3], on[3] - on[5] * y),
            (own[4], on[4] + on[5] * x),
        ] {
            assert!((is - should).abs() < 1e-15, "body {k}: {is} {should}");
        }
        // SAFETY: all outputs are null.
        let nothing = [ptr::null_mut(); 3];
        assert_eq!(
            unsafe {
                pinwheel_law_body(law, k, ptr::null_mut(), nothing[0], nothing[1], nothing[2])
            },
            0
        );
    }
    pinwheel_law_close(law);
}

#[test]
fn scenes_come_as_folder_file_text_or_json() {
    let folder = tempfile::tempdir().expect("folder");
    let sets = ["gear.wheels=3".parse().expect("one")];
    let scene = Scene::load("paper", &sets).expect("paper");
    let toml = folder.path().join("three = wheels.toml");
    std::fs::write(&toml, scene.to_toml()).expect("written");
    let json = serde_json::json!({ "protocol": 1, "scene": &scene, "bodies": [] }).to_string();
    std::fs::write(folder.path().join("scene.json"), &json).expect("written");
    let named = folder.path().display().to_string();
    let mut starts = Vec::new();
    for spec in [
        toml.display().to_string(),
        format!("{named}/scene.json"),
        named.clone(),
        scene.to_toml(),
        json.clone(),
        "base = \"paper\"\ngear.wheels = 3".to_owned(),
    ] {
        let law = open(&spec).expect(&spec);
        assert_eq!(pinwheel_law_bodies(law), 29, "{spec}");
        let states = start(law);
        let _ = loads(law, &states);
        starts.push(states);
        pinwheel_law_close(law);
    }
    assert!(starts.iter().all(|start| *start == starts[0]));
    // The job folder records the number of force evaluations.
    let calls = std::fs::read_to_string(folder.path().join("law_calls.txt"));
    assert_eq!(calls.expect("written on closing"), "1\n");

    let newer = json.replace("\"protocol\":1", "\"protocol\":2");
    for (spec, words) in [
        ("papre", "did you mean the preset `paper`?"),
        ("/nowhere/at/all", "there is no preset and no file"),
        ("gear.wheels = 2", "write them, or begin with `base"),
        (
            "base = \"paper\"\ngear.wheels = -2",
            "line 2: `gear.wheels`",
        ),
        (newer.as_str(), "protocol 2 is unknown"),
        ("{\"protocol\": 1}", "the job holds no `scene`"),
        ("{\"gear\": ", "not valid JSON"),
        ("", "there is no preset and no file"),
    ] {
        let (status, message) = open(spec).expect_err(spec);
        assert!(
            status == SCENE && message.contains(words),
            "{spec}: {status} {message}"
        );
        assert!(!message.contains('\n'), "{message}");
    }
}

#[test]
fn bad_input_is_refused_and_leaves_nan() {
    let law = open("paper").expect("preset");
    let states = start(law);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut states = states.clone();
        states[6 * 2 + 2] = bad;
        let (status, loads) = loads(law, &states);
        assert_eq!(status, NOT_FINITE);
        assert!(loads.iter().all(|x| x.is_nan()));
        assert!(error().contains("body 2"), "{}", error());
    }
    let far: Vec<f64> = states.iter().map(|x| 1e300 * (x + 1.0)).collect();
    let (status, far) = loads(law, &far);
    assert!(status == 0 || far.iter().all(|x| x.is_nan()), "{status}");
    assert!(pinwheel_law_load_torque(law, f64::NAN).is_nan());
    // SAFETY: null is allowed.
    unsafe {
        let mut place = [1.0; 84];
        assert_eq!(
            pinwheel_law_loads(law, ptr::null(), place.as_mut_ptr()),
            ARGUMENT
        );
        assert!(place.iter().all(|x| x.is_nan()));
        assert_eq!(
            pinwheel_law_loads(law, states.as_ptr(), ptr::null_mut()),
            ARGUMENT
        );
        assert_eq!(pinwheel_law_start(law, ptr::null_mut()), ARGUMENT);
        assert_eq!(
            pinwheel_law_samples(law, ptr::null_mut(), 5),
            i64::from(ARGUMENT)
        );
        assert_eq!(
            pinwheel_law_samples(law, place.as_mut_ptr(), -1),
            i64::from(ARGUMENT)
        );
        assert_eq!(
            pinwheel_law_open(c"paper".as_ptr(), ptr::null_mut()),
            ARGUMENT
        );
        let mut out = law;
        assert_eq!(pinwheel_law_open(ptr::null(), &raw mut out), ARGUMENT);
        assert!(out.is_null());
        assert_eq!(pinwheel_law_open(c"\xff".as_ptr(), &raw mut out), ARGUMENT);
        let mut mass = 1.0;
        for body in [-1, 28, i32::MAX] {
            let none = ptr::null_mut();
            let status = pinwheel_law_body(law, body, ptr::null_mut(), none, &raw mut mass, none);
            assert!(status == ARGUMENT && mass.is_nan(), "{body}");
        }
    }
}

#[test]
fn handles_that_are_none_are_refused() {
    let law = open("paper").expect("preset");
    let other = open("paper").expect("preset");
    assert_ne!(law, other);
    let states = start(law);
    pinwheel_law_close(law);
    pinwheel_law_close(law);
    pinwheel_law_close(ptr::null_mut());
    for none in [
        law,
        ptr::null_mut(),
        ptr::without_provenance_mut(usize::MAX),
    ] {
        assert_eq!(pinwheel_law_bodies(none), ARGUMENT);
        assert!(error().contains("handle"), "{}", error());
        assert!(pinwheel_law_rate(none).is_nan() && pinwheel_law_step(none).is_nan());
        assert!(pinwheel_law_load_torque(none, 0.0).is_nan());
        assert_eq!(pinwheel_law_calls(none), 0);
        assert_eq!(loads(none, &states).0, ARGUMENT);
    }
    assert_eq!(loads(other, &states).0, 0);
    pinwheel_law_close(other);
}

#[test]
fn hard_a_panic_stays_inside_and_the_handle_lives() {
    let law = open("paper").expect("preset");
    let states = start(law);
    let before = loads(law, &states);
    assert_eq!(on(law, |status| status, |_| panic!("on purpose")), FAULT);
    assert!(error().contains("fault in libpinwheel_law"), "{}", error());
    assert_eq!(loads(law, &states), before);
    pinwheel_law_close(law);
}

/// One handle for each thread, then one for all.
#[test]
fn hard_threads_get_the_same_bits_and_their_own_errors() {
    let shared = open("paper").expect("preset").addr();
    let wanted = {
        let law = ptr::without_provenance_mut(shared);
        loads(law, &start(law))
    };
    std::thread::scope(|scope| {
        for k in 0..4 {
            let wanted = &wanted;
            scope.spawn(move || {
                let own = open("paper").expect("preset");
                let shared = ptr::without_provenance_mut(shared);
                let states = start(own);
                for _ in 0..200 {
                    assert_eq!(loads(own, &states), *wanted);
                    assert_eq!(loads(shared, &states), *wanted);
                    assert!(open(&format!("no-such-{k}")).is_err());
                    assert!(error().contains(&format!("no-such-{k}")));
                }
                pinwheel_law_close(own);
            });
        }
    });
    let shared = ptr::without_provenance_mut(shared);
    assert_eq!(pinwheel_law_calls(shared), 801);
    pinwheel_law_close(shared);
}
