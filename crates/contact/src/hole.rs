//! Round hole in the disc with a pin inside.

use crate::{Complex, Scalar};

/// Circle of radius `radius` about `centre` (disc frame).
///
/// ```
/// use pinwheel_contact::{Complex, Hole};
///
/// // 8.8 mm about (38 mm, 0), a pin of 6 mm: 2.8 mm of clearance, used up and 0.1 mm more to the right.
/// let hole = Hole { centre: Complex::new(0.038, 0.0), radius: 0.0088 };
/// let (depth, normal) = hole.penetration(Complex::new(0.0409, 0.0), 0.006).expect("it touches");
/// assert!((depth - 1e-4).abs() < 1e-15);
/// assert_eq!(normal, Complex::ONE);
/// assert!(hole.penetration(Complex::new(0.0407, 0.0), 0.006).is_none());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// Centre, m.
    pub centre: Complex,
    /// Radius, m.
    pub radius: f64,
}

impl Hole {
    /// Returns the penetration (m, > 0) of a pin of radius `sleeve` centred at `p`, and the unit vector from the pin centre to
    /// the hole's closest point. `None` without contact.
    #[inline]
    pub fn penetration<S: Scalar>(&self, p: Complex<S>, sleeve: f64) -> Option<(S, Complex<S>)> {
        let c = |x: f64| p.re.like(x);
        let offset = p - self.centre.like(p.re);
        let clearance = self.radius - sleeve;
        let distance2 = offset.norm2();
        if distance2.value() <= clearance * clearance {
            return None;
        }
        let distance = distance2.sqrt();
        let penetration = distance - c(clearance);
        (penetration.value() > 0.0).then(|| (penetration, offset.scale(c(1.0) / distance)))
    }
}
