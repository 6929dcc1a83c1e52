//! Contact between curves: closest points, penetration laws, friction.
//!
//! Pure functions of gap, rate and curvature, independent of bodies and time. Planar, SI units; vectors are `[x, y]`, rotations
//! unit complex numbers.
//!
//! ```text
//!          curve C of pin centres                     hole in the disc
//!                  (Epitrochoid)                              (Hole)
//!
//!       outside        n ^                                 .-----------.
//!     -----------._      |  _.---------                  .'   pin   '.
//!                  '-.___|-'   C(a)                     /      .---.     \
//!       inside          delta                          |      (  P--)->W |
//!                        x P                            \      '---'  n  /
//!              (pin centre, pressed in)               '.           .'
//!                                                          '-----------'
//!
//!     P, start --> Epitrochoid::foot_within --> Foot: delta, n, kappa
//!                                 kappa --> HertzStiffness --> K
//!          K, delta, d(delta)/dt --> Law --> F_n, stored energy, force along the profile
//!                F_n, v_t --> Friction --> F_t
//! ```
//! [`HolePoints`] and [`ProfilePoints`] replace the exact curves by discrete points, as published.
//! [`Epitrochoid::penetrating_feet`] searches for several pins at once in vector registers ([`Lanes`]), verified against the
//! scalar search. [`laws`] lists the laws and explains how to add one.
//!
//! A pin pressed 20 um into the tip of a lobe of the paper's disc (e = 2.8 mm, zk = 16, m = 0.7), by the program and by hand:
//! ```
//! use pinwheel_contact::{Complex, Epitrochoid, HertzStiffness, Law, LawParameters, Material, NormalLaw};
//!
//! let curve = Epitrochoid::new(0.0028, 16, 0.7).expect("a gear has it");
//! // The tip is at a = 0: C = R + e = 64 + 2.8 mm on the x axis.
//! let sleeve_centre = Complex::new(0.0668 - 20e-6, 0.0);
//! let foot = curve.foot_within(sleeve_centre, [Complex::ONE; 2], 0.0).expect("it is inside");
//! assert!((foot.distance + 20e-6).abs() < 1e-15);
//!
//! // Pin of radius 6 mm, steel, stiffness multiplier 0.01: Eq. 23 with 1/kappa = 15.16 mm.
//! let steel = Material { young: 2e11, poisson: 0.3 };
//! let stiffness = HertzStiffness::new(steel, steel, 0.01).of_edge(0.006, 0.006, foot.at.curvature);
//! let h = (1.0 - 0.3_f64.powi(2)) / (std::f64::consts::PI * 2e11);
//! let by_hand = 4.0 * 0.01 / (6.0 * std::f64::consts::PI * h) * (0.006_f64 * (1.0 - 0.006 / 0.015_160_7)).sqrt();
//! assert!((stiffness / by_hand - 1.0).abs() < 1e-5);
//!
//! // Closing at 0.1 m/s: F_n = K delta^1.5 + C v, about 7.9 N + 0.8 N.
//! let parameters = LawParameters { damping: 8.0, ramp: 1e-5, ..LawParameters::default() };
//! let law = Law::named("paper", &parameters).expect("it is registered");
//! let force = law.force(stiffness, -foot.distance, 0.1);
//! assert!((force - (by_hand * 20e-6_f64.powf(1.5) + 0.8)).abs() < 1e-4 && (force - 8.69).abs() < 0.01);
//! ```

mod bisect;
mod closest;
mod closest_lanes;
mod complex;
mod dual;
mod epitrochoid;
mod friction;
mod hertz;
mod hole;
mod lanes;
pub mod laws;
mod lobe_offset;
mod points;
mod real;
mod search;

pub use bisect::bisect;
pub use closest_lanes::{FeetLanes, LocalFeet};
pub use complex::Complex;
pub use dual::Dual;
pub use epitrochoid::{CurvePoint, Epitrochoid, Foot};
pub use friction::{AdamsFriction, Friction, RegularisedCoulomb};
pub use hertz::{HertzStiffness, Material};
pub use hole::Hole;
pub use lanes::{ComplexLanes, Lanes, Mask};
pub use laws::{
    ConstantStiffness, Hysteresis, Law, LawParameters, NormalLaw, OnPin, PaperLaw, PinLaw, Ramp,
};
pub use lobe_offset::LobeOffset;
pub use points::{HolePoints, ProfilePoints, Vertex};
pub use real::{Real, Scalar};

/// Private items for the tests of this crate; not part of the interface.
#[doc(hidden)]
pub mod internals {
    pub use crate::search::Search;
}
