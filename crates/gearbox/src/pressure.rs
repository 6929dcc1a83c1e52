//! Pressure of line contacts after Hertz: p0 = sqrt(F E*/(pi L R)), E* = E/(2 (1 - nu^2)), over the line length L.
//!
//! Source: K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, section 4.2.

use std::f64::consts::PI;

use pinwheel_contact::Complex;
use pinwheel_scene::Contact;

use crate::contacts::PairContact;
use crate::{Geometry, Sleeve};

/// Pressures of a scene's contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinePressure {
    /// E*/(pi L), Pa/m.
    per_line: f64,
}

impl LinePressure {
    /// Of this material and length.
    #[must_use]
    pub fn new(contact: &Contact) -> Self {
        let modulus = contact.young_pa / (2.0 * (1.0 - contact.poisson * contact.poisson));
        Self {
            per_line: modulus / (PI * contact.line_length_m),
        }
    }

    /// p0 of a contact, Pa, whose wheel has its centre (m, ground frame) there and is turned by `angle` (rad).
    #[must_use]
    pub fn of(
        &self,
        geometry: &Geometry,
        contact: &PairContact,
        centre: [f64; 2],
        angle: f64,
    ) -> f64 {
        let radius = match contact.sleeve {
            Sleeve::External(j) => {
                let q = geometry.edge_offset_m;
                let kappa = curvature(geometry, contact, centre, angle);
                let sleeve = geometry.external_radii_m[j];
                sleeve * (1.0 - q * kappa) / (1.0 + (sleeve - q) * kappa)
            }
            Sleeve::Internal(k) => {
                let sleeve = geometry.internal_radii_m[k];
                let hole = geometry.hole_radii_m[contact.wheel][k];
                hole * sleeve / (hole - sleeve)
            }
        };
        (contact.normal_force_n * self.per_line / radius).sqrt()
    }
}

/// Curvature of C at the foot of the sleeve's centre, on the flank that it touches.
fn curvature(geometry: &Geometry, contact: &PairContact, centre: [f64; 2], angle: f64) -> f64 {
    let of = |[x, y]: [f64; 2]| Complex::new(x, y);
    let back = Complex::unit(angle).conj();
    let p = (of(contact.centre) - of(centre)) * back;
    let n = of(contact.normal) * back;
    let foot = |turn: Complex| {
        let at = geometry.curve.closest(p * turn.conj()).at;
        ((at.normal * turn).dot(n), at.curvature)
    };
    match geometry.flanks {
        None => foot(Complex::ONE).1,
        // n points inwards from the sleeve, the curve's normal outwards.
        Some(turn) => {
            let [one, other] = [foot(turn), foot(turn.conj())];
            if one.0 < other.0 { one.1 } else { other.1 }
        }
    }
}
