//! Facts of the three engines based on rapier2d.

use pinwheel_timeseries::SharedModel;

use super::model;
use crate::info::{EngineInfo, Refinement};
use crate::own_contact::OwnContact;

/// Engines of the family, in the order of reports.
pub(super) static ALL: &[&EngineInfo<'static>] = &[&SHARED_LAW, &HOOK, &COLLIDERS];

pub(crate) static SHARED_LAW: EngineInfo<'static> = EngineInfo {
    summary: "rapier2d's bodies, joints and time integration; contact forces from Pinwheel's law",
    short: "rapier",
    colour: Some(3),
    feature: Some("rapier"),
    refinement: Some(Refinement::step(2.0)),
    explicit_friction: true,
    usual_s: 1.6,
    differences: "Every body keeps its three coordinates. Revolutes are held by impulses, found by sweeps of projected \
        Gauss-Seidel from the last step's values, and their position errors are fed back. Time integration is \
        rapier's semi-implicit Euler used as leapfrog, which is second order: the first step carries half of every \
        force, and the contact law sees velocities extrapolated by half a step. The law is evaluated once a step, \
        friction included, so friction is explicit. The driver torque follows from the virtual work of the contact \
        forces on the eccentrics. Contact points and contact law are the native solver's own: this comparison \
        cannot find an error in them.",
    ..EngineInfo::own("rapier-shared-law", SharedModel::SharedLaw)
};

pub(crate) static HOOK: EngineInfo<'static> = EngineInfo {
    summary: "rapier2d's contact solver and implicit Coulomb friction, with Pinwheel's points and normal forces",
    short: "rapier-hook",
    colour: Some(7),
    feature: Some("rapier"),
    refinement: Some(Refinement::step(2.0)),
    model: model::HOOK,
    usual_s: 5.0,
    differences: "Bodies, joints and time integration as in rapier-shared-law, but the forces pass through rapier's own contact \
        solver: a hook hands it the contact point, the normal and a depth under which its spring carries the normal \
        force of the scene's law (a part of that law along the profile acts as a load beside it). Friction is \
        rapier's: implicit, exactly Coulomb, so that a contact may stick, where the scene's friction creeps below its \
        ramp speed (contact.friction_ramp_m_s is not used). Normal and friction forces are read from the impulses \
        rapier applied, so a sample averages over one step: an instant at which a contact begins to stick or slide \
        can differ visibly in the driver torque, for one step.",
    ..EngineInfo::own("rapier-own-contact-hook", SharedModel::OwnContact)
};

pub(crate) static COLLIDERS: EngineInfo<'static> = EngineInfo {
    summary: "rapier2d alone: its collision detection, contact spring and friction, on polyline discs",
    short: "rapier-colliders",
    colour: Some(8),
    feature: Some("rapier"),
    stands_in: Some(2),
    own_contact: OwnContact::Springs,
    model: model::COLLIDERS,
    usual_s: 3.2,
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
