//! Statics compared with closed forms, an independent package and the quasi-static prototype.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::pressure::LinePressure;
use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::Sleeve;
use pinwheel_scene::{Scene, free_play};
use std::f64::consts::TAU;

use closed_forms::{LinearMesh, LinearOutput, smallest_convex_radius};

#[path = "common/closed_forms.rs"]
pub(crate) mod closed_forms;

pub(crate) fn table(name: &str) -> toml::Table {
    let path = format!(
        "{}/../../reference/published/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    text.parse().unwrap_or_else(|e| panic!("{path}: {e}"))
}

pub(crate) fn number(table: &toml::Table, key: &str) -> f64 {
    let value = table.get(key).unwrap_or_else(|| panic!("no key {key}"));
    value
        .as_float()
        .or_else(|| value.as_integer().map(|k| k as f64))
        .expect("a number")
}

pub(crate) fn numbers(table: &toml::Table, key: &str) -> Vec<f64> {
    let list = table
        .get(key)
        .and_then(toml::Value::as_array)
        .unwrap_or_else(|| panic!("no list {key}"));
    list.iter()
        .map(|v| {
            v.as_float()
                .or_else(|| v.as_integer().map(|k| k as f64))
                .expect("a number")
        })
        .collect()
}

pub(crate) fn close(actual: f64, wanted: f64, relative: f64, what: &str) {
    assert!(
        (actual / wanted - 1.0).abs() <= relative,
        "{what}: {actual} instead of {wanted}"
    );
}

pub(crate) fn range(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| {
            (l.min(x), h.max(x))
        })
}

/// The package `cycloidgen` computes the zero-clearance mesh independently; `crossval_cycloidgen` runs it.
#[test]
fn cycloidgen_agrees() {
    let data = table("cycloidgen");
    let tolerance = number(&data, "tolerance");
    let gears = data["gear"].as_array().unwrap();
    assert_eq!(gears.len(), 3);
    for recorded in gears {
        let recorded = recorded.as_table().unwrap();
        let name = recorded["scene"].as_str().unwrap();
        let scene = Scene::load(name, &[]).unwrap();
        let gear = &scene.gear;
        let torque = number(recorded, "wheel_torque_n_m");
        assert_eq!(
            torque,
            scene.drive.output_torque_n_m / gear.wheels as f64,
            "{name}"
        );
        let (mesh, output) = (LinearMesh::of(gear), LinearOutput::of(gear));
        let poses = 48_u32;
        let mut course: [Vec<f64>; 5] = Default::default();
        // A lever of 1e-17 m on the line of centres carries no load.
        let loaded = |forces: &[f64]| forces.iter().filter(|&&f| f > 1e-9).count() as f64;
        let largest = |forces: &[f64]| forces.iter().copied().fold(0.0, f64::max);
        for k in 0..poses {
            let part = TAU * f64::from(k) / f64::from(poses);
            let first = part / gear.external_sleeves as f64;
            let [along, across] = mesh.bearing(first, torque);
            // Exact torque equivalence: the component across the eccentric is T/(e zs).
            let lever = gear.eccentricity_m * (gear.external_sleeves as f64 - 1.0);
            close(across, torque / lever, 1e-13, "tangential bearing force");
            let external = mesh.forces(first, torque);
            let internal = output.forces(part / gear.internal_sleeves as f64, torque);
            let figures = [
                largest(&external),
                loaded(&external),
                along.hypot(across),
                largest(&internal),
                loaded(&internal),
            ];
            for (all, value) in course.iter_mut().zip(figures) {
                all.push(value);
            }
        }
        let keys = [
            "peak_n",
            "loaded_sleeves",
            "bearing_n",
            "output_n",
            "loaded_output_sleeves",
        ];
        for (key, values) in keys.into_iter().zip(&course) {
            let (actual, wanted) = (range(values), numbers(recorded, key));
            close(actual.0, wanted[0], tolerance, &format!("{name} {key}"));
            close(actual.1, wanted[1], tolerance, &format!("{name} {key}"));
        }
        let forces = mesh.forces(0.0, torque);
        let forces: Vec<f64> = forces.into_iter().filter(|&f| f > 1e-9).collect();
        let wanted = numbers(recorded, "forces_n");
        assert_eq!(forces.len(), wanted.len(), "{name}");
        for (f, r) in forces.iter().zip(&wanted) {
            close(*f, *r, tolerance, name);
        }
    }
}

#[test]
fn closed_forms_have_their_values() {
    let data = table("statics");
    let closed = data["closed"].as_table().unwrap();
    let mut gear = Scene::paper().gear;
    gear.backlash_m = 1.0;
    close(
        free_play(&gear),
        number(closed, "free_play_rad_per_m"),
        // All five printed digits.
        3e-5,
        "free play",
    );
    close(
        smallest_convex_radius(&gear),
        number(closed, "smallest_convex_radius_m"),
        1e-6,
        "radius",
    );
    // Every force pushes from pin to pitch point: their sum by plain geometry, on a circle of radius 1.
    let mesh = LinearMesh::of(&gear);
    let [mut along, mut across] = [0.0; 2];
    for (k, force) in mesh.forces(0.1, 11.0).into_iter().enumerate() {
        let angle = 0.1 + TAU * k as f64 / 16.0;
        let (x, y) = (gear.shortening - angle.cos(), -angle.sin());
        along += force * x / x.hypot(y);
        across -= force * y / x.hypot(y);
    }
    let force = mesh.bearing(0.1, 11.0);
    close(force[0], along, 1e-12, "along the eccentric");
    close(force[1], across, 1e-12, "across it");
    close(
        across,
        11.0 / (gear.eccentricity_m * 15.0),
        1e-12,
        "by the pitch point",
    );
    // Eight pins: those ahead of the eccentric push, in proportion to the sines of their angles.
    let output = LinearOutput::of(&gear);
    let lever = |k: usize| (0.1 + TAU * k as f64 / 8.0).sin().max(0.0);
    let squares: f64 = (0..8).map(|k| lever(k).powi(2)).sum();
    for (k, force) in output.forces(0.1, 11.0).into_iter().enumerate() {
        let wanted = 11.0 * lever(k) / (output.circle_radius * squares);
        assert!((force - wanted).abs() < 1e-9, "{k}: {force} {wanted}");
    }
    // F_max is about 4 T/(e zs zk): 63.8 to 66.1 N over a pitch.
    let (low, high) = LinearMesh::of(&gear).peak(11.0, 360);
    let rule = number(closed, "peak_n");
    assert!(
        low < rule && rule < high && high / low < 1.04,
        "{low} {rule} {high}"
    );
}

/// Ring stage with the paper's own law and exact geometry, against an independent prototype.
#[test]
fn quasi_static_peaks() {
    for case in table("statics")["case"].as_array().unwrap() {
        let case = case.as_table().unwrap();
        let mut scene = Scene::paper();
        scene.gear.backlash_m = number(case, "backlash_m");
        let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
        let mut statics = Statics::new(&gearbox).unwrap();
        let (mut peak, mut loaded) = ((f64::INFINITY, 0.0_f64), (99, 0));
        for k in 0..60_u32 {
            let balance = statics
                .solve(f64::from(k) / 60.0 * TAU / 15.0, 22.0)
                .unwrap();
            assert!(balance.residual < 1e-9, "{}", balance.residual);
            let pairs = statics.touching(&balance);
            for wheel in 0..2 {
                let forces: Vec<f64> = pairs
                    .iter()
                    .filter(|p| p.wheel == wheel && matches!(p.sleeve, Sleeve::External(_)))
                    .map(|p| p.normal_force_n)
                    .collect();
                let largest = forces.iter().copied().fold(0.0, f64::max);
                peak = (peak.0.min(largest), peak.1.max(largest));
                loaded = (loaded.0.min(forces.len()), loaded.1.max(forces.len()));
            }
        }
        // Measured 80.1-99.2, 108.1-130.8, 120.8-152.5: within 1.3 N of the prototype's rounded figures.
        let wanted = numbers(case, "peak_n");
        assert!(
            (peak.0 - wanted[0]).abs() < 1.5 && (peak.1 - wanted[1]).abs() < 1.0,
            "{peak:?} {wanted:?}"
        );
        let wanted = numbers(case, "loaded");
        assert_eq!(
            [loaded.0 as f64, loaded.1 as f64],
            wanted[..],
            "backlash {}",
            scene.gear.backlash_m
        );
    }
}

/// After 15/16 of a turn of the input every contact is where its neighbour was and the stored energy is unchanged. With a
/// potential the driver's work therefore equals the load's: 22/15 N m on average, exactly. The paper's law has no potential,
/// and deviates by 0.95 %.
#[test]
fn equilibria_do_the_work_of_the_load() {
    // Measured: 1e-7 from 22/15 for the laws with a potential; dynamic runs give 1.4529 for the paper's.
    let known = [
        ("paper", 1.4529, 1e-4),
        ("paper-conservative", 22.0 / 15.0, 2e-6),
        ("constant", 22.0 / 15.0, 2e-6),
        ("line-contact", 22.0 / 15.0, 2e-6),
        ("line-hertz", 22.0 / 15.0, 2e-6),
    ];
    std::thread::scope(|scope| {
        for (law, mean, tolerance) in known {
            scope.spawn(move || close(mean_driver_torque(law), mean, tolerance, law));
        }
    });
}

/// Returns the mean driver torque, N m, over the poses of a mesh under 22 N m, from the contact forces alone.
fn mean_driver_torque(law: &str) -> f64 {
    let mut scene = Scene::paper();
    scene.contact.law = law.into();
    let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
    let mut statics = Statics::new(&gearbox).unwrap();
    // The internal stage repeats eight times in this range, and both discs are equivalent.
    let poses = 960_u32;
    let mut sum = 0.0;
    for k in 0..poses {
        let phi = TAU * 15.0 / 16.0 * f64::from(k) / f64::from(poses);
        let balance = statics.solve(phi, 22.0).unwrap();
        let (mut output, mut driver, mut across) = (0.0, 0.0, 0.0);
        for pair in &statics.touching(&balance) {
            let ([fx, fy], [x, y]) = (pair.force_on_sleeve(), pair.centre);
            // The eccentric receives the disc's reaction, which the driver balances.
            let (s, c) = (phi + gearbox.geometry.wheel_phases[pair.wheel]).sin_cos();
            let tangential = fx * s - fy * c;
            driver -= 0.0028 * tangential;
            match pair.sleeve {
                Sleeve::Internal(_) => output += x * fy - y * fx,
                Sleeve::External(_) => across += tangential,
            }
        }
        assert!((output + 22.0).abs() < 1e-8, "{law}: {output}");
        // At each pose T/(e zs) holds for rigid teeth; elastic ones deviate by up to 2 %.
        close(across.abs(), 22.0 / (0.0028 * 15.0), 0.04, law);
        sum += driver;
    }
    sum / f64::from(poses)
}

/// Free rotation of a gear whose profile is cut 50 um smaller, equidistantly or by a smaller pin circle, by the package (least
/// gap over lever), against equilibria under almost no load in both directions. Measured: at most 1.5 % more.
#[test]
fn cycloidgen_measures_the_same_play() {
    let data = table("cycloidgen");
    let tolerance = number(&data, "play_tolerance");
    for recorded in data["gear"].as_array().unwrap() {
        let recorded = recorded.as_table().unwrap();
        let name = recorded["scene"].as_str().unwrap();
        for (k, wanted) in numbers(recorded, "play_arcmin").into_iter().enumerate() {
            let mut scene = Scene::load(name, &[]).unwrap().into_scene();
            // The package treats one disc; two discs have the play of the tighter one.
            scene.gear.wheels = 1;
            let modification = &mut scene.gear.modification;
            [modification.equidistant_m, modification.radial_m] = [[5e-5, 0.0], [0.0, -5e-5]][k];
            let gearbox = Gearbox::new(&scene.check().unwrap()).unwrap();
            let load = 1e-6 * gearbox.scene.drive.output_torque_n_m;
            let mut statics = Statics::new(&gearbox).unwrap();
            let mut play = 0.0_f64;
            for pose in 0..16_u32 {
                let phi = TAU * f64::from(pose) / 16.0 / gearbox.scene.gear.external_sleeves as f64;
                let [there, back] = [load, -load].map(|load| statics.solve(phi, load).unwrap());
                play = play.max(there.output - back.output);
            }
            let actual = play * 10_800.0 / std::f64::consts::PI;
            println!("{name}: {actual} arcmin, cycloidgen {wanted}");
            close(actual, wanted, tolerance, name);
        }
    }
}

/// Twist under load by the package's own kinematics and solver, with Pinwheel's line contact: lost motion, stiffness and
/// transmission error with play and without.
#[test]
fn cycloidgen_twists_alike() {
    let data = table("cycloidgen");
    let tolerances = numbers(&data, "compliance_tolerances");
    for recorded in data["gear"].as_array().unwrap() {
        let recorded = recorded.as_table().unwrap();
        let (name, torque) = (
            recorded["scene"].as_str().unwrap(),
            number(recorded, "wheel_torque_n_m"),
        );
        let cases = numbers(recorded, "compliance");
        let cuts = [[0.0; 2], [2e-6, 0.0], [0.0, -2e-6]];
        for (modification, wanted) in cuts.into_iter().zip(cases.chunks(3)) {
            let mut scene = Scene::load(name, &[]).unwrap().into_scene();
            let (gear, contact) = (&mut scene.gear, &mut scene.contact);
            gear.wheels = 1;
            [gear.modification.equidistant_m, gear.modification.radial_m] = modification;
            contact.law = "line-contact".into();
            (contact.line_length_m, contact.stiffness_multiplier) = (0.01, 1.0);
            let gearbox = Gearbox::new(&scene.check().unwrap()).unwrap();
            let computed = compliance(&gearbox, torque);
            for ((actual, wanted), tolerance) in computed.into_iter().zip(wanted).zip(&tolerances) {
                println!(
                    "{name} {modification:?}: {actual:.6} {wanted:.6} {:+.2e}",
                    actual / wanted - 1.0
                );
                close(actual, *wanted, *tolerance, name);
            }
        }
    }
}

/// Returns lost motion, stiffness and transmission error as in `reference/published/cycloidgen.toml`.
fn compliance(gearbox: &Gearbox, torque: f64) -> [f64; 3] {
    let (poses, gear) = (8_u32, &gearbox.scene.gear);
    let (mut lobes, mut pins) = (gear.external_sleeves - 1, gear.internal_sleeves);
    while pins > 0 {
        (lobes, pins) = (pins, lobes % pins);
    }
    let period = TAU * gearbox.geometry.lobes() / gear.external_sleeves as f64 / lobes as f64;
    let mut statics = Statics::new(gearbox).unwrap();
    let mut twists = |share: f64| -> Vec<f64> {
        let pose = |k: u32| {
            let phi = period * f64::from(k) / f64::from(poses);
            let balance = statics.solve(phi, share * torque).unwrap();
            let twist = balance.output - gearbox.geometry.ideal_output_angle(phi);
            twist * 10_800.0 / std::f64::consts::PI
        };
        (0..poses).map(pose).collect()
    };
    let [little, back, half, full] = [0.03, -0.03, 0.5, 1.0].map(&mut twists);
    let mean = |all: &[f64]| all.iter().sum::<f64>() / f64::from(poses);
    let (low, high) = range(&full);
    [
        mean(&little) - mean(&back),
        0.5 * torque / (mean(&full) - mean(&half)),
        high - low,
    ]
}

/// Printed reference of a calculator (K. Aggarwal, Cycloidal-Gearbox-Simulator, docs/SPEC.md, which states 2 %): equal springs,
/// 1 N m on one disc of aluminium against pins of steel.
#[test]
fn published_calculator_shares_the_load_alike() {
    let mut scene = Scene::paper();
    let gear = &mut scene.gear;
    gear.external_sleeves = 18;
    (gear.eccentricity_m, gear.wheels) = (0.0013, 1);
    gear.shortening = 0.0013 * 18.0 / 0.0425;
    gear.external_sleeve_radius_m = 0.0025;
    gear.internal_sleeves = 6;
    (gear.internal_sleeve_radius_m, gear.hole_radius_m) = (0.0025, 0.0038);
    gear.internal_circle_radius_m = 0.0329;
    scene.drive.output_torque_n_m = 1.0;
    let contact = &mut scene.contact;
    contact.law = "linear".into();
    (contact.young_pa, contact.poisson) = (69e9, 0.33);
    (contact.pin_young_pa, contact.pin_poisson) = (Some(200e9), Some(0.3));
    contact.line_length_m = 0.00635;
    let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
    let pressure = LinePressure::new(&gearbox.scene.contact);
    let mut statics = Statics::new(&gearbox).unwrap();
    let mut largest = [[0.0_f64; 2]; 2];
    for k in 0..400_u32 {
        let phi = TAU * 17.0 / 18.0 * f64::from(k) / 400.0;
        let balance = statics.solve(phi, 1.0).unwrap();
        let wheel = balance.bodies[gearbox.layout.wheel_bodies().start];
        for pair in statics.touching(&balance) {
            let stage = usize::from(matches!(pair.sleeve, Sleeve::Internal(_)));
            let p = pressure.of(&gearbox.geometry, &pair, [wheel.x, wheel.y], wheel.angle);
            let [force, most] = &mut largest[stage];
            *force = force.max(pair.normal_force_n);
            *most = most.max(1e-6 * p);
        }
    }
    println!("{largest:?}");
    for (actual, wanted) in largest.iter().flatten().zip([10.04, 118.56, 20.26, 89.21]) {
        close(*actual, wanted, 0.02, "calculator");
    }
}
