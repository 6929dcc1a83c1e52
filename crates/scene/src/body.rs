//! Masses of bodies from the gear's shapes, for scenes without them in [mass].

use std::f64::consts::PI;

use crate::model::Gear;
use crate::profile::Profile;

/// Flat body: area, m^2, and its polar second moment about its centre, m^4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Area, m^2.
    pub area_m2: f64,
    /// Polar second moment of area about the centre, m^4.
    pub polar_m4: f64,
}

impl Shape {
    /// Returns a circular disc.
    pub fn disc(radius_m: f64) -> Self {
        let area_m2 = PI * radius_m * radius_m;
        Self {
            area_m2,
            polar_m4: 0.5 * area_m2 * radius_m * radius_m,
        }
    }

    /// Returns the square of the radius of gyration, m^2.
    pub(crate) fn gyration_m2(self) -> f64 {
        self.polar_m4 / self.area_m2
    }

    /// Returns a cycloidal disc: the area inside its profile less its holes and its bore.
    pub(crate) fn wheel(gear: &Gear) -> Self {
        let profile = Self::profile(gear);
        let hole = Self::disc(gear.hole_radius_m);
        let bore = Self::disc(bore_radius_m(gear));
        let circle = gear.internal_circle_radius_m;
        let holes = gear.internal_sleeves as f64;
        Self {
            area_m2: profile.area_m2 - holes * hole.area_m2 - bore.area_m2,
            polar_m4: profile.polar_m4
                - holes * (hole.polar_m4 + hole.area_m2 * circle * circle)
                - bore.polar_m4,
        }
    }

    /// Returns the area inside the profile P(a) = C - q n: 1/2 and 1/4 of the integrals of (x dy - y dx) and of r^2 times
    /// it. The integrand is smooth with the period of a lobe, so the error of equal steps falls faster than any power of
    /// their number.
    pub fn profile(gear: &Gear) -> Self {
        let curve = Profile::of(gear);
        let lobes = gear.lobes() as f64;
        let points = 64 * 8_usize.div_ceil(gear.lobes().max(1));
        let step = 2.0 * PI / (lobes * points as f64);
        let mut shape = Self {
            area_m2: 0.0,
            polar_m4: 0.0,
        };
        for k in 0..points {
            let a = step * k as f64;
            let [x, y] = curve.offset_point(a);
            let [dx, dy] = curve.offset_slope(a);
            let turn = lobes * step * (x * dy - y * dx);
            shape.area_m2 += 0.5 * turn;
            shape.polar_m4 += 0.25 * (x * x + y * y) * turn;
        }
        shape
    }
}

/// Returns the bore radius of a disc for the bearing on its eccentric, m; without a stated one 0.6 of the radius inside the
/// holes.
pub fn bore_radius_m(gear: &Gear) -> f64 {
    let free = (gear.internal_circle_radius_m - gear.hole_radius_m).max(0.0);
    gear.eccentric_bore_radius_m.unwrap_or(0.6 * free)
}
