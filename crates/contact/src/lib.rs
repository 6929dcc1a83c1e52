//! Contact between curves: closest points, penetration laws, friction.
//!
//! Pure functions of gap, rate and curvature; nothing here knows of bodies or time.
//! Planar, SI units; vectors are `[x, y]`, rotations unit complex numbers.

mod closest;
mod closest_lanes;
mod complex;
mod epitrochoid;
mod friction;
mod hertz;
mod hole;
mod lanes;
pub mod laws;
mod points;

pub use closest_lanes::FeetLanes;
pub use complex::Complex;
pub use epitrochoid::{CurveError, CurvePoint, Epitrochoid, Foot};
pub use friction::{AdamsFriction, Friction, RegularisedCoulomb};
pub use hertz::HertzStiffness;
pub use hole::Hole;
pub use lanes::{ComplexLanes, Lanes, Mask};
pub use laws::{
    AdamsImpact, ConstantStiffness, Hysteresis, Law, LawParameters, LawVisitor, LineContact,
    NormalLaw, PaperConservative, PaperLaw, PaperPrinted, ramp,
};
pub use points::{HolePoints, ProfilePoints, Vertex};
