//! Known faults of solvers, as changes of the native model.

use std::ops::Range;

use pinwheel_contact::PinLaw;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::PairContact;
use pinwheel_scene::scales::hertz;
use pinwheel_scene::{Layout, Scene, Sleeve};

use super::judged::Stage;
use super::model::Change;

/// Meaning of the size p of a change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Size {
    /// Factor: the changed quantity is 1 + p times the native one.
    Factor,
    /// Offset added to a quantity, with its unit and a small size.
    Shift(&'static str, f64),
    /// Switch from the native form, 0, to another one, 1.
    Switch,
}

/// Offset of an angle, and of a length.
const ANGLE: Size = Size::Shift(" rad", 1e-6);
const LENGTH: Size = Size::Shift(" m", 1e-9);

/// Possible fault of a solver.
pub(super) struct Suspect {
    pub(super) stage: Stage,
    /// Cause in one word.
    pub(super) cause: &'static str,
    /// Change of the model, in words.
    pub(super) what: String,
    pub(super) size: Size,
    pub(super) change: Change,
}

impl Suspect {
    /// True if columns at given states show the fault.
    pub(super) fn shows_in_columns(&self) -> bool {
        !matches!(self.stage, Stage::Equations | Stage::Integration)
    }

    /// True if the fault affects the motion.
    pub(super) fn moves(&self) -> bool {
        self.change.moves()
    }

    /// True if the fault affects the motion while the forces stay right.
    pub(super) fn moves_alone(&self) -> bool {
        self.moves() && self.stage >= Stage::Assembly
    }
}

/// Selection of the pairs that a fault concerns, and access to a key.
type Of = fn(&PairContact) -> bool;
type Key = fn(&mut Scene) -> &mut f64;

/// Returns the suspects of a gear; among similar ones the likeliest first.
pub(super) fn of(gearbox: &Gearbox) -> Vec<Suspect> {
    use Size::{Factor, Shift, Switch};
    use Stage::{Assembly, ContactSearch, Driver, Equations, Integration, Law, Start};
    let mut all = Vec::new();
    let mut add = |stage, cause, what: &str, size, change| {
        let what = what.to_owned();
        all.push(Suspect {
            stage,
            cause,
            what,
            size,
            change,
        });
    };
    let (scene, layout) = (&gearbox.scene, gearbox.layout);
    let of_stages: [(&str, Of); 3] = [
        ("of all contacts", is_any),
        ("of ring pins", is_external),
        ("of output pins", |pair| !is_external(pair)),
    ];
    for (which, of) in of_stages {
        let change = pairs(of, |pair, law, p| {
            pair.along_force_n *= 1.0 + p;
            match law.law.info().stiffness {
                None => {
                    pair.stiffness *= 1.0 + p;
                    again(pair, law);
                }
                // For this law K is no stiffness.
                Some(_) => press(pair, p * pair.normal_force_at(law, 0.0)),
            }
        });
        add(
            Law,
            "stiffness",
            &format!("stiffness {which}"),
            Factor,
            change,
        );
        let change = pairs(of, |pair, law, p| {
            pair.normal_rate_m_s *= 1.0 + p;
            again(pair, law);
        });
        add(Law, "damping", &format!("damping {which}"), Factor, change);
        let change = pairs(of, |pair, _, p| pair.friction_force_n *= 1.0 + p);
        add(
            Law,
            "friction",
            &format!("friction {which}"),
            Factor,
            change,
        );
        let change = pairs(of, |pair, law, p| {
            pair.penetration_m = (pair.penetration_m + p).max(0.0);
            again(pair, law);
        });
        let what = format!("penetration {which}");
        add(ContactSearch, "penetration", &what, LENGTH, change);
    }
    let change = pairs(is_any, |pair, law, p| {
        let grown = pair.penetration_m.powf(p) - 1.0;
        press(pair, grown * pair.normal_force_at(law, 0.0));
    });
    let what = "exponent of the elastic force";
    add(Law, "exponent", what, Shift("", 1e-6), change);
    let (radius, hertz) = (scene.gear.external_sleeve_radius_m, hertz(scene));
    let flat = hertz.on_flat(radius);
    if hertz.is_curved() {
        // 1/R = 1/q + 1/R_p: in a pit R_p is below 0.
        let r = move |pair: &PairContact| radius * (pair.stiffness / flat).powi(2);
        let is_pit = move |pair: &PairContact| is_external(pair) && r(pair) > radius;
        let change = pairs(is_pit, move |pair, law, p| {
            let other = (2.0 / radius - 1.0 / r(pair)).recip();
            let more = (other / r(pair)).sqrt() - 1.0;
            press(pair, p * more * pair.normal_force_at(law, 0.0));
        });
        let what = "curvature of the other sign in pits";
        add(Law, "curvature", what, Switch, change);
    }
    if scene.contact.law == "paper" {
        let damping = scene.contact.damping_n_s_m;
        let change = pairs(is_any, move |pair, law, p| {
            let elastic = pair.normal_force_at(law, 0.0);
            let force = damping * pair.normal_rate_m_s + elastic;
            press(pair, p * (force.max(0.0) - pair.normal_force_n));
        });
        add(Law, "damping", "damping without its ramp", Switch, change);
    }
    let mut of_key = |stage, cause, what, key: Key| {
        if *key(&mut Scene::clone(scene)) != 0.0 {
            let change = keys(move |scene, p| *key(scene) *= 1.0 + p);
            add(stage, cause, what, Factor, change);
        }
    };
    of_key(Law, "damping", "contact.ramp_m", |s| &mut s.contact.ramp_m);
    of_key(Law, "friction", "contact.friction_ramp_m_s", |s| {
        &mut s.contact.friction_ramp_m_s
    });
    of_key(Start, "eccentricity", "gear.eccentricity_m", |s| {
        &mut s.gear.eccentricity_m
    });
    of_key(Equations, "load", "drive.load_ramp_s", |s| {
        &mut s.drive.load_ramp_s
    });
    let turned = |discs: Range<usize>| {
        keys(move |scene, p| {
            let errors = &mut scene.gear.errors.phase_rad;
            errors.resize(layout.wheels, 0.0);
            errors[discs.clone()]
                .iter_mut()
                .for_each(|error| *error += p);
        })
    };
    let what = "angle of the input";
    add(Start, "phase", what, ANGLE, turned(0..layout.wheels));
    let (circle, count) = (scene.gear.internal_circle_radius_m, layout.internal_sleeves);
    for wheel in 0..layout.wheels {
        let what = format!("phase of disc {wheel}'s eccentric");
        add(Start, "phase", &what, ANGLE, turned(wheel..wheel + 1));
        let change = keys(move |scene, p| {
            let errors = &mut scene.gear.errors.hole_tangential_m;
            errors.resize(layout.wheels * count, 0.0);
            let own = &mut errors[wheel * count..][..count];
            own.iter_mut().for_each(|error| *error += p * circle);
        });
        let what = format!("angle of disc {wheel}'s holes");
        add(Start, "holes", &what, ANGLE, change);
        let is_of = move |pair: &PairContact| pair.wheel == wheel;
        let change = pairs(is_of, |pair, _, p| {
            pair.along_force_n *= 1.0 + p;
            press(pair, p * pair.normal_force_n);
        });
        let what = format!("forces of disc {wheel}");
        add(Assembly, "sum", &what, Factor, change);
        let what = format!("share of disc {wheel} in the driver's torque");
        add(Driver, "share", &what, Factor, Change::DriverShare(wheel));
        let body = layout.wheel_bodies().start + wheel;
        let what = format!("inertia of disc {wheel}");
        add(Equations, "inertia", &what, Factor, turning(body..body + 1));
    }
    let what = "levers of the output pins as at the start";
    let frozen = Change::Frozen(gearbox.initial_states());
    add(Assembly, "lever", what, Switch, frozen);
    let (external, internal) = (layout.external_bodies(), layout.internal_bodies());
    let discs = layout.wheel_bodies();
    for (what, change) in [
        (
            "mass of the output pins on the output shaft",
            heavier(internal.clone(), None),
        ),
        (
            "inertia of the output with its pins",
            heavier(internal.clone(), Some(Layout::OUTPUT)),
        ),
        ("inertia of the discs", turning(layout.wheel_bodies())),
        ("inertia of the pins", turning(external.start..internal.end)),
        ("inertia of the ring pins", turning(external)),
        ("inertia of the output pins", turning(internal)),
        ("mass of the discs", heavier(discs, None)),
    ] {
        add(Equations, "inertia", what, Factor, change);
    }
    // The motion of a disc depends only on moment over inertia.
    let what = "moments of contact forces on the discs";
    add(Assembly, "lever", what, Factor, Change::Lever);
    add(Equations, "load", "load", Factor, Change::Load);
    add(
        Integration,
        "step",
        "motion in a step",
        Factor,
        Change::Step,
    );
    let last = 2 + layout.external_sleeves + count;
    for (stage, cause, what, columns) in [
        (Driver, "torque", "driver's torque as written", 0..1),
        (Assembly, "torque", "output's torque as written", 1..2),
        (Law, "force", "forces as written", 2..last),
    ] {
        let change = Change::Column(columns.start, columns.end);
        add(stage, cause, what, Factor, change);
    }
    all
}

fn is_any(_: &PairContact) -> bool {
    true
}

fn is_external(pair: &PairContact) -> bool {
    matches!(pair.sleeve, Sleeve::External(_))
}

/// Changes the pairs that a fault concerns.
fn pairs(
    of: impl Fn(&PairContact) -> bool + 'static,
    change: impl Fn(&mut PairContact, &PinLaw, f64) + 'static,
) -> Change {
    Change::Pair(Box::new(move |pair, law, p| {
        if of(pair) {
            change(pair, law, p);
        }
    }))
}

fn keys(set: impl Fn(&mut Scene, f64) + 'static) -> Change {
    Change::Scene(Box::new(set))
}

/// Returns a factor on moments of inertia.
fn turning(bodies: Range<usize>) -> Change {
    Change::Mass(Box::new(move |mechanism, p| {
        let bodies = &mut mechanism.bodies[bodies.clone()];
        bodies.iter_mut().for_each(|body| body.moment *= 1.0 + p);
    }))
}

/// Returns a factor on masses and on the moment of inertia of one body.
fn heavier(bodies: Range<usize>, turning: Option<usize>) -> Change {
    Change::Mass(Box::new(move |mechanism, p| {
        let masses = &mut mechanism.bodies[bodies.clone()];
        masses.iter_mut().for_each(|body| body.mass *= 1.0 + p);
        let moments = turning.map(|body| &mut mechanism.bodies[body].moment);
        moments.into_iter().for_each(|moment| *moment *= 1.0 + p);
    }))
}

/// Recomputes the forces of a changed pair.
fn again(pair: &mut PairContact, law: &PinLaw) {
    let normal = pair.normal_force_at(law, pair.normal_rate_m_s);
    press(pair, normal - pair.normal_force_n);
}

/// Adds to a pair's normal force, N, and in proportion to its friction.
fn press(pair: &mut PairContact, more: f64) {
    let before = pair.normal_force_n;
    pair.normal_force_n = (before + more).max(0.0);
    if before > 0.0 {
        pair.friction_force_n *= pair.normal_force_n / before;
    }
}
