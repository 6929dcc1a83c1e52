//! Remedy for a gear that cannot be built because one length, or all, were typed in millimetres.

use super::geometry;
use crate::error::Fault;
use crate::model::Gear;
use crate::number::short;

type Length = (&'static str, fn(&mut Gear) -> &mut f64);

macro_rules! lengths {
    ($($field:ident),*) => {
        [$((concat!("gear.", stringify!($field)), |gear| &mut gear.$field)),*]
    };
}

/// Lengths that may be mistyped.
const LENGTHS: [Length; 6] = lengths!(
    eccentricity_m,
    external_sleeve_radius_m,
    internal_sleeve_radius_m,
    internal_circle_radius_m,
    hole_radius_m,
    backlash_m
);

/// Share of the gear's size below which no length is plausible.
const PLAUSIBLE: f64 = 0.005;

/// Returns the length of which a thousandth makes a gear that can be built, if there is exactly one.
pub(super) fn guess(gear: &Gear) -> Option<Fault> {
    for (key, length) in LENGTHS {
        let mut meant = gear.clone();
        let value = length(&mut meant);
        let typed = *value;
        *value *= 1e-3;
        let value = *value;
        // A thousandth that is too small beside the rest was not intended.
        let largest = meant
            .internal_circle_radius_m
            .max(meant.external_sleeve_radius_m);
        if value < PLAUSIBLE * largest {
            continue;
        }
        // A hole that follows from the wrong length is computed from the corrected one.
        let follows = gear.internal_sleeve_radius_m + gear.eccentricity_m;
        if (gear.hole_radius_m / follows - 1.0).abs() < 1e-9 {
            meant.hole_radius_m = meant.internal_sleeve_radius_m + meant.eccentricity_m;
        }
        // A shortening that follows from R changes too, and R stays.
        let mut same_circle = meant.clone();
        same_circle.shortening *= 1e-3;
        if geometry::entire(&meant).is_ok() || geometry::entire(&same_circle).is_ok() {
            let [typed, meant] = [typed, 1e-3 * typed].map(short);
            return Some(Fault::new(
                &[key],
                format!("is {typed} m, and no gear can be built with it"),
                format!("did you mean {meant}? lengths are in metres"),
            ));
        }
    }
    None
}
