//! Pressure of line contacts after Hertz: p0 = sqrt(F E*/(pi L R)), 1/E* = (1 - nu_p^2)/E_p + (1 - nu_d^2)/E_d, over the line
//! length L.
//!
//! Source: K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, section 4.2.

use std::f64::consts::PI;

use pinwheel_contact::Complex;
use pinwheel_scene::{Contact, Detection};

use crate::contacts::PairContact;
use crate::{Geometry, Sleeve};

/// Pressures of a scene's contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinePressure {
    /// Factor E*/(pi L), Pa/m.
    per_line: f64,
    /// True if contacts lie on the exact curve.
    is_exact: bool,
}

impl LinePressure {
    /// Creates the pressure of contacts with the scene's materials and line length.
    pub fn new(contact: &Contact) -> Self {
        let softness = |young: f64, poisson: f64| (1.0 - poisson * poisson) / young;
        let (young, poisson) = (contact.young_pa, contact.poisson);
        let pins = softness(
            contact.pin_young_pa.unwrap_or(young),
            contact.pin_poisson.unwrap_or(poisson),
        );
        let modulus = (softness(young, poisson) + pins).recip();
        Self {
            per_line: modulus / (PI * contact.line_length_m),
            is_exact: contact.detection == Detection::Exact,
        }
    }

    /// Returns p0 of a contact, Pa; `centre` (m, ground frame) and `angle` (rad) are the disc's.
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
                let kappa = match self.is_exact && geometry.flanks.is_none() {
                    true => curvature_at_foot(geometry, contact, centre),
                    false => curvature(geometry, contact, centre, angle),
                };
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

/// Returns the curvature of C at its point C below the contact, 1/m; n is the outward normal there.
///
/// ```text
/// C = R u + e w,  g n = u + m w,  |u| = |w| = 1,  m = e zk/R    =>    zs u = zk C/R - g n
/// g = a - sqrt(zs^2 - b^2),   kappa = ((zk + 1) g - a)/(R g^2),   a, b: zk C/R along and across n
/// ```
pub fn curvature_at_foot(geometry: &Geometry, contact: &PairContact, centre: [f64; 2]) -> f64 {
    let of = |[x, y]: [f64; 2]| Complex::new(x, y);
    let n = -of(contact.normal);
    let on_curve = of(contact.point) - of(centre) + n.scale(geometry.edge_offset_m);
    let (radius, lobes) = (geometry.curve.pitch_radius(), geometry.lobes());
    let place = on_curve.scale((lobes + 1.0) / radius);
    let (a, b) = (place.dot(n), place.cross(n));
    let g = a - (lobes * lobes - b * b).max(0.0).sqrt();
    ((lobes + 2.0) * g - a) / (radius * g * g)
}

/// Returns the curvature of C at the foot of the pin's centre, on the flank that it touches, 1/m; `centre` (m) and `angle`
/// (rad) are the disc's.
pub fn curvature(geometry: &Geometry, contact: &PairContact, centre: [f64; 2], angle: f64) -> f64 {
    let of = |[x, y]: [f64; 2]| Complex::new(x, y);
    let back = Complex::unit(angle).conj();
    let p = (of(contact.centre) - of(centre)) * back;
    let n = of(contact.normal) * back;
    // Search limit beyond the radius of any pin that touches.
    let (curve, limit) = (&geometry.curve, 0.5 * geometry.curve.pitch_radius());
    let foot = |turn: Complex| {
        let p = p * turn.conj();
        let unit = p.scale(p.norm().recip());
        let start = [unit, unit.powu(curve.lobes() + 1)];
        let foot = curve.foot_within(p, start, limit);
        let at = foot.unwrap_or_else(|| curve.closest(p)).at;
        ((at.normal * turn).dot(n), at.curvature)
    };
    match geometry.flanks {
        None => foot(Complex::ONE).1,
        // n points from the pin inwards, the curve's normal outwards.
        Some(turn) => {
            let [one, other] = [foot(turn), foot(turn.conj())];
            if one.0 < other.0 { one.1 } else { other.1 }
        }
    }
}
