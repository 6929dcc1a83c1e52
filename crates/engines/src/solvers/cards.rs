//! What is known of the shipped solvers without running them.

use crate::cards::Card;
use crate::engine::Track;

pub(super) const SIMBODY: &str = "simbody-shared-law";
pub(super) const IDA: &str = "ida-shared-law";

/// All of them, in the order of reports.
pub(crate) const CARDS: &[Card] = &[
    Card {
        name: SIMBODY,
        explicit_friction: false,
        package: "simbody",
        track: Track::SharedLaw,
        summary: "Simbody: pin mobilizers as a tree, Runge-Kutta-Merson, or CPodes with friction; Pinwheel's law",
        differences: "A program in C++ of its own, which loads our contact law as a library. Every body turns on a pin relative \
            to its carrier, and Simbody's recursive equations give the accelerations; the input shaft follows a prescribed \
            motion, and the driver torque is the force that motion takes. Steps are chosen by error control, to \
            solver.tolerance times the elastic twist: Runge-Kutta-Merson without friction, and with friction CPodes, a BDF \
            method of variable order with Newton iterations. Contact points and contact law are the native solver's own: \
            this comparison cannot find an error in them.",
    },
    Card {
        name: IDA,
        explicit_friction: false,
        package: "scikit-sundae",
        track: Track::SharedLaw,
        summary: "SUNDIALS IDA: free bodies, joints and driver as constraints, stabilised index 2, BDF; Pinwheel's law",
        differences: "The published formulation, three coordinates a body and a multiplier for every constraint, given to a \
            general solver of differential-algebraic equations. Constraints hold at position and at velocity level (the form \
            of Gear, Gupta and Leimkuhler), so nothing drifts. Steps and order (BDF, 1 to 5) follow an error of a tenth of \
            solver.tolerance times the elastic twist, friction included, with Newton iterations on the whole system. Its \
            multipliers are not used: the driver torque is computed from the accelerations that positions and velocities \
            demand. Contact points and contact law are the native solver's own: this comparison cannot find an error in them.",
    },
];
