//! Known faults of solvers, as changes of the native model.

use std::ops::Range;

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::PairContact;
use pinwheel_scene::scales::hertz;
use pinwheel_scene::{Layout, Scene, Sleeve};

use super::judged::Stage;
use super::model::Change;

/// Meaning of the size p of a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Size {
    /// Factor: the changed quantity is 1 + p times the native one.
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
    /// Change of the model, in words.
    pub(super) what: String,
    pub(super) size: Size,
    pub(super) change: Change,
}

impl Suspect {
    /// True if columns at given states show it.
    pub(super) fn shows_in_columns(&self) -> bool {
        !matches!(self.stage, Stage::Equations | Stage::Integration)
    }

    /// True if it acts on the motion.
    pub(super) fn moves(&self) -> bool {
        self.change.moves()
    }

    /// True if it acts on the motion where the forces are right.
    pub(super) fn moves_alone(&self) -> bool {
        self.moves() && self.stage >= Stage::Assembly
    }
}

/// Pairs that a fault concerns.
type Of = fn(&PairContact) -> bool;

/// Suspects of a gear, the most likely of those that look alike first.
pub(super) fn of(gearbox: &Gearbox) -> Vec<Suspect> {
    use Size::{Angle, Factor, Switch};
    use Stage::{Assembly, Driver, Equations, Integration, Law, Start};
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
    let (scene, layout, rubs) = (&gearbox.scene, gearbox.layout, gearbox.has_friction());
    let of_stages: [(&str, Of); 3] = [
        ("of all contacts", |_| true),
        ("of ring pins", is_external),
        ("of output pins", |pair| !is_external(pair)),
    ];
    for (which, of) in of_stages {
        let what = format!("stiffness {which}");
        let change = pairs(of, |pair, elastic| {
            let [normal, friction, _] = pressed(pair, elastic);
            [normal, friction, pair.along_force_n]
        });
        add(Law, "stiffness", &what, Factor, change);
        let what = format!("damping {which}");
        let damping = |pair: &PairContact, elastic| pressed(pair, pair.normal_force_n - elastic);
        add(Law, "damping", &what, Factor, pairs(of, damping));
        let what = format!("friction {which}");
        let friction = |pair: &PairContact, _| [0.0, pair.friction_force_n, 0.0];
        add(Law, "friction", &what, Factor, pairs(of, friction));
    }
    let (radius, hertz) = (scene.gear.external_sleeve_radius_m, hertz(scene));
    let flat = hertz.on_flat(radius);
    if hertz.is_curved() {
        // 1/R = 1/q + 1/R_p: in a pit R_p is below 0.
        let r = move |pair: &PairContact| radius * (pair.stiffness / flat).powi(2);
        let is_pit = move |pair: &PairContact| is_external(pair) && r(pair) > radius;
        let change = pairs(is_pit, move |pair, elastic| {
            let other = (2.0 / radius - 1.0 / r(pair)).recip();
            pressed(pair, elastic * ((other / r(pair)).sqrt() - 1.0))
        });
        let what = "curvature of the other sign in pits";
        add(Law, "curvature", what, Switch, change);
    }
    if scene.contact.law == "paper" {
        let damping = scene.contact.damping_n_s_m;
        let change = pairs(
            |_| true,
            move |pair, elastic| {
                let whole = damping * pair.normal_rate_m_s + elastic;
                pressed(pair, whole.max(0.0) - pair.normal_force_n)
            },
        );
        add(Law, "damping", "damping without its ramp", Switch, change);
    }
    let change = keys(|scene, p| scene.contact.ramp_m *= 1.0 + p);
    add(Law, "damping", "contact.ramp_m", Factor, change);
    if rubs {
        let change = keys(|scene, p| scene.contact.friction_ramp_m_s *= 1.0 + p);
        add(Law, "friction", "contact.friction_ramp_m_s", Factor, change);
    }
    let change = keys(|scene, p| scene.gear.eccentricity_m *= 1.0 + p);
    add(Start, "eccentricity", "gear.eccentricity_m", Factor, change);
    let (circle, count) = (scene.gear.internal_circle_radius_m, layout.internal_sleeves);
    for wheel in 0..layout.wheels {
        let change = keys(move |scene, p| {
            let errors = &mut scene.gear.errors.phase_rad;
            errors.resize(layout.wheels, 0.0);
            errors[wheel] += p;
        });
        let what = format!("phase of disc {wheel}'s eccentric");
        add(Start, "phase", &what, Angle, change);
        let change = keys(move |scene, p| {
            let errors = &mut scene.gear.errors.hole_tangential_m;
            errors.resize(layout.wheels * count, 0.0);
            let own = &mut errors[wheel * count..][..count];
            own.iter_mut().for_each(|error| *error += p * circle);
        });
        let what = format!("angle of disc {wheel}'s holes");
        add(Start, "holes", &what, Angle, change);
        let change = pairs(
            move |pair| pair.wheel == wheel,
            |pair, _| {
                let [normal, friction, _] = pressed(pair, pair.normal_force_n);
                [normal, friction, pair.along_force_n]
            },
        );
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
    let last = 2 + layout.external_sleeves + count;
    for (stage, cause, what, change) in [
        // A disc's motion knows moment over inertia alone.
        (
            Assembly,
            "lever",
            "moments of contact forces on the discs",
            Change::Lever,
        ),
        (Equations, "load", "load", Change::Load),
        (Integration, "step", "motion in a step", Change::Step),
        (
            Driver,
            "torque",
            "driver's torque as written",
            Change::Column(0, 1),
        ),
        (
            Assembly,
            "torque",
            "output's torque as written",
            Change::Column(1, 2),
        ),
        (Law, "force", "forces as written", Change::Column(2, last)),
    ] {
        add(stage, cause, what, Factor, change);
    }
    all
}

fn is_external(pair: &PairContact) -> bool {
    matches!(pair.sleeve, Sleeve::External(_))
}

/// Forces beside those of the pairs that it concerns.
fn pairs(
    of: impl Fn(&PairContact) -> bool + 'static,
    force: impl Fn(&PairContact, f64) -> [f64; 3] + 'static,
) -> Change {
    Change::Pair(Box::new(move |pair, elastic| match of(pair) {
        true => force(pair, elastic),
        false => [0.0; 3],
    }))
}

fn keys(set: impl Fn(&mut Scene, f64) + 'static) -> Change {
    Change::Scene(Box::new(set))
}

/// Factor on moments of inertia.
fn turning(bodies: Range<usize>) -> Change {
    Change::Mass(Box::new(move |mechanism, p| {
        let bodies = &mut mechanism.bodies[bodies.clone()];
        bodies.iter_mut().for_each(|body| body.moment *= 1.0 + p);
    }))
}

/// Factor on masses, and on the moment of inertia of a body.
fn heavier(bodies: Range<usize>, turning: Option<usize>) -> Change {
    Change::Mass(Box::new(move |mechanism, p| {
        let masses = &mut mechanism.bodies[bodies.clone()];
        masses.iter_mut().for_each(|body| body.mass *= 1.0 + p);
        let moments = turning.map(|body| &mut mechanism.bodies[body].moment);
        moments.into_iter().for_each(|moment| *moment *= 1.0 + p);
    }))
}

/// Forces of a pair with so much more normal force, N, and its share of the friction.
fn pressed(pair: &PairContact, more: f64) -> [f64; 3] {
    let share = more / pair.normal_force_n.max(f64::MIN_POSITIVE);
    [more, share * pair.friction_force_n, 0.0]
}
