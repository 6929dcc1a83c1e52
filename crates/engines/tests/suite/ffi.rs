//! Stale, foreign and alternating callers of the C interface, without a Python.

use pinwheel_gearbox::Gearbox;
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::{Override, Scene};

use pinwheel_engines::python::ffi::{law, passive};
use pinwheel_engines::python::law::locked;
use pinwheel_engines::python::mujoco::{self, ATTACHED, Addresses, Attached, Place, detach};
use pinwheel_engines::python::published::Published;

fn gearbox(preset: &str) -> Gearbox {
    let settings = [Override::new("contact.friction_coefficient", "0.1")];
    Gearbox::new(&Scene::load(preset, &settings).unwrap()).unwrap()
}

fn publish(gearbox: &Gearbox) -> Published {
    Published::new(gearbox).unwrap()
}

/// Returns loaded states: output and discs slightly rotated from the ideal mesh.
fn states(gearbox: &Gearbox) -> Vec<f64> {
    let mut bodies = gearbox.kinematic_states();
    for body in gearbox.layout.wheel_bodies() {
        bodies[body].angle += 5e-4;
    }
    bodies
        .iter()
        .flat_map(|b| [b.x, b.y, b.angle, b.vx, b.vy, b.rate])
        .collect()
}

fn directly(gearbox: &Gearbox, states: &[f64]) -> Vec<f64> {
    let bodies: Vec<BodyState> = states
        .as_chunks::<6>()
        .0
        .iter()
        .map(|&[x, y, angle, vx, vy, rate]| BodyState {
            x,
            y,
            angle,
            vx,
            vy,
            rate,
        })
        .collect();
    let mut loads = vec![Wrench::default(); bodies.len()];
    gearbox
        .contact_field()
        .unwrap()
        .add_loads(&bodies, &mut loads);
    loads.iter().flat_map(|l| [l.fx, l.fy, l.moment]).collect()
}

/// Calls the law as an engine does. `bodies` must be those of the law behind `number`.
fn call(number: usize, states: &[f64], bodies: usize) -> Vec<f64> {
    assert_eq!(states.len(), 6 * bodies);
    let mut loads = vec![7.0; 3 * bodies];
    let context = std::ptr::without_provenance_mut(number);
    // SAFETY: both arrays have the lengths of the law's scene.
    unsafe { law(context, 0.0, states.as_ptr(), loads.as_mut_ptr()) };
    loads
}

#[test]
fn the_law_crosses_unchanged() {
    let gearbox = gearbox("paper");
    let (published, states) = (publish(&gearbox), states(&gearbox));
    let loads = call(published.number, &states, published.law.bodies);
    assert_eq!(loads, directly(&gearbox, &states));
    assert!(loads.iter().any(|load| load.abs() > 1.0));
}

#[test]
fn a_dropped_law_answers_nan_and_its_number_is_not_used_again() {
    let gearbox = gearbox("paper");
    let (published, states) = (publish(&gearbox), states(&gearbox));
    let (number, bodies) = (published.number, published.law.bodies);
    drop(published);
    assert!(
        call(number, &states, bodies)
            .iter()
            .all(|load| load.is_nan())
    );
    let again = publish(&gearbox);
    assert_ne!(again.number, number);
    assert!(
        call(number, &states, bodies)
            .iter()
            .all(|load| load.is_nan())
    );
    assert_eq!(
        call(again.number, &states, bodies),
        directly(&gearbox, &states)
    );
    // A number that was never issued has no length: no data may be accessed.
    assert!(
        call(usize::MAX, &states, bodies)
            .iter()
            .all(|&load| load == 7.0)
    );
}

#[test]
fn laws_alternate() {
    let (small, large) = (gearbox("eleven-pins"), gearbox("forty-pins"));
    let (law_of_small, law_of_large) = (publish(&small), publish(&large));
    for _ in 0..3 {
        for (gearbox, published) in [(&small, &law_of_small), (&large, &law_of_large)] {
            let states = states(gearbox);
            assert_eq!(
                call(published.number, &states, published.law.bodies),
                directly(gearbox, &states)
            );
        }
    }
}

/// Arrays in place of MuJoCo's.
struct Machine {
    q: Vec<f64>,
    v: Vec<f64>,
    torques: Vec<f64>,
    counters: [i64; 2],
}

impl Machine {
    fn new(coordinates: usize) -> Self {
        let at = |k: usize, size: f64| size * (k as f64 * 1.7).sin();
        Self {
            q: (0..coordinates).map(|k| at(k, 1e-3)).collect(),
            v: (0..coordinates).map(|k| at(k + 1, 2.0)).collect(),
            torques: vec![0.25; coordinates],
            counters: [0; 2],
        }
    }

    fn addresses(&mut self, data: usize) -> Addresses {
        Addresses {
            data,
            qpos: self.q.as_mut_ptr().expose_provenance(),
            qvel: self.v.as_mut_ptr().expose_provenance(),
            qfrc_passive: self.torques.as_mut_ptr().expose_provenance(),
            counters: self.counters.as_mut_ptr().expose_provenance(),
            coordinates: self.q.len(),
        }
    }
}

/// Returns the mechanism as hinges, with coordinates in reverse order of the bodies.
fn places(gearbox: &Gearbox) -> Vec<Place> {
    let (layout, bodies) = (gearbox.layout, gearbox.kinematic_states());
    (0..layout.bodies())
        .map(|body| Place {
            coordinate: layout.bodies() - 1 - body,
            carrier: if layout.wheel_bodies().contains(&body) {
                Some(0)
            } else if layout.internal_bodies().contains(&body) {
                Some(1)
            } else {
                None
            },
            offset: [bodies[body].x, bodies[body].y],
        })
        .collect()
}

fn step(data: usize) {
    // SAFETY: data attached under `data` belong to the calling test and are alive.
    unsafe { passive(std::ptr::null(), std::ptr::without_provenance_mut(data)) };
}

/// Attaches data under an address of mjData that no other test uses.
fn attach(published: &Published, places: &[Place], machine: &mut Machine, data: usize) {
    let addresses = machine.addresses(data);
    let law = published.law.clone();
    let attached = Attached::new(published.number, addresses, places.to_vec(), law);
    mujoco::attach(attached);
}

#[test]
fn a_law_that_is_gone_detaches_and_equal_data_are_evicted() {
    let gearbox = gearbox("paper");
    let (first, second) = (publish(&gearbox), publish(&gearbox));
    let places = places(&gearbox);
    let mut machines = [places.len(); 2].map(Machine::new);
    attach(&first, &places, &mut machines[0], 0x6000);
    // Only the new owner of a reused address is called.
    attach(&second, &places, &mut machines[1], 0x6000);
    step(0x6000);
    assert_eq!((machines[0].counters[0], machines[1].counters[0]), (0, 1));
    drop(second);
    step(0x6000);
    assert_eq!((machines[0].counters[0], machines[1].counters[0]), (0, 1));
    assert!(
        locked(&ATTACHED)
            .iter()
            .all(|run| run.addresses.data != 0x6000)
    );
}

#[test]
fn null_and_crooked_addresses_are_refused() {
    let mut machine = Machine::new(2);
    let sound = machine.addresses(0x7000);
    assert!(sound.are_sound());
    for spoil in [
        |a: &mut Addresses| a.data = 0,
        |a: &mut Addresses| a.qpos = 0,
        |a: &mut Addresses| a.qvel += 1,
        |a: &mut Addresses| a.qfrc_passive = 0,
        |a: &mut Addresses| a.counters = 0,
    ] {
        let mut addresses = sound;
        spoil(&mut addresses);
        assert!(!addresses.are_sound(), "{addresses:?}");
    }
}

#[test]
fn torques_do_the_work_of_the_loads() {
    let gearbox = gearbox("paper");
    let published = publish(&gearbox);
    let places = places(&gearbox);
    let mut machine = Machine::new(places.len());
    // Near the mesh, for some contacts.
    for (place, state) in places.iter().zip(states(&gearbox).as_chunks::<6>().0) {
        machine.q[place.coordinate] = state[2];
    }
    attach(&published, &places, &mut machine, 0x1000);
    step(0x1000);
    let (states, loads) = {
        let attached = locked(&ATTACHED);
        let run = attached
            .iter()
            .find(|run| run.addresses.data == 0x1000)
            .unwrap();
        (run.states.clone(), run.loads.clone())
    };
    detach(published.number);
    let work: f64 = states
        .as_chunks::<6>()
        .0
        .iter()
        .zip(loads.as_chunks::<3>().0)
        .map(|(s, l)| s[3] * l[0] + s[4] * l[1] + s[5] * l[2])
        .sum();
    let size: f64 = loads.iter().map(|load| load.abs()).sum();
    assert!(size > 10.0, "nothing touches");
    let of_torques: f64 = machine
        .torques
        .iter()
        .zip(&machine.v)
        .map(|(torque, rate)| (torque - 0.25) * rate)
        .sum();
    assert!(
        (work - of_torques).abs() < 1e-12 * size,
        "{work} {of_torques}"
    );
    assert_eq!(machine.counters, [1, 1]);
}

#[test]
fn only_the_attached_data_is_touched_and_not_after_it_detached() {
    let gearbox = gearbox("paper");
    let published = publish(&gearbox);
    let places = places(&gearbox);
    let mut machine = Machine::new(places.len());
    attach(&published, &places, &mut machine, 0x2000);
    step(0x2001);
    assert!(machine.torques.iter().all(|&torque| torque == 0.25));
    assert_eq!(machine.counters, [0, 0]);
    step(0x2000);
    step(0x2000);
    assert_eq!(
        machine.counters,
        [2, 1],
        "the second call is at the same state"
    );
    machine.v[3] += 1e-3;
    step(0x2000);
    assert_eq!(machine.counters, [3, 2]);
    detach(published.number);
    machine.torques.fill(0.25);
    step(0x2000);
    assert!(machine.torques.iter().all(|&torque| torque == 0.25));
    assert_eq!(machine.counters, [3, 2]);
}

#[test]
fn two_runs_alternate_by_their_data() {
    let (small, large) = (gearbox("eleven-pins"), gearbox("forty-pins"));
    let (of_small, of_large) = (publish(&small), publish(&large));
    let mut machines = [
        Machine::new(small.layout.bodies()),
        Machine::new(large.layout.bodies()),
    ];
    attach(&of_small, &places(&small), &mut machines[0], 0x3000);
    attach(&of_large, &places(&large), &mut machines[1], 0x4000);
    for data in [0x3000, 0x4000, 0x3000, 0x4000, 0x4000] {
        step(data);
    }
    assert_eq!(machines[0].counters[0], 2);
    assert_eq!(machines[1].counters[0], 3);
    detach(of_small.number);
    step(0x3000);
    step(0x4000);
    assert_eq!(machines[0].counters[0], 2);
    assert_eq!(machines[1].counters[0], 4);
    detach(of_large.number);
}

#[test]
fn a_frozen_force_shows_in_the_count() {
    let gearbox = gearbox("paper");
    let _armed = pinwheel_faults::Armed::with(pinwheel_faults::Fault::FrozenLoads);
    let published = publish(&gearbox);
    let mut machine = Machine::new(gearbox.layout.bodies());
    attach(&published, &places(&gearbox), &mut machine, 0x5000);
    for _ in 0..8 {
        machine.v[0] += 1.0;
        step(0x5000);
    }
    assert_eq!(machine.counters, [2, 2]);
    detach(published.number);
}
