//! Equilibria: solvers, starts in equilibrium, and the relation to slow runs.

use std::f64::consts::TAU;

use pinwheel_gearbox::contacts::Kernel;
use pinwheel_gearbox::statics::Statics;
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_mbs::Wrench;
use pinwheel_scene::{Layout, Scene, Start};

#[test]
fn too_much_load_is_refused() {
    let gearbox = Gearbox::new(&Scene::paper().clone().check().unwrap()).unwrap();
    let mut statics = Statics::new(&gearbox).unwrap();
    let error = statics.solve(0.0, 1e6).unwrap_err().to_string();
    assert!(error.contains("less load"), "{error}");
    // In the opposite direction the gear carries an equal load.
    let (there, back) = (
        statics.solve(0.0, 22.0).unwrap(),
        statics.solve(0.0, -22.0).unwrap(),
    );
    assert!(
        (there.output + back.output).abs() < 0.05 * there.output.abs(),
        "{} {}",
        there.output,
        back.output
    );
}

/// After a start in equilibrium the torques stay within 1 % of the mean of their final range; the kinematic start overshoots by
/// far more.
#[test]
fn equilibrium_start_has_no_transient() {
    for backlash in [0.0, 6e-4] {
        let course = |start: Start| {
            let mut scene = Scene::paper();
            scene.gear.backlash_m = backlash;
            scene.drive.start = start;
            scene.solver.integrator = "rk4".into();
            scene.solver.duration_s = 0.6;
            let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
            let run = native::run(&gearbox, &mut |_| false)
                .unwrap()
                .finished()
                .unwrap();
            run.time_series
                .channel("input_torque_n_m")
                .unwrap()
                .to_vec()
        };
        let torque = course(Start::Equilibrium);
        let mean = torque[3000..].iter().sum::<f64>() / 3001.0;
        let overshoot = |torque: &[f64]| {
            let least = |part: &[f64]| part.iter().copied().fold(f64::INFINITY, f64::min);
            let most = |part: &[f64]| part.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let (early, late) = (&torque[..500], &torque[3000..]);
            (least(late) - least(early)).max(most(early) - most(late)) / mean
        };
        let (loaded, kinematic) = (overshoot(&torque), overshoot(&course(Start::Kinematic)));
        assert!(loaded < 0.01, "d = {backlash}: {loaded}");
        assert!(kinematic > 0.3, "d = {backlash}: {kinematic}");
    }
}

/// Newton's law for a start in motion, with parts so heavy that their slow accelerations count: moments of the contacts equal
/// moments of inertia times second derivatives along the equilibria, and every part moves with its carrier. Without damping,
/// which changes these derivatives.
#[test]
fn equilibrium_start_obeys_newton() {
    let mut scene = Scene::paper();
    scene.drive.input_speed_rad_s = 20.0;
    scene.contact.damping_n_s_m = 0.0;
    scene.gear.wheels = 3;
    scene.mass.wheel.moment_kg_m2 = 1e-3;
    scene.mass.output_shaft.moment_kg_m2 = 5e-4;
    scene.mass.internal_sleeve.mass_kg = 0.05;
    let gearbox = Gearbox::new(&scene.check().unwrap()).unwrap();
    let (scene, layout) = (&gearbox.scene, gearbox.layout);
    let (speed, load) = (20.0, scene.drive.output_torque_n_m);
    let mut statics = Statics::new(&gearbox).unwrap();
    // A hundredth of the mesh period: contacts pass through their ramps within a few of these.
    let h = 0.01 * TAU / 16.0;
    let [before, here, after] = [-h, 0.0, h].map(|phi| statics.solve(phi, load).unwrap());
    let bodies = statics.moving().unwrap();
    let mut loads = vec![Wrench::default(); bodies.len()];
    gearbox
        .contact_field()
        .unwrap()
        .add_loads(&bodies, &mut loads);
    let check = |body: usize, angles: [f64; 3], moment: f64, inertia: f64| {
        let [a, m, b] = angles;
        let rate = speed * (b - a) / (2.0 * h);
        let needed = inertia * speed * speed * (a - 2.0 * m + b) / (h * h);
        println!("{body}: {rate} {}, {moment} {needed}", bodies[body].rate);
        assert!((bodies[body].rate / rate - 1.0).abs() < 1e-3, "body {body}");
        assert!(needed.abs() > 2e-5 * load, "body {body}: {needed}");
        assert!((moment - needed).abs() < 0.02 * needed.abs(), "body {body}");
    };
    for (i, body) in layout.wheel_bodies().enumerate() {
        let angles = [before.wheels[i], here.wheels[i], after.wheels[i]];
        check(
            body,
            angles,
            loads[body].moment,
            scene.mass.wheel.moment_kg_m2,
        );
    }
    let (mut moment, mut inertia) = (load, scene.mass.output_shaft.moment_kg_m2);
    for body in layout.internal_bodies() {
        let (at, force) = (bodies[body], loads[body]);
        moment += at.x * force.fy - at.y * force.fx;
        inertia += scene.mass.internal_sleeve.mass_kg * (at.x * at.x + at.y * at.y);
    }
    check(
        Layout::OUTPUT,
        [before.output, here.output, after.output],
        moment,
        inertia,
    );
    let carried = (layout.wheel_bodies().map(|b| (b, Layout::INPUT)))
        .chain(layout.internal_bodies().map(|b| (b, Layout::OUTPUT)));
    for (body, carrier) in carried {
        let (at, rate) = (bodies[body], bodies[carrier].rate);
        let off = (at.vx + rate * at.y).hypot(at.vy - rate * at.x);
        assert!(rate != 0.0 && off < 1e-12, "{at:?}");
    }
}

/// Slower runs are closer to the statics; without damping, which statics omits.
#[test]
fn slow_runs_tend_to_the_statics() {
    let worst = |speed: f64| {
        let mut scene = Scene::paper();
        scene.contact.damping_n_s_m = 0.0;
        scene.drive.start = Start::Equilibrium;
        scene.drive.input_speed_rad_s = speed;
        scene.solver.integrator = "rk4".into();
        scene.solver.duration_s = 0.02;
        scene.solver.sample_s = 5e-4;
        let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
        let run = native::run(&gearbox, &mut |_| false)
            .unwrap()
            .finished()
            .unwrap();
        let mut statics = Statics::new(&gearbox).unwrap();
        let output = run.time_series.channel("output_angle_rad").unwrap();
        let off = |(t, x): (&f64, &f64)| (x - statics.solve(speed * t, 22.0).unwrap().output).abs();
        run.time_series
            .time_s()
            .iter()
            .zip(output)
            .map(off)
            .fold(0.0, f64::max)
    };
    // Measured 4.0e-5, 4.8e-7 rad; the elastic twist is 9e-4 rad.
    let (fast, slow) = (worst(52.34), worst(5.234));
    assert!(
        fast < 8e-5 && slow < 1e-6 && slow < 0.05 * fast,
        "{fast:e} {slow:e}"
    );
}

/// Newton's method against nested brackets: equal angles to rounding in a hundredth of the evaluations, in lanes and in the
/// scalar loop.
#[test]
fn newton_finds_what_brackets_find() {
    for (preset, sets, kernel) in [
        ("paper", &[][..], Kernel::Lanes),
        ("paper", &[], Kernel::Scalar),
        ("steel", &[], Kernel::Lanes),
        ("backlash-0.6", &[], Kernel::Lanes),
        ("forty-pins", &[], Kernel::Lanes),
        ("toleranced", &[], Kernel::Lanes),
        (
            "toleranced",
            &[("drive.output_torque_n_m", "0.0022")],
            Kernel::Lanes,
        ),
        (
            "eleven-pins",
            &[("contact.law", "paper-conservative")],
            Kernel::Lanes,
        ),
        ("paper", &[("contact.law", "line-contact")], Kernel::Lanes),
        ("paper", &[("contact.law", "line-hertz")], Kernel::Lanes),
        (
            "paper",
            &[("drive.output_torque_n_m", "-30")],
            Kernel::Lanes,
        ),
    ] {
        let sets: Vec<pinwheel_scene::Override> = sets
            .iter()
            .map(|&(k, v)| pinwheel_scene::Override::new(k, v))
            .collect();
        let mut gearbox = Gearbox::new(&Scene::load(preset, &sets).unwrap()).unwrap();
        gearbox.kernel = kernel;
        let load = gearbox.scene.drive.output_torque_n_m;
        let light = load.abs() < 0.01;
        let poses = [0.0, 0.013, 0.4, 1.7];
        let mut statics = Statics::new(&gearbox).unwrap();
        let fast = poses.map(|phi| statics.solve(phi, load).unwrap());
        let few = statics.evaluations();
        let slow = poses.map(|phi| statics.solve_by_brackets(phi, load).unwrap());
        let many = statics.evaluations() - few;
        let mut worst: f64 = 0.0;
        for (a, b) in fast.iter().zip(&slow) {
            worst = worst.max((a.output - b.output).abs());
            // Under almost no load one disc may be anywhere in its play.
            for (a, b) in a.wheels.iter().zip(&b.wheels).filter(|_| !light) {
                worst = worst.max((a - b).abs());
            }
        }
        println!("{preset} under {load} N m: {worst:.1e} rad, {few} evaluations after {many}");
        // Measured: 2e-15 rad, and 3e-13 under the negligible forces of a very light load. 19 to 69 times fewer evaluations;
        // counts vary with the rounding of a machine.
        let (limit, most) = if light { (1e-12, 40) } else { (1e-13, 20) };
        assert!(worst < limit, "{preset}: {worst:e} rad");
        assert!(
            few <= most * poses.len() as u64 && few < many / 15,
            "{preset}: {few} evaluations, {many} by brackets"
        );
    }
}

/// Started from the equilibrium of the previous pose: equal angles to rounding in fewer evaluations, with play, errors and
/// almost no load.
#[test]
fn the_next_pose_starts_from_the_last() {
    for (preset, share) in [
        ("paper", 1.0),
        ("steel", 1.0),
        ("backlash-0.6", 1.0),
        ("backlash-0.6", 1e-4),
        ("toleranced", 1.0),
        ("toleranced", 1e-4),
    ] {
        let gearbox = Gearbox::new(&Scene::load(preset, &[]).unwrap()).unwrap();
        let load = share * gearbox.scene.drive.output_torque_n_m;
        let mut statics = Statics::new(&gearbox).unwrap();
        let mut near = statics.solve(0.0, load).unwrap();
        let (mut worst, mut costs) = (0.0_f64, [0; 2]);
        for k in 1..200_u32 {
            let phi = TAU / 128.0 * f64::from(k);
            let before = statics.evaluations();
            let afresh = statics.solve(phi, load).unwrap();
            let between = statics.evaluations();
            near = statics.solve_near(&near, phi, load).unwrap();
            costs[0] += between - before;
            costs[1] += statics.evaluations() - between;
            worst = worst.max((near.output - afresh.output).abs());
            assert!(
                near.residual <= 1e-9 * load.abs(),
                "{preset}: {} N m",
                near.residual
            );
        }
        println!("{preset}, {share} of the load: {worst:.1e} rad, {costs:?} evaluations");
        assert!(
            worst < if share < 1.0 { 1e-12 } else { 1e-13 },
            "{preset}: {worst:e} rad"
        );
        assert!(costs[1] < costs[0], "{preset}: {costs:?}");
    }
}

/// Stiffness at an equilibrium against differences of equilibria. Measured: an error of 1.6e-7, the law's curvature over 0.1 %
/// of the load.
#[test]
fn compliance_is_the_slope_of_balances() {
    for preset in ["paper", "steel", "toleranced"] {
        let gearbox = Gearbox::new(&Scene::load(preset, &[]).unwrap()).unwrap();
        let mut statics = Statics::new(&gearbox).unwrap();
        for phi in [0.0, 0.4] {
            let [less, here, more] =
                [0.999, 1.0, 1.001].map(|share| statics.solve(phi, 22.0 * share).unwrap());
            let slope = 0.044 / (more.output - less.output);
            let [stiffness, damping] = statics.compliance(&here).unwrap();
            println!("{preset}: {stiffness} N m/rad, differences {slope}; {damping} N m s/rad");
            assert!((stiffness / slope - 1.0).abs() < 1e-6, "{preset}");
            assert!(damping > 0.0, "{preset}: {damping}");
        }
    }
}

fn paper(sets: &[(&str, &str)]) -> Gearbox {
    let sets: Vec<pinwheel_scene::Override> = sets
        .iter()
        .map(|&(k, v)| pinwheel_scene::Override::new(k, v))
        .collect();
    Gearbox::new(&Scene::load("paper", &sets).unwrap()).unwrap()
}

/// Discrete points have no derivatives: brackets solve their equilibrium, which is close to that of the exact profile.
#[test]
fn points_are_balanced_by_brackets() {
    let twist = |detection: &str| {
        let gearbox = paper(&[
            ("contact.detection", detection),
            ("contact.wheel_points", "16000"),
        ]);
        let mut statics = Statics::new(&gearbox).unwrap();
        let at = statics.solve(0.3, 22.0).unwrap();
        assert_eq!(statics.compliance(&at).is_some(), detection == "exact");
        at.output - gearbox.geometry.ideal_output_angle(0.3)
    };
    let (points, exact) = (twist("points"), twist("exact"));
    assert!((points / exact - 1.0).abs() < 1e-2, "{points} {exact}");
}

/// One oversized pin presses an unloaded gear off its ideal mesh; a gear without errors rests there.
#[test]
fn errors_press_without_a_load() {
    let drawn = paper(&[]);
    let at = Statics::new(&drawn).unwrap().solve(0.3, 0.0).unwrap();
    assert_eq!(at.output, drawn.geometry.ideal_output_angle(0.3));
    let one = format!("[1e-5{}]", ", 0".repeat(15));
    let gearbox = paper(&[("gear.errors.external_sleeve_radius_m", &one)]);
    let mut statics = Statics::new(&gearbox).unwrap();
    let at = statics.solve(0.3, 0.0).unwrap();
    let by_brackets = statics.solve_by_brackets(0.3, 0.0).unwrap();
    let off = at.wheels[0] - gearbox.geometry.ideal_wheel_angle(0, 0.3);
    println!("{off:e} rad, {} N m left", at.residual);
    assert!(off.abs() > 1e-6 && at.residual < 1e-9);
    assert!((at.output - by_brackets.output).abs() < 1e-12);
}

/// Equilibria extrapolated from the previous ones equal those computed from scratch, within the rounding of the figures, on
/// every carrier. So few evaluations require an inverse that rotates with the eccentric.
#[test]
fn a_path_leads_to_the_balances_from_scratch() {
    for (preset, most) in [
        ("paper", 4.0),
        ("steel", 4.0),
        ("toleranced", 12.0),
        ("needle-bearings", 5.5),
        ("rv-40e-like", 7.0),
    ] {
        let gearbox = Gearbox::new(&Scene::load(preset, &[]).unwrap()).unwrap();
        let load = gearbox.scene.drive.output_torque_n_m;
        let [mut path, mut afresh] = [0; 2].map(|_| Statics::new(&gearbox).unwrap());
        let (mut last, mut worst) = (None, 0.0_f64);
        // An input angle with pins nearly as before, at another position of the eccentric.
        let meshed =
            TAU / gearbox.scene.gear.external_sleeves as f64 / gearbox.scene.eccentric_per_input();
        for k in 0..40 {
            let phi = 7.03 * meshed * f64::from(k);
            let ideal = gearbox.geometry.ideal_output_angle(phi);
            let twist = path.track(&mut last, phi, load).unwrap().output - ideal;
            if k % 8 == 7 {
                let expected = afresh.solve(phi, load).unwrap().output - ideal;
                worst = worst.max((twist / expected - 1.0).abs());
            }
        }
        let [balances, known] = path.balances();
        let each = path.evaluations() as f64 / balances as f64;
        println!("{preset}: {worst:.1e} of the twist, {each:.1} evaluations");
        assert_eq!((balances, known), (40, 0));
        assert!(worst < 1e-9 && each < most, "{preset}: {worst:e}, {each}");
    }
}
