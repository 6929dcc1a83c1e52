//! Facts of the shipped solver programs: Simbody and SUNDIALS IDA.

use pinwheel_timeseries::SharedModel;

use crate::info::{EngineInfo, Refinement};

/// Engines of the family, in the order of reports.
pub(super) static ALL: &[&EngineInfo<'static>] = &[&SIMBODY, &IDA];

pub(crate) static SIMBODY: EngineInfo<'static> = EngineInfo {
    summary: "Simbody: pin mobilizers as a tree, Runge-Kutta-Merson, or CPodes with friction; Pinwheel's law",
    short: "simbody",
    colour: Some(11),
    feature: Some("crossval"),
    package: "simbody",
    refinement: Some(Refinement::tolerance(0.9)),
    // For steps limited by samples, at which they end: an error of 5e-9 at a tolerance of 1e-6 on a gear in equilibrium, at
    // every tolerance.
    shared_error: 0.02,
    usual_s: 12.0,
    differences: "A program in C++ of its own, which loads our contact law as a library. Every body turns on a pin relative \
        to its carrier, and Simbody's recursive equations give the accelerations; the input shaft follows a prescribed \
        motion, and the driver torque is the force that motion takes. Steps are chosen by error control, to \
        solver.tolerance times the elastic twist: Runge-Kutta-Merson without friction, and with friction CPodes, a BDF \
        method of variable order with Newton iterations. Contact points and contact law are the native solver's own: \
        this comparison cannot find an error in them.",
    ..EngineInfo::own("simbody-shared-law", SharedModel::SharedLaw)
};

pub(crate) static IDA: EngineInfo<'static> = EngineInfo {
    summary: "SUNDIALS IDA: free bodies, joints and driver as constraints, stabilised index 2, BDF; Pinwheel's law",
    short: "ida",
    colour: Some(12),
    feature: Some("crossval"),
    package: "scikit-sundae",
    refinement: Some(Refinement::tolerance(0.7)),
    // Steps depend on rounding: at 1e-6 the error of the output angle is 1.7e-7 on one processor, 3.7e-7 on another. Over kinks
    // of a light gear the runs at 1e-3 and 1e-4 both have an error of 1.9e-4, and differ by 4e-5.
    shared_error: 2.0,
    digits: 8,
    usual_s: 8.0,
    differences: "The published formulation, three coordinates a body and a multiplier for every constraint, given to a \
        general solver of differential-algebraic equations. Constraints hold at position and at velocity level (the form \
        of Gear, Gupta and Leimkuhler), so nothing drifts. Steps and order (BDF, 1 to 5) follow an error of a tenth of \
        solver.tolerance times the elastic twist, friction included, with Newton iterations on the whole system. Its \
        multipliers are not used: the driver torque is computed from the accelerations that positions and velocities \
        demand. Contact points and contact law are the native solver's own: this comparison cannot find an error in them.",
    ..EngineInfo::own("ida-shared-law", SharedModel::SharedLaw)
};
