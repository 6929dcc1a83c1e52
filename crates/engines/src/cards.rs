//! What is known without running them of engines that may be missing here: their names and how they differ.
//!
//! A build without them can still show what they gave, from recordings.

use crate::engine::Track;

/// One engine of the package `pinwheel_engines`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Card {
    pub(crate) name: &'static str,
    /// Package whose version counts.
    #[cfg_attr(
        not(feature = "python"),
        expect(dead_code, reason = "asked for by live engines")
    )]
    pub(crate) package: &'static str,
    pub(crate) track: Track,
    pub(crate) summary: &'static str,
    pub(crate) differences: &'static str,
    /// Friction is evaluated explicitly, so it needs the steps that it takes to resolve it.
    pub(crate) explicit_friction: bool,
}

/// All of them, in the order of reports.
pub(crate) const CARDS: &[Card] = &[
    Card {
        name: "mujoco-shared-law",
        explicit_friction: true,
        package: "mujoco-core",
        track: Track::SharedLaw,
        summary: "MuJoCo: hinges as a tree, Runge-Kutta 4; contact forces from Pinwheel's law",
        differences: "Joints are not constraints but coordinates: every body turns on a hinge relative to its carrier, \
            and MuJoCo's articulated-body equations give the mass matrix. Time integration is its own Runge-Kutta 4 at \
            the scene's step, with our contact law in every stage through a compiled callback; friction is therefore \
            explicit. The input speed is held by a rotor inertia 1e16 times a wheel's instead of a constraint (some \
            parts in 1e15), and the driver torque is that inertia times its deceleration. Contact points and contact law are \
            the native solver's own: this comparison cannot find an error in them.",
    },
    Card {
        name: "exudyn-shared-law-explicit",
        explicit_friction: true,
        package: "exudyn",
        track: Track::SharedLaw,
        summary: "exudyn: one kinematic tree, Runge-Kutta 4; contact forces from Pinwheel's law",
        differences: "Joints are coordinates, as in MuJoCo, but in exudyn's kinematic tree with exudyn's Runge-Kutta 4 \
            at the scene's step, and our contact law in every stage; friction is therefore explicit. The input speed is \
            held by a rotor inertia 1e16 times a wheel's instead of a constraint (some parts in 1e15). Contact points and \
            contact law are the native solver's own: this comparison cannot find an error in them.",
    },
    Card {
        name: "exudyn-shared-law-constrained",
        explicit_friction: false,
        package: "exudyn",
        track: Track::SharedLaw,
        summary: "exudyn: free bodies, joints and driver as constraints, implicit trapezoidal rule; Pinwheel's law",
        differences: "The closest relative of the published formulation: three coordinates a body, revolutes and \
            driver as constraints with Lagrange multipliers. Time integration is an implicit second-order method (index \
            2: constraints hold at velocity level, and positions drift by a part of a step squared) with Newton \
            iterations, our contact law in each of them; friction is implicit. Its error at the scene's step is that of \
            the trapezoidal rule, far above the Runge-Kutta methods', and falls four times when the step is halved. \
            Contact points and contact law are the native solver's own: this comparison cannot find an error in them.",
    },
    Card {
        name: "mujoco-own-contact",
        explicit_friction: false,
        package: "mujoco-core",
        track: Track::OwnContact,
        summary: "MuJoCo alone: wheel edges as beds of 4000 small spheres or more, holes as limited tendons",
        differences: "MuJoCo finds the contacts and computes the forces; nothing of ours runs in its step. Each wheel's \
            edge is a bed of 4000 spheres or more (seven in a loaded contact) with linear springs, which together give \
            K \u{3b4}^1.5 for a locally circular edge and conserve energy where the paper's law does not: that is most \
            of the difference in the driver torque. Holes are tendons of limited length with a chord approximation of K \u{3b4}^1.5. There is no ramp S \
            and no friction, and semi-implicit steps are some six a period of a wheel's vibration: steady courses are \
            comparable, the start-up transient is not.",
    },
    Card {
        name: "exudyn-own-contact",
        explicit_friction: false,
        package: "exudyn",
        track: Track::OwnContact,
        summary: "exudyn alone: circles on a polygon of 8000 spring segments or more, spheres in hollow spheres",
        differences: "exudyn finds the contacts and computes the forces; nothing of ours runs in its step. Each wheel's \
            edge is a polygon of 8000 spring segments or more, which conserve energy where the paper's law does not; holes are \
            hollow spheres with exponent 1.5, the law itself but for the ramp S. Damping of the external contacts acts \
            as a rotational damper on the wheels, because exudyn's own ignores how a body turns. There is no friction: \
            steady courses are comparable, the start-up transient is not.",
    },
];

/// The cards of all engines that may be recorded.
pub(crate) fn all() -> impl Iterator<Item = &'static Card> {
    CARDS.iter().chain(crate::solvers::CARDS)
}

/// The card of an engine.
pub(crate) fn card(name: &str) -> Option<&'static Card> {
    all().find(|card| card.name == name)
}

#[cfg(feature = "python")]
impl Card {
    /// Name and pinned version of what is behind the engine.
    pub(crate) fn version(&self) -> String {
        let name = self.package.trim_end_matches("-core");
        pins()
            .find(|pin| pin.package == self.package)
            .map_or_else(|| name.to_owned(), |pin| format!("{name} {}", pin.version))
    }
}

/// A pinned package.
#[cfg(feature = "python")]
pub(crate) struct Pin {
    pub(crate) package: &'static str,
    pub(crate) version: &'static str,
}

/// The pinned packages, from the list of what we ask for.
#[cfg(feature = "python")]
pub(crate) fn pins() -> impl Iterator<Item = Pin> {
    include_str!("../../../python/requirements.in")
        .lines()
        .filter_map(|line| {
            let (package, version) = line.split_once("==")?;
            (!package.starts_with('#')).then_some(Pin { package, version })
        })
}
