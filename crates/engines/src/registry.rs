//! The engines of this project, each with what is known of it whether a build has it or not. A new engine is a file in
//! `registry/`, its `mod`, and a row here.

mod model;
mod native;

use pinwheel_compare::model::ModelTolerance;
use pinwheel_mbs::integrators::UNSEEN;
use pinwheel_scene::Scene;

use crate::engine::{Engine, Refinement, SharedModel};
use crate::own_contact::OwnContact;
pub use native::Native;

/// The form of the equations that a native engine solves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Centre-pinned bodies eliminated.
    Reduced,
    /// All bodies, Eq. 2.
    Lagrange,
    /// The reduced form, integrated until the step no longer matters.
    Resolved,
}

/// Facts of an engine that are known without running it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EngineInfo<'a> {
    /// As typed by users, kebab-case, with what it shares in the names of others' engines.
    pub name: &'a str,
    /// The name where what it shares is said beside it.
    pub short: &'a str,
    /// Parts that the engine shares with the native solver.
    pub track: SharedModel,
    /// One line.
    pub summary: &'a str,
    /// How it differs from the native solver, in plain words, for the report.
    pub differences: &'a str,
    /// Which key of a scene makes it more accurate, and with which order; `None` where none does, and for native engines,
    /// whose methods have their own.
    pub refinement: Option<Refinement>,
    /// Relative error of the forces that its iterations leave, whatever the step.
    pub floor: f64,
    /// Error that none of its coarser runs show, as a share of its tolerance.
    pub shared_error: f64,
    /// Contacts that the engine has in place of the scene's contact law.
    pub own_contact: OwnContact,
    /// How far a contact model of its own is from ours.
    pub model: &'a [ModelTolerance],
    /// True if friction is evaluated explicitly, so that it takes short steps to resolve it.
    pub explicit_friction: bool,
    /// True if the engine runs in a process of its own, whose CPU time is not this one's.
    pub outside: bool,
    /// True for a solver of the user's: a comparison has to show something of it.
    pub brought: bool,
    /// The form of a native engine.
    pub form: Option<Form>,
    /// Colour of its lines, the same on every page; `None`: one that follows from its name.
    pub colour: Option<usize>,
    /// Feature of the builds that have it; `None` where all have.
    pub feature: Option<&'a str>,
    /// Package whose version counts, where that is pinned.
    pub package: &'a str,
    /// Digits of its recordings, which leave its own accuracy untouched: a thousandth of its limits.
    pub digits: usize,
    /// Its place among those that may stand in for Adams beside the paper's figures: multibody programs with contacts of
    /// their own, as Adams is one.
    pub stands_in: Option<usize>,
}

impl<'a> EngineInfo<'a> {
    /// An engine of which nothing else is known.
    #[must_use]
    pub const fn own(name: &'a str, track: SharedModel) -> Self {
        Self {
            name,
            short: name,
            track,
            summary: "",
            differences: "",
            refinement: None,
            floor: 0.0,
            shared_error: UNSEEN,
            own_contact: OwnContact::SceneLaw,
            model: &[],
            explicit_friction: false,
            outside: false,
            brought: false,
            form: None,
            colour: None,
            feature: None,
            package: "",
            digits: 9,
            stands_in: None,
        }
    }

    /// The program behind it: `exudyn` of `exudyn-own-contact`.
    #[must_use]
    pub fn family(&self) -> &'a str {
        family(self.name)
    }
}

/// The first word of an engine's name.
#[must_use]
pub fn family(name: &str) -> &str {
    name.split_once('-').map_or(name, |(family, _)| family)
}

/// See its fields.
pub(crate) static NATIVE_REDUCED: EngineInfo<'static> = EngineInfo {
    summary: "own solver, centre-pinned bodies eliminated exactly",
    short: "reduced",
    colour: Some(0),
    form: Some(Form::Reduced),
    differences: "One equation per angle that forces can change: discs, output, and with friction the pins. \
        Translations of centre-pinned bodies are eliminated exactly, so there are no joints to drift.",
    ..EngineInfo::own("native-reduced", SharedModel::Native)
};

/// See its fields.
pub(crate) static NATIVE_LAGRANGE: EngineInfo<'static> = EngineInfo {
    summary: "own solver, every body and joint by multipliers (Eq. 2)",
    short: "lagrange",
    colour: Some(1),
    form: Some(Form::Lagrange),
    differences: "Three coordinates per body and multipliers for every joint, as the paper writes it. The saddle-point \
        system is factored along the joints; positions are put back onto the constraints at every stage \
        unless the scene says otherwise.",
    ..EngineInfo::own("native-lagrange", SharedModel::Native)
};

/// See its fields.
pub(crate) static NATIVE_RESOLVED: EngineInfo<'static> = EngineInfo {
    summary: "own solver, reduced form, integrated until the step no longer matters",
    short: "resolved",
    colour: Some(2),
    form: Some(Form::Resolved),
    differences: "The equations of native-reduced without the scene's integrator and step: method and steps come from the \
        scene's frequencies and are refined until two runs show the forces to be within 1e-7 (with friction or points \
        1e-5) of the exact solution; the notes say what was reached. Its distance from native-reduced is the error of the \
        scene's own integrator.",
    ..EngineInfo::own("native-resolved", SharedModel::Native)
};

/// See its fields.
pub(crate) static RAPIER_SHARED_LAW: EngineInfo<'static> = EngineInfo {
    summary: "rapier2d's bodies, joints and time integration; contact forces from Pinwheel's law",
    short: "rapier",
    colour: Some(3),
    feature: Some("rapier"),
    refinement: Some(Refinement::step(2.0)),
    explicit_friction: true,
    differences: "Every body keeps its three coordinates. Revolutes are held by impulses, found by sweeps of projected \
        Gauss-Seidel from the last step's values, and their position errors are fed back. Time integration is \
        rapier's semi-implicit Euler used as leapfrog, which is second order: the first step carries half of every \
        force, and the contact law sees velocities extrapolated by half a step. The law is evaluated once a step, \
        friction included, so friction is explicit. The driver torque follows from the virtual work of the contact \
        forces on the eccentrics. Contact points and contact law are the native solver's own: this comparison \
        cannot find an error in them.",
    ..EngineInfo::own("rapier-shared-law", SharedModel::SharedLaw)
};

/// See its fields.
pub(crate) static RAPIER_HOOK: EngineInfo<'static> = EngineInfo {
    summary: "rapier2d's contact solver and implicit Coulomb friction, with Pinwheel's points and normal forces",
    short: "rapier-hook",
    colour: Some(7),
    feature: Some("rapier"),
    refinement: Some(Refinement::step(2.0)),
    model: model::HOOK,
    differences: "Bodies, joints and time integration as in rapier-shared-law, but the forces pass through rapier's own contact \
        solver: a hook hands it the contact point, the normal and a depth under which its spring carries the normal \
        force of the scene's law (a part of that law along the profile acts as a load beside it). Friction is \
        rapier's: implicit, exactly Coulomb, so that a contact may stick, where the scene's friction creeps below its \
        ramp speed (contact.friction_ramp_m_s is not used). Normal and friction forces are read from the impulses \
        rapier applied, so a sample averages over one step: an instant at which a contact begins to stick or slide \
        can differ visibly in the driver torque, for one step.",
    ..EngineInfo::own("rapier-own-contact-hook", SharedModel::OwnContact)
};

/// See its fields.
pub(crate) static RAPIER_COLLIDERS: EngineInfo<'static> = EngineInfo {
    summary: "rapier2d alone: its collision detection, contact spring and friction, on polyline discs",
    short: "rapier-colliders",
    colour: Some(8),
    feature: Some("rapier"),
    stands_in: Some(2),
    own_contact: OwnContact::Springs,
    model: model::COLLIDERS,
    differences: "Everything in contact is rapier's own. Discs and holes are closed polylines made from Eq. 1 alone, pins are \
        discs, contacts come from its collision detection (of several segments that touch a pin only the nearest \
        counts), friction is exactly Coulomb and implicit. Its contact spring is linear, not K delta^1.5: one frequency \
        serves all pairs, chosen so that its stiffness is right in the mean under the static load, and its implicit \
        integration damps far more than the scene's law. Steps are its own and longer. A linear spring spreads the load \
        over more pins, which raises mean forces and lowers peaks; and having a potential, it takes from the driver \
        what the load demands, where the paper's law creates energy. So only means are comparable, torques to 1.5 % and \
        forces to 10 %: peaks, wave forms and the start-up are not.",
    ..EngineInfo::own("rapier-own-contact-colliders", SharedModel::OwnContact)
};

/// See its fields.
pub(crate) static MUJOCO_SHARED_LAW: EngineInfo<'static> = EngineInfo {
    summary: "MuJoCo: hinges as a tree, Runge-Kutta 4; contact forces from Pinwheel's law",
    short: "mujoco",
    colour: Some(4),
    feature: Some("crossval"),
    package: "mujoco-core",
    refinement: Some(Refinement::step(4.0)),
    explicit_friction: true,
    differences: "Joints are not constraints but coordinates: every body turns on a hinge relative to its carrier, \
        and MuJoCo's articulated-body equations give the mass matrix. Time integration is its own Runge-Kutta 4 at \
        the scene's step, driven from Python, with our contact law in every stage through a compiled callback: the loop over \
        steps costs Python time, the law does not. Friction is therefore explicit. The input speed is held by a rotor inertia 1e16 times a disc's instead of a constraint (some \
        parts in 1e15), and the driver torque is that inertia times its deceleration. Contact points and contact law are \
        the native solver's own: this comparison cannot find an error in them.",
    ..EngineInfo::own("mujoco-shared-law", SharedModel::SharedLaw)
};

/// See its fields.
pub(crate) static EXUDYN_EXPLICIT: EngineInfo<'static> = EngineInfo {
    summary: "exudyn: one kinematic tree, Runge-Kutta 4; contact forces from Pinwheel's law",
    short: "exudyn-explicit",
    colour: Some(5),
    feature: Some("crossval"),
    package: "exudyn",
    refinement: Some(Refinement::step(4.0)),
    explicit_friction: true,
    differences: "Joints are coordinates, as in MuJoCo, but in exudyn's kinematic tree with exudyn's Runge-Kutta 4 \
        at the scene's step, and our contact law in every stage, called through Python, which is part of its CPU time, though the \
        law behind it is compiled; friction is therefore explicit. The input speed is \
        held by a rotor inertia 1e16 times a disc's instead of a constraint (some parts in 1e15). Contact points and \
        contact law are the native solver's own: this comparison cannot find an error in them.",
    ..EngineInfo::own("exudyn-shared-law-explicit", SharedModel::SharedLaw)
};

/// See its fields.
pub(crate) static EXUDYN_CONSTRAINED: EngineInfo<'static> = EngineInfo {
    summary: "exudyn: free bodies, joints and driver as constraints, implicit trapezoidal rule; Pinwheel's law",
    short: "exudyn-constrained",
    colour: Some(6),
    feature: Some("crossval"),
    package: "exudyn",
    refinement: Some(Refinement::step(2.0)),
    // Its Newton iterations end at a relative 1e-8, which adds up over steps: an RV gear in balance was off by 7e-8 at every step.
    floor: 1e-7,
    digits: 7,
    differences: "The closest relative of the published formulation: three coordinates a body, revolutes and \
        driver as constraints with Lagrange multipliers. Time integration is an implicit second-order method (index \
        2: constraints hold at velocity level, and positions drift by a part of a step squared) with Newton \
        iterations, our contact law in each of them; friction is implicit. Its error at the scene's step is that of \
        the trapezoidal rule, far above the Runge-Kutta methods', and falls four times when the step is halved. \
        Contact points and contact law are the native solver's own: this comparison cannot find an error in them.",
    ..EngineInfo::own("exudyn-shared-law-constrained", SharedModel::SharedLaw)
};

/// See its fields.
pub(crate) static MUJOCO_OWN_CONTACT: EngineInfo<'static> = EngineInfo {
    summary: "MuJoCo alone: disc edges as beds of 4000 small spheres or more, holes as limited tendons",
    short: "mujoco-own",
    colour: Some(9),
    feature: Some("crossval"),
    package: "mujoco-core",
    digits: 6,
    stands_in: Some(1),
    own_contact: OwnContact::Balls,
    model: model::BED,
    differences: "MuJoCo finds the contacts and computes the forces; nothing of ours runs in its step. Each disc's \
        edge is a bed of 4000 spheres or more (seven in a loaded contact) with linear springs, which together give \
        K \u{3b4}^1.5 for a locally circular edge and conserve energy where the paper's law does not: that is most \
        of the difference in the driver torque. Holes are tendons of limited length with a chord approximation of K \u{3b4}^1.5. There is no ramp S \
        and no friction, and semi-implicit steps are some six a period of a disc's vibration: steady time series are \
        comparable, the start-up transient is not.",
    ..EngineInfo::own("mujoco-own-contact", SharedModel::OwnContact)
};

/// See its fields.
pub(crate) static EXUDYN_OWN_CONTACT: EngineInfo<'static> = EngineInfo {
    summary: "exudyn alone: circles on 4000 spring segments or more, spheres in hollow spheres",
    short: "exudyn-own",
    colour: Some(10),
    feature: Some("crossval"),
    package: "exudyn",
    digits: 6,
    stands_in: Some(0),
    own_contact: OwnContact::Balls,
    model: model::BED,
    differences: "exudyn finds the contacts and computes the forces; nothing of ours runs in its step. Each disc's \
        edge is a bed of 4000 spring segments or more, which conserve energy where the paper's law does not; holes are \
        hollow spheres with exponent 1.5, the law itself but for the ramp S. Damping of the external contacts acts \
        as a rotational damper on the discs, because exudyn's own ignores how a body turns. There is no friction: \
        steady time series are comparable, the start-up transient is not.",
    ..EngineInfo::own("exudyn-own-contact", SharedModel::OwnContact)
};

/// See its fields.
pub(crate) static SIMBODY: EngineInfo<'static> = EngineInfo {
    summary: "Simbody: pin mobilizers as a tree, Runge-Kutta-Merson, or CPodes with friction; Pinwheel's law",
    short: "simbody",
    colour: Some(11),
    feature: Some("crossval"),
    package: "simbody",
    refinement: Some(Refinement::tolerance(0.9)),
    // Where samples, at which its steps end, set their length: at 1e-6 off by 5e-9 on a gear in balance, at every tolerance.
    shared_error: 0.02,
    differences: "A program in C++ of its own, which loads our contact law as a library. Every body turns on a pin relative \
        to its carrier, and Simbody's recursive equations give the accelerations; the input shaft follows a prescribed \
        motion, and the driver torque is the force that motion takes. Steps are chosen by error control, to \
        solver.tolerance times the elastic twist: Runge-Kutta-Merson without friction, and with friction CPodes, a BDF \
        method of variable order with Newton iterations. Contact points and contact law are the native solver's own: \
        this comparison cannot find an error in them.",
    ..EngineInfo::own("simbody-shared-law", SharedModel::SharedLaw)
};

/// See its fields.
pub(crate) static IDA: EngineInfo<'static> = EngineInfo {
    summary: "SUNDIALS IDA: free bodies, joints and driver as constraints, stabilised index 2, BDF; Pinwheel's law",
    short: "ida",
    colour: Some(12),
    feature: Some("crossval"),
    package: "scikit-sundae",
    refinement: Some(Refinement::tolerance(0.7)),
    // Its steps hang on rounding: at 1e-6 one processor's output angle is off by 1.7e-7, another's by 3.7e-7. Over kinks of a light
    // gear its runs at 1e-3 and 1e-4 are both off by 1.9e-4, and within 4e-5 of each other.
    shared_error: 2.0,
    digits: 8,
    differences: "The published formulation, three coordinates a body and a multiplier for every constraint, given to a \
        general solver of differential-algebraic equations. Constraints hold at position and at velocity level (the form \
        of Gear, Gupta and Leimkuhler), so nothing drifts. Steps and order (BDF, 1 to 5) follow an error of a tenth of \
        solver.tolerance times the elastic twist, friction included, with Newton iterations on the whole system. Its \
        multipliers are not used: the driver torque is computed from the accelerations that positions and velocities \
        demand. Contact points and contact law are the native solver's own: this comparison cannot find an error in them.",
    ..EngineInfo::own("ida-shared-law", SharedModel::SharedLaw)
};

/// Makes an engine; `None` where this build or this Python lacks it.
type Make = fn() -> Option<Box<dyn Engine>>;

/// Rows of engines: what is known of each, the builds that have it, and how it is made.
macro_rules! rows {
    ($($info:ident $builds:meta: $engine:expr;)*) => {
        [$((&$info, || {
            #[cfg($builds)]
            return $engine;
            #[cfg(not($builds))]
            None
        })),*]
    };
}

/// All of them, in the order of reports.
static ROWS: [(&EngineInfo<'static>, Make); 13] = rows! {
    NATIVE_REDUCED all(): boxed(Native::REDUCED);
    NATIVE_LAGRANGE all(): boxed(Native::LAGRANGE);
    NATIVE_RESOLVED all(): boxed(Native::RESOLVED);
    RAPIER_SHARED_LAW feature = "rapier": boxed(crate::rapier::SHARED_LAW);
    RAPIER_HOOK feature = "rapier": boxed(crate::rapier::HOOK);
    RAPIER_COLLIDERS feature = "rapier": boxed(crate::rapier::COLLIDERS);
    MUJOCO_SHARED_LAW feature = "python": crate::python::engine(&MUJOCO_SHARED_LAW);
    EXUDYN_EXPLICIT feature = "python": crate::python::engine(&EXUDYN_EXPLICIT);
    EXUDYN_CONSTRAINED feature = "python": crate::python::engine(&EXUDYN_CONSTRAINED);
    MUJOCO_OWN_CONTACT feature = "python": crate::python::engine(&MUJOCO_OWN_CONTACT);
    EXUDYN_OWN_CONTACT feature = "python": crate::python::engine(&EXUDYN_OWN_CONTACT);
    SIMBODY feature = "crossval": boxed(&crate::solvers::SIMBODY);
    IDA feature = "crossval": boxed(&crate::solvers::IDA);
};

fn boxed(engine: impl Engine + 'static) -> Option<Box<dyn Engine>> {
    Some(Box::new(engine))
}

/// Facts of all engines of this project, in this build or another.
pub fn known() -> impl Iterator<Item = &'static EngineInfo<'static>> {
    ROWS.iter().map(|(info, _)| *info)
}

/// Facts of the engine of a name; `None` for users' engines.
#[must_use]
pub fn info(name: &str) -> Option<&'static EngineInfo<'static>> {
    known().find(|info| info.name == name)
}

/// The engines of this project that this build lacks.
pub fn lacking() -> impl Iterator<Item = &'static EngineInfo<'static>> {
    let lacks = ROWS.iter().filter(|(_, make)| make().is_none());
    lacks.map(|(info, _)| *info)
}

/// All engines of this build, native first, then the solvers that joined ([`admit`](crate::external::admit)).
#[must_use]
pub fn registry() -> Vec<Box<dyn Engine>> {
    let built = ROWS.iter().filter_map(|(_, make)| make());
    built.chain(crate::external::admitted()).collect()
}

/// The engine of a name; `native` is the native solver in the formulation that the scene asks for.
#[must_use]
pub fn by_name(name: &str, scene: &Scene) -> Option<Box<dyn Engine>> {
    if name == "native" {
        return Some(Box::new(Native::of(scene)));
    }
    let name = full_name(name);
    registry().into_iter().find(|engine| engine.name() == name)
}

/// The name of an engine that pages and terminals call by its short one; a solver that joined by that name comes first.
#[must_use]
pub fn full_name(name: &str) -> &str {
    let joined = crate::external::admitted();
    if joined.into_iter().any(|engine| engine.name() == name) {
        return name;
    }
    let found = known().find(|info| info.short == name);
    found.map_or(name, |info| info.name)
}
