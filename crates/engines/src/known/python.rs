//! Facts of the engines in Python: MuJoCo and exudyn.

use pinwheel_timeseries::SharedModel;

use super::model;
use crate::info::{EngineInfo, Refinement};
use crate::own_contact::OwnContact;

/// Engines of the family, in the order of reports.
pub(super) static ALL: &[&EngineInfo<'static>] = &[
    &MUJOCO_SHARED_LAW,
    &EXUDYN_EXPLICIT,
    &EXUDYN_CONSTRAINED,
    &MUJOCO_OWN_CONTACT,
    &EXUDYN_OWN_CONTACT,
];

pub(crate) static MUJOCO_SHARED_LAW: EngineInfo<'static> = EngineInfo {
    summary: "MuJoCo: hinges as a tree, Runge-Kutta 4; contact forces from Pinwheel's law",
    short: "mujoco",
    colour: Some(4),
    feature: Some("crossval"),
    package: "mujoco-core",
    refinement: Some(Refinement::step(4.0)),
    explicit_friction: true,
    usual_s: 5.5,
    differences: "Joints are not constraints but coordinates: every body turns on a hinge relative to its carrier, \
        and MuJoCo's articulated-body equations give the mass matrix. Time integration is its own Runge-Kutta 4 at \
        the scene's step, driven from Python, with our contact law in every stage through a compiled callback: the loop over \
        steps costs Python time, the law does not. Friction is therefore explicit. The input speed is held by a rotor inertia 1e16 times a disc's instead of a constraint (some \
        parts in 1e15), and the driver torque is that inertia times its deceleration. Contact points and contact law are \
        the native solver's own: this comparison cannot find an error in them.",
    ..EngineInfo::own("mujoco-shared-law", SharedModel::SharedLaw)
};

pub(crate) static EXUDYN_EXPLICIT: EngineInfo<'static> = EngineInfo {
    summary: "exudyn: one kinematic tree, Runge-Kutta 4; contact forces from Pinwheel's law",
    short: "exudyn-explicit",
    colour: Some(5),
    feature: Some("crossval"),
    package: "exudyn",
    refinement: Some(Refinement::step(4.0)),
    explicit_friction: true,
    usual_s: 10.0,
    differences: "Joints are coordinates, as in MuJoCo, but in exudyn's kinematic tree with exudyn's Runge-Kutta 4 \
        at the scene's step, and our contact law in every stage, called through Python, which is part of its CPU time, though the \
        law behind it is compiled; friction is therefore explicit. The input speed is \
        held by a rotor inertia 1e16 times a disc's instead of a constraint (some parts in 1e15). Contact points and \
        contact law are the native solver's own: this comparison cannot find an error in them.",
    ..EngineInfo::own("exudyn-shared-law-explicit", SharedModel::SharedLaw)
};

pub(crate) static EXUDYN_CONSTRAINED: EngineInfo<'static> = EngineInfo {
    summary: "exudyn: free bodies, joints and driver as constraints, implicit trapezoidal rule; Pinwheel's law",
    short: "exudyn-constrained",
    colour: Some(6),
    feature: Some("crossval"),
    package: "exudyn",
    refinement: Some(Refinement::step(2.0)),
    // Newton iterations end at a relative 1e-8, which adds up over steps: an RV gear in equilibrium had an error of 7e-8 at
    // every step.
    floor: 1e-7,
    digits: 7,
    usual_s: 16.0,
    differences: "The closest relative of the published formulation: three coordinates a body, revolutes and \
        driver as constraints with Lagrange multipliers. Time integration is an implicit second-order method (index \
        2: constraints hold at velocity level, and positions drift by a part of a step squared) with Newton \
        iterations, our contact law in each of them; friction is implicit. Its error at the scene's step is that of \
        the trapezoidal rule, far above the Runge-Kutta methods', and falls four times when the step is halved. \
        Contact points and contact law are the native solver's own: this comparison cannot find an error in them.",
    ..EngineInfo::own("exudyn-shared-law-constrained", SharedModel::SharedLaw)
};

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
    usual_s: 6.0,
    differences: "MuJoCo finds the contacts and computes the forces; nothing of ours runs in its step. Each disc's \
        edge is a bed of 4000 spheres or more (seven in a loaded contact) with linear springs, which together give \
        K \u{3b4}^1.5 for a locally circular edge and conserve energy where the paper's law does not: that is most \
        of the difference in the driver torque. Holes are tendons of limited length with a chord approximation of K \u{3b4}^1.5. There is no ramp S \
        and no friction, and semi-implicit steps are some six a period of a disc's vibration: steady time series are \
        comparable, the start-up transient is not.",
    ..EngineInfo::own("mujoco-own-contact", SharedModel::OwnContact)
};

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
    usual_s: 14.0,
    differences: "exudyn finds the contacts and computes the forces; nothing of ours runs in its step. Each disc's \
        edge is a bed of 4000 spring segments or more, which conserve energy where the paper's law does not; holes are \
        hollow spheres with exponent 1.5, the law itself but for the ramp S. Damping of the external contacts acts \
        as a rotational damper on the discs, because exudyn's own ignores how a body turns. There is no friction: \
        steady time series are comparable, the start-up transient is not.",
    ..EngineInfo::own("exudyn-own-contact", SharedModel::OwnContact)
};
