//! What sets a gear apart from the ideal one: its profile's modification, and the individual errors of its parts.
//!
//! The wheel's edge is the inward offset by q' = q + equidistant of the epitrochoid with R' = R + radial and the gear's own e,
//! so that m' = e zk/R'; the ring keeps R and q. With a rotational modification it is what two such wheels have in
//! common, turned by +delta and -delta. A sleeve at the angle phi from the eccentric then stands off the wheel at the
//! ideal mesh, to first order in all modifications and in the backlash d, by
//!
//! ```text
//! g = equidistant + (d - radial) (1 - m cos phi)/S + delta e zs |sin phi|/S,    S = sqrt(1 + m^2 - 2 m cos phi)
//! ```
//! and its normal has the lever l = e zs sin(phi)/S about the wheel's centre. [`pinwheel_scene::free_play`](crate::free_play)
//! is the least g/l. Signs, sources and what engines make of it: `docs/modification.md`.

use crate::error::Fault;
use crate::model::{Errors, Gear, Modification};
use crate::number::{below, short};

/// One list of errors.
#[derive(Debug, Clone, Copy)]
pub struct ErrorList<'a> {
    /// Its key.
    pub key: &'static str,
    /// What it is about, of which it has one entry each.
    pub parts: &'static str,
    /// How many entries it has where it is not empty.
    pub count: usize,
    /// Its entries.
    pub values: &'a [f64],
}

/// A part's place, in polar form where it is not moved: angle and radius of the nominal part, outwards and across.
#[must_use]
pub(crate) fn placed(angle: f64, radius: f64, radial: f64, tangential: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    let out = radius + radial;
    [out * cos - tangential * sin, out * sin + tangential * cos]
}

/// An entry of a list that may be empty.
#[must_use]
pub fn entry(list: &[f64], number: usize) -> f64 {
    list.get(number).copied().unwrap_or(0.0)
}

impl Modification {
    /// Whether the profile is the ideal one.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl Errors {
    /// Whether there are none.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Every list with its key and the entries it should have.
    #[must_use]
    pub fn lists(&self, gear: &Gear) -> [ErrorList<'_>; 11] {
        let (external, internal, wheels) =
            (gear.external_sleeves, gear.internal_sleeves, gear.wheels);
        let list = |key, parts, count, values| ErrorList {
            key,
            parts,
            count,
            values,
        };
        let of_external = |key, values| list(key, "external sleeves", external, values);
        let of_internal = |key, values| list(key, "internal sleeves", internal, values);
        let of_holes = |key, values| list(key, "holes, wheel by wheel", internal * wheels, values);
        [
            of_external(
                "gear.errors.external_sleeve_radial_m",
                &self.external_sleeve_radial_m,
            ),
            of_external(
                "gear.errors.external_sleeve_tangential_m",
                &self.external_sleeve_tangential_m,
            ),
            of_external(
                "gear.errors.external_sleeve_radius_m",
                &self.external_sleeve_radius_m,
            ),
            of_internal(
                "gear.errors.internal_sleeve_radial_m",
                &self.internal_sleeve_radial_m,
            ),
            of_internal(
                "gear.errors.internal_sleeve_tangential_m",
                &self.internal_sleeve_tangential_m,
            ),
            of_internal(
                "gear.errors.internal_sleeve_radius_m",
                &self.internal_sleeve_radius_m,
            ),
            of_holes("gear.errors.hole_radial_m", &self.hole_radial_m),
            of_holes("gear.errors.hole_tangential_m", &self.hole_tangential_m),
            of_holes("gear.errors.hole_radius_m", &self.hole_radius_m),
            list(
                "gear.errors.eccentricity_m",
                "wheels",
                wheels,
                &self.eccentricity_m,
            ),
            list("gear.errors.phase_rad", "wheels", wheels, &self.phase_rad),
        ]
    }

    /// The largest entry of every list of lengths whose key begins so, summed: what several errors of one part do at most, m.
    fn largest_m(&self, gear: &Gear, prefixes: &[&str]) -> f64 {
        self.lists(gear)
            .iter()
            .filter(|list| prefixes.iter().any(|prefix| list.key.starts_with(prefix)))
            .map(|list| {
                list.values
                    .iter()
                    .fold(0.0, |most: f64, x| most.max(x.abs()))
            })
            .sum()
    }

    /// By how much a gap between wheel and external sleeve is larger than nominal at most, m.
    #[must_use]
    pub fn largest_of_mesh_m(&self, gear: &Gear) -> f64 {
        let phase = self
            .phase_rad
            .iter()
            .fold(0.0, |most: f64, x| most.max(x.abs()));
        self.largest_m(gear, &["gear.errors.external", "gear.errors.eccentricity"])
            + phase * gear.eccentricity_m
    }

    /// The same between hole and internal sleeve, m.
    #[must_use]
    pub fn largest_of_holes_m(&self, gear: &Gear) -> f64 {
        let phase = self
            .phase_rad
            .iter()
            .fold(0.0, |most: f64, x| most.max(x.abs()));
        let lists = [
            "gear.errors.internal",
            "gear.errors.hole",
            "gear.errors.eccentricity",
        ];
        self.largest_m(gear, &lists) + phase * gear.eccentricity_m
    }
}

impl Gear {
    /// R', m: radius of the circle on which the generating sleeve runs.
    #[must_use]
    pub fn generating_radius_m(&self) -> f64 {
        self.pitch_radius_m() + self.modification.radial_m
    }

    /// m' = e zk/R' of the wheels' epitrochoid.
    #[must_use]
    pub fn generating_shortening(&self) -> f64 {
        if self.modification.radial_m == 0.0 {
            return self.shortening;
        }
        self.eccentricity_m * self.external_sleeves as f64 / self.generating_radius_m()
    }

    /// q', m: by how much a wheel's edge lies inside its epitrochoid.
    #[must_use]
    pub fn edge_offset_m(&self) -> f64 {
        self.external_sleeve_radius_m + self.modification.equidistant_m
    }

    /// Whether the ring's sleeves are the generating one and all parts are alike: without errors, and with a radial
    /// modification at most.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        let change = &self.modification;
        self.errors.is_none() && change.equidistant_m == 0.0 && change.rotational_rad == 0.0
    }

    /// Where external sleeve `j` sits, ground frame, m.
    #[must_use]
    pub fn external_sleeve_m(&self, j: usize) -> [f64; 2] {
        placed(
            std::f64::consts::TAU * j as f64 / self.external_sleeves as f64,
            self.pitch_radius_m() + self.backlash_m,
            entry(&self.errors.external_sleeve_radial_m, j),
            entry(&self.errors.external_sleeve_tangential_m, j),
        )
    }

    /// Radius of external sleeve `j`, m.
    #[must_use]
    pub fn external_sleeve_radius_of_m(&self, j: usize) -> f64 {
        self.external_sleeve_radius_m + entry(&self.errors.external_sleeve_radius_m, j)
    }

    /// Radius of internal sleeve `k`, m.
    #[must_use]
    pub fn internal_sleeve_radius_of_m(&self, k: usize) -> f64 {
        self.internal_sleeve_radius_m + entry(&self.errors.internal_sleeve_radius_m, k)
    }

    /// Radius of hole `k` of a wheel, m.
    #[must_use]
    pub fn hole_radius_of_m(&self, wheel: usize, k: usize) -> f64 {
        let number = wheel * self.internal_sleeves + k;
        self.hole_radius_m + entry(&self.errors.hole_radius_m, number)
    }

    /// Where internal sleeve `k` sits on the output, its frame, m.
    #[must_use]
    pub fn internal_sleeve_m(&self, k: usize) -> [f64; 2] {
        placed(
            std::f64::consts::TAU * k as f64 / self.internal_sleeves as f64,
            self.internal_circle_radius_m,
            entry(&self.errors.internal_sleeve_radial_m, k),
            entry(&self.errors.internal_sleeve_tangential_m, k),
        )
    }

    /// The centre of hole `k` of a wheel about the wheel's, m, in directions in which the wheel is turned by `turned` rad
    /// from where hole 0 stands on the x axis.
    #[must_use]
    pub fn hole_m(&self, wheel: usize, k: usize, turned: f64) -> [f64; 2] {
        let number = wheel * self.internal_sleeves + k;
        placed(
            std::f64::consts::TAU * k as f64 / self.internal_sleeves as f64 + turned,
            self.internal_circle_radius_m,
            entry(&self.errors.hole_radial_m, number),
            entry(&self.errors.hole_tangential_m, number),
        )
    }

    /// Eccentricity of a wheel, m.
    #[must_use]
    pub fn eccentricity_of_m(&self, wheel: usize) -> f64 {
        self.eccentricity_m + entry(&self.errors.eccentricity_m, wheel)
    }

    /// Angle of a wheel's eccentric from the input's, rad: 2 pi i/n and its error.
    #[must_use]
    pub fn phase_of_rad(&self, wheel: usize) -> f64 {
        std::f64::consts::TAU * wheel as f64 / self.wheels as f64
            + entry(&self.errors.phase_rad, wheel)
    }

    /// The gap of an external sleeve that stands at the angle `phi` (rad) from the eccentric at the ideal mesh, to first
    /// order, m, and the lever of its normal about the wheel's centre, m; below 0 they overlap.
    #[must_use]
    pub fn initial_gap_m(&self, phi: f64) -> (f64, f64) {
        let m = self.shortening;
        let (sin, cos) = phi.sin_cos();
        let s = (1.0 + m * m - 2.0 * m * cos).sqrt();
        let lever = self.lever_m() * sin / s;
        let change = &self.modification;
        let outwards = self.backlash_m - change.radial_m;
        let gap = change.equidistant_m
            + outwards * (1.0 - m * cos) / s
            + change.rotational_rad * lever.abs();
        (gap, lever)
    }
}

/// Refuses lists of other lengths, and deviations that make another gear.
pub(crate) fn check(gear: &Gear) -> Result<(), Fault> {
    for list in gear.errors.lists(gear) {
        if !list.values.is_empty() && list.values.len() != list.count {
            return Err(Fault::new(
                &[list.key],
                format!(
                    "has {} entries, but there are {} {}",
                    list.values.len(),
                    list.count,
                    list.parts
                ),
                format!("give {} numbers, or leave the list out", list.count),
            ));
        }
    }
    // As for the backlash: beyond half of these the parts hardly meet.
    let most = 0.5
        * gear
            .eccentricity_m
            .min(gear.external_sleeve_radius_m)
            .min(gear.internal_sleeve_radius_m);
    let too_large = |key: &'static str, value: f64, most: f64, unit: &str| {
        Err(Fault::new(
            &[key],
            format!(
                "has {} {unit}, more than half of the eccentricity or of a sleeve's radius: that is another gear",
                short(value)
            ),
            format!("give at most {} {unit}", below(most)),
        ))
    };
    let change = &gear.modification;
    for (key, length) in [
        ("gear.modification.equidistant_m", change.equidistant_m),
        ("gear.modification.radial_m", change.radial_m),
    ] {
        if length.abs() > most {
            return too_large(key, length, most, "m");
        }
    }
    let most_rad = most / gear.lever_m();
    if change.rotational_rad > most_rad {
        let key = "gear.modification.rotational_rad";
        return too_large(key, change.rotational_rad, most_rad, "rad");
    }
    for list in gear.errors.lists(gear) {
        let (most, unit) = match list.key.ends_with("_rad") {
            true => (most / gear.eccentricity_m, "rad"),
            false => (most, "m"),
        };
        if let Some(&value) = list.values.iter().find(|value| value.abs() > most) {
            return too_large(list.key, value, most, unit);
        }
    }
    let shortening = gear.generating_shortening();
    if shortening >= 1.0 {
        return Err(Fault::new(
            &["gear.modification.radial_m"],
            format!(
                "leaves a generating circle of {} m, on which the wheel's profile crosses itself: e zk/R' is {}",
                short(gear.generating_radius_m()),
                short(shortening)
            ),
            "make it larger, or the eccentricity smaller",
        ));
    }
    Ok(())
}
