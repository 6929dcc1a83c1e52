//! Known faults of solvers, as changes of the native model.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::PairContact;
use pinwheel_mbs::Mechanism;
use pinwheel_scene::scales::hertz;
use pinwheel_scene::{Layout, Scene, Sleeve};

use super::judged::Stage;
use super::model::Change;

/// Meaning of the size p of a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Size {
    /// What it concerns is 1 + p times the native one.
    Factor,
    /// An angle, rad.
    Angle,
    /// 0: the native form, 1: the other one.
    Switch,
}

/// A fault that somebody could have made.
pub(super) struct Suspect {
    pub(super) stage: Stage,
    /// The cause in one word.
    pub(super) cause: &'static str,
    /// What is changed.
    pub(super) what: String,
    pub(super) size: Size,
    pub(super) change: Change,
}

/// Pairs that a fault concerns.
type Of = fn(&PairContact) -> bool;

const STAGES: [(&str, Of); 3] = [
    ("of all contacts", |_| true),
    ("of ring pins", |pair| {
        matches!(pair.sleeve, Sleeve::External(_))
    }),
    ("of output pins", |pair| {
        matches!(pair.sleeve, Sleeve::Internal(_))
    }),
];

/// Suspects of a gear, the most likely of those that look alike first.
pub(super) fn of(gearbox: &Gearbox) -> Vec<Suspect> {
    let mut all = Vec::new();
    let mut add = |stage, cause, what: &str, size, change| {
        all.push(Suspect {
            stage,
            cause,
            what: what.to_owned(),
            size,
            change,
        });
    };
    let (scene, layout) = (&gearbox.scene, gearbox.layout);
    let pairs = |of: Of, force: fn(&PairContact, f64) -> [f64; 3]| {
        Change::Pair(Box::new(move |pair, elastic| match of(pair) {
            true => force(pair, elastic),
            false => [0.0; 3],
        }))
    };
    for (which, of) in STAGES {
        let (law, by) = (Stage::Law, Size::Factor);
        let change = pairs(of, |pair, elastic| {
            let [normal, friction, _] = pressed(pair, elastic);
            [normal, friction, pair.along_force_n]
        });
        add(law, "stiffness", &format!("stiffness {which}"), by, change);
        let change = pairs(of, |pair, elastic| {
            pressed(pair, pair.normal_force_n - elastic)
        });
        add(law, "damping", &format!("damping {which}"), by, change);
        if gearbox.has_friction() {
            let change = pairs(of, |pair, _| [0.0, pair.friction_force_n, 0.0]);
            add(law, "friction", &format!("friction {which}"), by, change);
        }
    }
    let radius = scene.gear.external_sleeve_radius_m;
    let flat = hertz(scene).on_flat(radius);
    if hertz(scene).is_curved() {
        let change = Change::Pair(Box::new(move |pair, elastic| {
            // 1/R = 1/q + 1/R_p: in a pit R_p is below 0.
            let of = radius * (pair.stiffness / flat).powi(2);
            let pit = matches!(pair.sleeve, Sleeve::External(_)) && of > radius;
            let other = (2.0 / radius - 1.0 / of).recip();
            let share = if pit { (other / of).sqrt() - 1.0 } else { 0.0 };
            pressed(pair, elastic * share)
        }));
        let what = "curvature of the other sign in pits";
        add(Stage::Law, "curvature", what, Size::Switch, change);
    }
    if scene.contact.law == "paper" {
        let damping = scene.contact.damping_n_s_m;
        let change = Change::Pair(Box::new(move |pair, elastic| {
            let ramped = pair.normal_force_n - elastic;
            let more = damping * pair.normal_rate_m_s - ramped;
            pressed(pair, more.max(-pair.normal_force_n))
        }));
        add(
            Stage::Law,
            "damping",
            "damping without its ramp",
            Size::Switch,
            change,
        );
    }
    let mut key = |stage, cause, what: &str, set: fn(&mut Scene, f64)| {
        add(
            stage,
            cause,
            what,
            Size::Factor,
            Change::Scene(Box::new(set)),
        );
    };
    key(Stage::Law, "damping", "contact.ramp_m", |scene, p| {
        scene.contact.ramp_m *= 1.0 + p;
    });
    if gearbox.has_friction() {
        let what = "contact.friction_ramp_m_s";
        key(Stage::Law, "friction", what, |scene, p| {
            scene.contact.friction_ramp_m_s *= 1.0 + p;
        });
    }
    key(
        Stage::Start,
        "eccentricity",
        "gear.eccentricity_m",
        |scene, p| {
            scene.gear.eccentricity_m *= 1.0 + p;
        },
    );
    for wheel in 0..layout.wheels {
        let phase = move |scene: &mut Scene, p: f64| {
            let errors = &mut scene.gear.errors.phase_rad;
            errors.resize(layout.wheels, 0.0);
            errors[wheel] += p;
        };
        let change = Change::Scene(Box::new(phase));
        let what = format!("phase of disc {wheel}'s eccentric");
        add(Stage::Start, "phase", &what, Size::Angle, change);
        let circle = scene.gear.internal_circle_radius_m;
        let holes = move |scene: &mut Scene, p: f64| {
            let count = layout.internal_sleeves;
            let errors = &mut scene.gear.errors.hole_tangential_m;
            errors.resize(layout.wheels * count, 0.0);
            errors[wheel * count..][..count]
                .iter_mut()
                .for_each(|error| *error += p * circle);
        };
        let change = Change::Scene(Box::new(holes));
        let what = format!("angle of disc {wheel}'s holes");
        add(Stage::Start, "holes", &what, Size::Angle, change);
        let change = Change::Pair(Box::new(move |pair, _| match pair.wheel == wheel {
            true => [
                pair.normal_force_n,
                pair.friction_force_n,
                pair.along_force_n,
            ],
            false => [0.0; 3],
        }));
        let what = format!("forces of disc {wheel}");
        add(Stage::Assembly, "sum", &what, Size::Factor, change);
        let what = format!("share of disc {wheel} in the driver's torque");
        add(
            Stage::Driver,
            "share",
            &what,
            Size::Factor,
            Change::DriverShare(wheel),
        );
        let first = layout.wheel_bodies().start;
        let what = format!("inertia of disc {wheel}");
        let change = masses(first + wheel..first + wheel + 1, true);
        add(Stage::Equations, "inertia", &what, Size::Factor, change);
    }
    let what = "moments of contact forces on the discs";
    add(Stage::Assembly, "lever", what, Size::Factor, Change::Lever);
    let pins = layout.external_bodies().start..layout.bodies();
    let turning = [
        ("inertia of the discs", layout.wheel_bodies()),
        ("inertia of the pins", pins),
        ("inertia of the ring pins", layout.external_bodies()),
        ("inertia of the output pins", layout.internal_bodies()),
    ];
    let turning = turning.map(|(what, bodies)| (what, masses(bodies, true)));
    let output = move |mechanism: &mut Mechanism, p: f64| {
        mechanism.bodies[Layout::OUTPUT].moment *= 1.0 + p;
        for pin in layout.internal_bodies() {
            mechanism.bodies[pin].mass *= 1.0 + p;
        }
    };
    let equations = [
        (
            "mass of the output pins on the output shaft",
            masses(layout.internal_bodies(), false),
        ),
        (
            "inertia of the output with its pins",
            Change::Mass(Box::new(output)),
        ),
    ];
    let equations = equations.into_iter().chain(turning);
    for (what, change) in equations {
        add(Stage::Equations, "inertia", what, Size::Factor, change);
    }
    if gearbox.floats() {
        let change = masses(layout.wheel_bodies(), false);
        add(
            Stage::Equations,
            "inertia",
            "mass of the discs",
            Size::Factor,
            change,
        );
    }
    add(Stage::Equations, "load", "load", Size::Factor, Change::Load);
    add(
        Stage::Integration,
        "step",
        "motion in a step",
        Size::Factor,
        Change::Step,
    );
    let last = 2 + layout.external_sleeves + layout.internal_sleeves;
    for (stage, cause, what, (from, to)) in [
        (
            Stage::Driver,
            "torque",
            "driver's torque as written",
            (0, 1),
        ),
        (
            Stage::Assembly,
            "torque",
            "output's torque as written",
            (1, 2),
        ),
        (Stage::Law, "force", "forces as written", (2, last)),
    ] {
        add(stage, cause, what, Size::Factor, Change::Column(from, to));
    }
    all
}

/// Forces of a pair with so much more normal force, N, and its share of the friction.
fn pressed(pair: &PairContact, more: f64) -> [f64; 3] {
    let share = more / pair.normal_force_n.max(f64::MIN_POSITIVE);
    [more, share * pair.friction_force_n, 0.0]
}

/// Factor on masses of bodies, or on their moments of inertia.
fn masses(bodies: std::ops::Range<usize>, turning: bool) -> Change {
    Change::Mass(Box::new(move |mechanism, p| {
        for body in &mut mechanism.bodies[bodies.clone()] {
            let of = if turning {
                &mut body.moment
            } else {
                &mut body.mass
            };
            *of *= 1.0 + p;
        }
    }))
}
