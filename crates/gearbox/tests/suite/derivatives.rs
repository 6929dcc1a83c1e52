//! The gear's Jacobian in closed form against differences of its right-hand side, over gears, poses and laws.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::{ContactField, Kernel};
use pinwheel_gearbox::statics::Statics;
use pinwheel_mbs::{
    BodyState, Coordinates, Detail, Evaluation, Forces, Formulation, Jacobian, OdeSystem, Reduced,
    Structure, Wrench,
};
use pinwheel_scene::{Scene, Sleeve};
use proptest::prelude::*;

/// Contacts as the only forces.
struct Contacts(ContactField);

impl Forces for Contacts {
    fn apply(&mut self, _: f64, bodies: &[BodyState], loads: &mut [Wrench]) {
        self.0.add_loads(bodies, loads);
    }

    fn have_derivatives(&self) -> bool {
        self.0.have_derivatives()
    }

    fn evaluate(&mut self, _: f64, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        self.0.evaluate(bodies, request);
    }
}

fn reduced(gearbox: &Gearbox) -> Reduced<Contacts> {
    let layout = gearbox.layout;
    let sleeves: Vec<usize> = (layout.external_bodies().start..layout.bodies()).collect();
    let spinning = gearbox.spinning();
    let mut idle = sleeves.clone();
    idle.retain(|sleeve| !spinning.contains(sleeve));
    let forces = Contacts(gearbox.contact_field().unwrap());
    let system = Reduced::new(gearbox.mechanism(), forces, &idle).unwrap();
    system.with_leaves(&sleeves)
}

/// Returns the reduced system with contacts evaluated pair by pair.
fn one_by_one(gearbox: &Gearbox) -> Reduced<Contacts> {
    let mut gearbox = gearbox.clone();
    gearbox.kernel = Kernel::Scalar;
    reduced(&gearbox)
}

/// Returns angles near the ideal mesh at time `t` with a twist, and rates near it; floating discs are near their eccentrics.
fn state(gearbox: &Gearbox, t: f64, twist: f64, noise: &[f64], free: &[usize]) -> Vec<f64> {
    let (layout, geometry) = (gearbox.layout, &gearbox.geometry);
    let omega = gearbox.input_motion().rate;
    let input = omega * t;
    let random = |k: usize| noise[k % noise.len()];
    let n = free.len()
        + if gearbox.floats() {
            2 * layout.wheels
        } else {
            0
        };
    let mut y = vec![0.0; 2 * n];
    for (k, &body) in free.iter().enumerate() {
        let wheels = layout.wheel_bodies();
        let (ideal, rate) = if body == 1 {
            (geometry.ideal_output_angle(input), -3.5)
        } else if wheels.contains(&body) {
            (geometry.ideal_wheel_angle(body - wheels.start, input), -3.5)
        } else {
            (0.0, 0.0)
        };
        y[k] = ideal + twist * random(body);
        y[n + k] = rate + random(body + 3);
    }
    for (wheel, at) in (free.len()..n).step_by(2).enumerate() {
        let (s, c) = (input + geometry.wheel_phases[wheel]).sin_cos();
        let e = geometry.eccentricities_m[wheel];
        y[at] = e * c + 2e-5 * random(at);
        y[at + 1] = e * s + 2e-5 * random(at + 1);
        y[n + at] = -omega * e * s + 0.02 * random(at + 2);
        y[n + at + 1] = omega * e * c + 0.02 * random(at + 3);
    }
    y
}

/// Returns a state moved along component `k`, or along time beyond the last.
fn moved(y: &[f64], t: f64, k: usize, by: f64) -> (Vec<f64>, f64) {
    let (mut moved, mut time) = (y.to_vec(), t);
    match moved.get_mut(k) {
        Some(x) => *x += by,
        None => time += by,
    }
    (moved, time)
}

/// Returns the difference quotient of f along component `k` (or time, beyond the last), of order 4, and the excess of the
/// forward slope over the backward one.
fn quotient(
    system: &mut Reduced<Contacts>,
    t: f64,
    y: &[f64],
    k: usize,
    h: f64,
) -> (Vec<f64>, Vec<f64>) {
    let (mut slope, mut bend) = (vec![0.0; y.len()], vec![0.0; y.len()]);
    let mut f = slope.clone();
    for (at, weight, second) in [
        (-2.0, 1.0, 1.0),
        (-1.0, -8.0, 0.0),
        (0.0, 0.0, -2.0),
        (1.0, 8.0, 0.0),
        (2.0, -1.0, 1.0),
    ] {
        let (moved, time) = moved(y, t, k, at * h);
        system.derivative(time, &moved, &mut f);
        for (i, f) in f.iter().enumerate() {
            slope[i] += weight * f / (12.0 * h);
            bend[i] += second * f / (2.0 * h);
        }
    }
    (slope, bend)
}

/// Returns a gear with these numbers of ring pins, output pins and discs, and this shortening.
fn gear((zk, m, zi, wheels): (usize, f64, usize, usize), backlash: f64) -> Scene {
    let mut scene = Scene::paper();
    scene.gear.external_sleeves = zk;
    scene.gear.shortening = m;
    scene.gear.internal_sleeves = zi;
    scene.gear.internal_circle_radius_m = 0.55 * 0.0028 * zk as f64 / m;
    scene.gear.wheels = wheels;
    scene.gear.backlash_m = backlash;
    scene.gear.external_sleeve_radius_m = 0.004;
    scene
}

/// Adds some tens of micrometres of every modification and error.
fn deviate(scene: &mut Scene, noise: &[f64]) {
    let gear = &mut scene.gear;
    let size = |k: usize| 2e-5 * noise[k % noise.len()];
    gear.modification.equidistant_m = size(0);
    gear.modification.radial_m = size(1);
    gear.modification.rotational_rad = (0.01 * size(2)).max(0.0) / gear.eccentricity_m;
    let list = |count: usize, from: usize| (0..count).map(|k| size(k + from)).collect();
    let (external, internal, wheels) = (gear.external_sleeves, gear.internal_sleeves, gear.wheels);
    gear.errors.external_sleeve_radial_m = list(external, 3);
    gear.errors.external_sleeve_tangential_m = list(external, 4);
    gear.errors.external_sleeve_radius_m = list(external, 5);
    gear.errors.internal_sleeve_tangential_m = list(internal, 6);
    gear.errors.hole_radial_m = list(internal * wheels, 7);
    gear.errors.hole_radius_m = list(internal * wheels, 8);
    gear.errors.eccentricity_m = list(wheels, 9);
    gear.errors.phase_rad = list(wheels, 10);
}

/// Rigid; linear; rollers; with clearance and friction.
const BEARINGS: [Option<&str>; 4] = [
    None,
    Some("stiffness_n_m = 3e8"),
    Some("rollers = 16\nroller_length_m = 0.009"),
    Some(
        "stiffness_n_m = 2e8\nclearance_m = 1e-6\ndamping_n_s_m = 300\nbore_m = 0.02\nfriction_coefficient = 0.01",
    ),
];

const LAWS: [&str; 10] = [
    "paper",
    "paper-conservative",
    "paper-printed",
    "constant",
    "adams-impact",
    "line-contact",
    "line-hertz",
    "linear",
    "hunt-crossley",
    "flores",
];

/// Returns the touching pairs in a state.
fn touching(
    gearbox: &Gearbox,
    system: &mut Reduced<Contacts>,
    t: f64,
    y: &[f64],
) -> Vec<(usize, usize, bool)> {
    let bodies = system.observe(t, y, Detail::Everything).bodies.to_vec();
    let mut pairs = Vec::new();
    let mut field = gearbox.contact_field().unwrap();
    field.touching(&bodies, &mut |pair| {
        pairs.push(match pair.sleeve {
            Sleeve::External(j) => (pair.wheel, j, true),
            Sleeve::Internal(k) => (pair.wheel, k, false),
        });
    });
    pairs
}

/// Compares all entries of the Jacobian with differences; returns the number of entries, and of entries at a kink.
///
/// A kink (a contact begins, slides or parts) is detected by disagreement of two steps, or of both sides. Steps agree by
/// accident if both include half of a near kink; the contacts on both sides then differ, or, where a ramp of the damping ends, the excess
/// of the forward slope does not halve with the step.
fn compare(
    gearbox: &Gearbox,
    system: &mut Reduced<Contacts>,
    t: f64,
    y: &[f64],
    angles: usize,
) -> Result<(usize, usize), String> {
    let n = y.len() / 2;
    // Positions have the scale of angles that move the rim as far.
    let size = |k: usize| match k % n < angles {
        true => 1.0,
        false => 1.0 / gearbox.scene.gear.pitch_radius_m(),
    };
    let weight = |row: usize, k: usize| size(row) / if k < 2 * n { size(k) } else { 1.0 };
    let mut jacobian = Jacobian::new(&system.structure(), 2 * n);
    assert!(system.jacobian(t, y, &mut jacobian));
    let (mut compared, mut kinks) = (0, 0);
    // The dependence on rates has kinks only, whose two sides may differ by as little as the bound below.
    for (columns, h, bent) in [
        (0..n, 2e-8, 1e-2),
        (n..2 * n, 1e-5, 2e-5),
        (2 * n..2 * n + 1, 1e-7, 1e-2),
    ] {
        let quotients: Vec<_> = columns
            .clone()
            .map(|k| {
                (
                    quotient(system, t, y, k, h),
                    quotient(system, t, y, k, 0.5 * h),
                )
            })
            .collect();
        let sizes = columns.clone().zip(&quotients);
        let sizes = sizes
            .flat_map(|(k, (_, (fine, _)))| (0..n).map(move |row| fine[n + row] * weight(row, k)));
        // For a loaded gear: 1e5 and more.
        let largest = sizes.fold(1.0, |m: f64, x| m.max(x.abs()));
        for (k, ((coarse, bend), (fine, fine_bend))) in columns.zip(&quotients) {
            for row in 0..n {
                let largest = largest / weight(row, k);
                let exact = match k {
                    k if k < n => jacobian.position.as_ref().unwrap().entry(row, k),
                    k if k < 2 * n => jacobian.rate.entry(row, k - n),
                    _ => jacobian.time[row],
                };
                let (a, b) = (coarse[n + row], fine[n + row]);
                compared += 1;
                if (a - b).abs() > 2e-6 * largest || bend[n + row].abs() > bent * largest {
                    kinks += 1;
                    continue;
                }
                // Measured: at most 4e-6, rounding of positions and speeds.
                if (exact - b).abs() < 2e-5 * largest {
                    continue;
                }
                let [behind, ahead] = [-2.0, 2.0].map(|at| {
                    let (moved, time) = moved(y, t, k, at * h);
                    touching(gearbox, system, time, &moved)
                });
                let rest = fine_bend[n + row] - 0.5 * bend[n + row];
                if behind == ahead && rest.abs() < 1e-5 * largest {
                    return Err(format!(
                        "{} row {row} column {k} of {n}: {exact:e}, by differences {b:e} and {a:e}, largest {largest:e}",
                        gearbox.scene.contact.law
                    ));
                }
                kinks += 1;
            }
        }
    }
    Ok((compared, kinks))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, max_shrink_iters: 0, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_jacobian_is_the_slope(
        shape in (9_usize..121, 0.3..0.9_f64, 3_usize..9, 1_usize..5), friction: bool, law in 0..LAWS.len(),
        backlash in prop_oneof![Just(0.0), 0.0..3e-4], t in 0.0..0.5_f64, twist in 1e-3..6e-3_f64,
        noise in prop::array::uniform16(prop_oneof![-1.0..-0.1_f64, 0.1..1.0]), deviates: bool,
        pin in prop::option::of(4.0..9.0_f64), bearing in 0..BEARINGS.len(),
        cut in prop_oneof![Just(0.0), 1e-7..1e-4_f64], turn: [bool; 2],
    ) {
        let mut scene = gear(shape, backlash);
        scene.gear.modification.equidistant_m = cut;
        [scene.gear.external_sleeves_turn, scene.gear.internal_sleeves_turn] = turn;
        scene.bearings.eccentric = BEARINGS[bearing].map(|bearing| toml::from_str(bearing).unwrap());
        scene.bearings.internal_sleeve_stiffness_n_m = pin.map(|digits| 10f64.powf(digits));
        scene.contact.law = LAWS[law].to_owned();
        scene.contact.friction_coefficient = if friction { 0.1 } else { 0.0 };
        if deviates {
            deviate(&mut scene, &noise);
        }
        // Wide enough for differences.
        scene.contact.friction_ramp_m_s = 5e-3;
        let checked = scene.clone().check();
        prop_assume!(checked.is_ok()); // some holes have no room
        let gearbox = Gearbox::new(&checked.unwrap()).unwrap();
        let mut system = reduced(&gearbox);
        let free = system.free_bodies().to_vec();
        let y = state(&gearbox, t, twist, &noise, &free);
        let (lanes, scalar) = (entries(&mut system, t, &y), entries(&mut one_by_one(&gearbox), t, &y));
        // The scalar loop uses differences for some derivatives of the profile: measured 1.3e-7.
        let most = lanes.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        for (a, b) in lanes.iter().zip(scalar) {
            prop_assert!((a - b).abs() < 1e-5 * most, "{} lanes {a:e} scalar {b:e} of {most:e}", LAWS[law]);
        }
        let (compared, kinks) =
            compare(&gearbox, &mut system, t, &y, free.len()).map_err(TestCaseError::fail)?;
        // Poses with almost no contacts are skipped.
        prop_assume!(kinks * 4 <= compared);
    }
}

/// Cranks on rigid and elastic supports, in a rigid and an elastic mesh, with clearance, errors and friction.
#[test]
fn cranks_have_their_slopes() {
    let mesh = "cranks.mesh_stiffness_n_m=1e7";
    let soft = "cranks.support_stiffness_n_m=1e8";
    let drag = [
        "bearings.eccentric.clearance_m=2e-6",
        "bearings.eccentric.damping_n_s_m=3e3",
        "bearings.eccentric.friction_coefficient=0.002",
        "bearings.eccentric.bore_m=0.02",
    ];
    let three = ["cranks.count=3", "gear.wheels=3"];
    for sets in [
        &["gear.backlash_m=0"][..],
        &[soft, mesh],
        &[&[mesh][..], &drag].concat(),
        &[&[soft, mesh][..], &drag, &three].concat(),
        &[&[soft, "gear.errors.crank_phase_rad=[1e-4,0]"][..], &drag].concat(),
        &[
            mesh,
            "contact.friction_coefficient=0.05",
            "contact.friction_ramp_m_s=0.05",
        ],
    ] {
        have_slopes("rv-40e-like", sets);
    }
}

/// Output pins that two and three discs bend.
#[test]
fn shared_pins_have_their_slopes() {
    let shared = [
        "bearings.internal_sleeves_held=\"one-end\"",
        "structure.output_pin_diameter_m=0.006",
        "structure.output_seat_length_m=0.01",
    ];
    let three = ["gear.wheels=3", "contact.damping_n_s_m=1e3"];
    have_slopes("paper", &shared);
    have_slopes("paper-bearings", &[&shared[..], &three].concat());
}

/// Compares the Jacobian of a preset near its balance with differences, and lanes with the scalar loop.
fn have_slopes(preset: &str, sets: &[&str]) {
    let common = ["drive.start=\"equilibrium\""];
    let sets: Vec<_> = common
        .iter()
        .chain(sets)
        .map(|set| set.parse().unwrap())
        .collect();
    let gearbox = Gearbox::new(&Scene::load(preset, &sets).unwrap()).unwrap();
    let mut system = reduced(&gearbox);
    let mut y = system.initial();
    let n = y.len() / 2;
    for (k, y) in y.iter_mut().enumerate() {
        let size = if k < n { 2e-7 } else { 1e-2 };
        *y += size * (3.7 * k as f64 + 1.0).sin();
    }
    let (lanes, scalar) = (
        entries(&mut system, 0.0, &y),
        entries(&mut one_by_one(&gearbox), 0.0, &y),
    );
    let most = lanes.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    for (a, b) in lanes.iter().zip(scalar) {
        assert!(
            (a - b).abs() < 1e-5 * most,
            "{sets:?}: {a:e} {b:e} of {most:e}"
        );
    }
    let angles = system.free_bodies().len();
    let (compared, kinks) = compare(&gearbox, &mut system, 0.0, &y, angles).unwrap();
    assert!(kinks * 4 <= compared, "{sets:?}: {kinks} of {compared}");
}

/// A contact begins a twelfth of a step from the state: both steps include half of its slope, which is small so soon after the
/// beginning, and agree. One case in some thousand of those above.
#[test]
fn a_contact_that_just_begins_is_a_kink() {
    let mut scene = gear((30, 0.6, 5, 1), 0.0);
    scene.contact.law = "line-contact".to_owned();
    let gearbox = Gearbox::new(&scene.check().unwrap()).unwrap();
    let mut system = reduced(&gearbox);
    let free = system.free_bodies().to_vec();
    let (t, noise) = (0.013, [0.4, -0.7, 0.3]);
    let of = |twist: f64| state(&gearbox, t, twist, &noise, &free);
    let mut count = |twist: f64| touching(&gearbox, &mut system, t, &of(twist));
    let (mut low, mut high) = (1e-3, 6e-3);
    let before = count(low);
    assert_ne!(before, count(high));
    while high - low > 1e-12 {
        let middle = 0.5 * (low + high);
        if count(middle) == before {
            low = middle;
        } else {
            high = middle;
        }
    }
    for k in 0..40 {
        let y = of(high + 2.5e-10 * f64::from(k));
        let outcome = compare(&gearbox, &mut system, t, &y, free.len());
        assert!(outcome.is_ok(), "{k}: {outcome:?}");
    }
}

/// A ring pin leaves the damping's ramp within 2 nm of the state, and every contact touches on both sides, whose slopes differ by
/// 1.2e-4. One random case of those above.
#[test]
fn a_ramp_that_just_ends_is_a_kink() {
    #[rustfmt::skip]
    let noise = [
        0.7433912729391607, 0.2522101124542618, -0.12370145487864667, 0.4829255019558537, 0.1319273858333689, 0.5659744782432117,
        -0.7848869266550793, -0.485804942935671, 0.4539790811469563, -0.7594447821474799, -0.6703884334146684, -0.49012153976783596,
        0.2814876100678133, -0.4264159575276249, -0.8811450261257686, 0.6179856052260546,
    ];
    let mut scene = gear((38, 0.5850374924550588, 7, 4), 2.870785901879602e-5);
    [
        scene.gear.external_sleeves_turn,
        scene.gear.internal_sleeves_turn,
    ] = [false, false];
    scene.bearings.eccentric = BEARINGS[2].map(|bearing| toml::from_str(bearing).unwrap());
    scene.bearings.internal_sleeve_stiffness_n_m = Some(10f64.powf(6.878903382486203));
    scene.contact.friction_coefficient = 0.0;
    deviate(&mut scene, &noise);
    let gearbox = Gearbox::new(&scene.check().unwrap()).unwrap();
    let mut system = reduced(&gearbox);
    let free = system.free_bodies().to_vec();
    let t = 0.015910303351649682;
    let y = state(&gearbox, t, 0.0025971929207761636, &noise, &free);
    let (compared, kinks) = compare(&gearbox, &mut system, t, &y, free.len()).unwrap();
    assert!(kinks > 0 && kinks * 4 <= compared, "{kinks} of {compared}");
}

/// Returns the entries of a Jacobian: a column for each angle, each rate and the time.
fn entries(system: &mut Reduced<Contacts>, t: f64, y: &[f64]) -> Vec<f64> {
    let n = y.len() / 2;
    let mut jacobian = Jacobian::new(&system.structure(), 2 * n);
    assert!(system.jacobian(t, y, &mut jacobian));
    let column = |k: usize| {
        let jacobian = &jacobian;
        (0..n).map(move |row| match k {
            k if k < n => jacobian.position.as_ref().unwrap().entry(row, k),
            k if k < 2 * n => jacobian.rate.entry(row, k - n),
            _ => jacobian.time[row],
        })
    };
    (0..=2 * n).flat_map(column).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// The force along the profile contributes a hundredth of the normal forces' derivatives, checked separately.
    #[test]
    fn the_force_along_the_profile_has_its_slopes(
        shape in (9_usize..121, 0.3..0.9_f64, 3_usize..9, 1_usize..5), friction: bool,
        backlash in prop_oneof![Just(0.0), 0.0..3e-4], t in 0.0..0.5_f64, twist in 1e-3..6e-3_f64,
        noise in prop::array::uniform16(prop_oneof![-1.0..-0.1_f64, 0.1..1.0]), deviates: bool,
        cut in prop_oneof![Just(0.0), 1e-7..1e-4_f64],
    ) {
        let mut scene = gear(shape, backlash);
        scene.gear.modification.equidistant_m = cut;
        scene.contact.friction_coefficient = if friction { 0.1 } else { 0.0 };
        if deviates {
            deviate(&mut scene, &noise);
        }
        prop_assume!(scene.clone().check().is_ok()); // some holes have no room
        let mut systems = ["paper-conservative", "paper"].map(|law| {
            scene.contact.law = law.to_owned();
            reduced(&Gearbox::new(&scene.clone().check().unwrap()).unwrap())
        });
        let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
        let free = systems[0].free_bodies().to_vec();
        let n = free.len();
        let y = state(&gearbox, t, twist, &noise, &free);
        let [total, normal] = [0, 1].map(|k| entries(&mut systems[k], t, &y));
        let exact: Vec<f64> = total.iter().zip(&normal).map(|(a, b)| a - b).collect();
        let (largest, all) = [&exact, &total].map(|v| v.iter().fold(0.0, |m: f64, x| m.max(x.abs()))).into();
        prop_assume!(largest > 0.0);
        for (columns, h) in [(0..n, 1e-6), (2 * n..2 * n + 1, 2e-8)] {
            for k in columns {
                let [(total, _), (normal, _)] = [0, 1].map(|s| quotient(&mut systems[s], t, &y, k, h));
                for row in 0..n {
                    let (exact, actual) = (exact[k * n + row], total[n + row] - normal[n + row]);
                    let off = (exact - actual).abs();
                    prop_assert!(off < 1e-2 * largest + 1e-9 * all, "row {row} column {k} of {n}: {exact:e} {actual:e}, largest {largest:e}");
                }
            }
        }
    }
}

/// Fields without derivatives report it: friction that falls with speed, points.
#[test]
fn derivatives_are_only_given_where_they_are_known() {
    let known = |change: &dyn Fn(&mut Scene), kernel: Kernel| {
        let mut scene = Scene::paper();
        change(&mut scene);
        let mut gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
        gearbox.kernel = kernel;
        let mut system = reduced(&gearbox);
        let free = system.free_bodies().to_vec();
        let y = state(&gearbox, 0.0, 0.0, &[0.0], &free);
        let mut jacobian = Jacobian::new(&system.structure(), y.len());
        system.jacobian(0.0, &y, &mut jacobian)
    };
    assert!(known(&|_| {}, Kernel::Lanes));
    assert!(known(&|_| {}, Kernel::Portable));
    assert!(known(
        &|s| s.contact.friction_coefficient = 0.1,
        Kernel::Avx2
    ));
    assert!(known(&|_| {}, Kernel::Scalar));
    assert!(known(
        &|s| s.contact.friction_coefficient = 0.1,
        Kernel::Scalar
    ));
    let falling = |s: &mut Scene| {
        s.contact.friction_coefficient = 0.1;
        s.contact.friction_law = pinwheel_scene::FrictionLaw::Adams;
    };
    assert!(!known(&falling, Kernel::Lanes));
    let points = |s: &mut Scene| s.contact.detection = pinwheel_scene::Detection::Points;
    assert!(!known(&points, Kernel::Lanes));
}

/// Loads and derivatives in one pass equal those of two, to the bit: in lanes and pair by pair, with play, errors and other
/// laws.
#[test]
fn one_pass_gives_what_two_give() {
    for (preset, kernel) in [
        ("paper", Kernel::Lanes),
        ("paper", Kernel::Scalar),
        ("modified", Kernel::Scalar),
        ("toleranced", Kernel::Lanes),
    ] {
        let mut gearbox = Gearbox::new(&Scene::load(preset, &[]).unwrap()).unwrap();
        gearbox.kernel = kernel;
        let mut field = gearbox.frictionless_field().unwrap();
        let mut statics = Statics::new(&gearbox).unwrap();
        let turning: Vec<usize> = (1..2 + gearbox.layout.wheels).collect();
        let coordinates = Coordinates::new(gearbox.layout.bodies(), &turning, &[]);
        let free = turning.len();
        let structure = Structure::SecondOrder {
            is_leaf: vec![false; free],
        };
        for phi in [0.0, 0.4, 1.7] {
            let bodies = statics.solve(phi, 15.0).unwrap().bodies;
            let new = || Jacobian::new(&structure, 2 * free);
            let (mut loads, mut derivatives) = (vec![Wrench::default(); bodies.len()], new());
            field.add_loads(&bodies, &mut loads);
            let mut request = Evaluation::of_derivatives(&mut derivatives, &coordinates);
            field.evaluate(&bodies, &mut request);
            let (mut both, mut of_both) = (vec![Wrench::default(); bodies.len()], new());
            let mut request = Evaluation {
                loads: Some(&mut both),
                ..Evaluation::of_derivatives(&mut of_both, &coordinates)
            };
            field.evaluate(&bodies, &mut request);
            assert!(loads.iter().any(|load| load.fx != 0.0));
            assert_eq!(loads, both, "{preset} {kernel:?}");
            let [position, of_both] =
                [&derivatives, &of_both].map(|all| all.position.as_ref().unwrap());
            for (row, column) in
                (0..free).flat_map(|row| (0..free).map(move |column| (row, column)))
            {
                if row == column || row == 0 || column == 0 {
                    let entries = (position.entry(row, column), of_both.entry(row, column));
                    assert_eq!(entries.0, entries.1, "{preset} {kernel:?} {row} {column}");
                }
            }
        }
    }
}
