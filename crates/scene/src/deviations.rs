//! Deviations of a gear from the ideal one: its profile's modification, and the individual errors of its parts.
//!
//! The disc's edge is the inward offset by q' = q + equidistant of the epitrochoid with R' = R + radial and the gear's own
//! e, so that m' = e zk/R'; the ring keeps R and q. With a rotational modification it is the common part of two such discs,
//! turned by +delta and -delta. An offset w (`normal_m`) first moves the epitrochoid along its inward normal. A pin at the
//! angle phi from the eccentric then has a gap to the disc at the ideal mesh, to first order in all modifications and in
//! the backlash d, of
//!
//! ```text
//! g = equidistant + (d - radial) (1 - m cos phi)/S + delta e zs |sin phi|/S + w(pi - phi),    S = sqrt(1 + m^2 - 2 m cos phi)
//! ```
//! and its normal has the lever l = e zs sin(phi)/S about the disc's centre.
//! [`pinwheel_scene::free_play`](crate::free_play) is the least g/l. Signs, sources and use by engines: `docs/gears.md`.

use std::f64::consts::{PI, TAU};

use pinwheel_contact::{Epitrochoid, LobeOffset};

use crate::error::Fault;
use crate::model::{Errors, Gear, Modification, NormalOffset};
use crate::number::{below, short};

/// List of errors of equal parts.
#[derive(Debug, Clone, Copy)]
pub struct ErrorList<'a> {
    /// Key of the list.
    pub key: &'static str,
    /// Parts of the list, with one entry each.
    pub parts: &'static str,
    /// Number of entries of a list that is not empty.
    pub count: usize,
    /// Entries of the list.
    pub values: &'a [f64],
}

/// Returns the position of a part, m: `angle` (rad) and `radius` (m) are nominal; `radial` and `tangential` (m) are
/// displacements outwards and across.
pub(crate) fn placed(angle: f64, radius: f64, radial: f64, tangential: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    let out = radius + radial;
    [out * cos - tangential * sin, out * sin + tangential * cos]
}

/// Returns an entry of a list; 0 if the list has no such entry.
pub fn entry(list: &[f64], number: usize) -> f64 {
    list.get(number).copied().unwrap_or(0.0)
}

impl Modification {
    /// True if the profile is the ideal one.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl NormalOffset {
    /// True if there is no offset.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the offset as a function; `None` without one, or with too few points.
    pub fn of_lobe(&self) -> Option<LobeOffset> {
        match self.points_m.is_empty() {
            true if self.is_none() => None,
            true => LobeOffset::series(&self.cos_m, &self.sin_m),
            false => LobeOffset::spline(&self.points_m),
        }
    }
}

impl Errors {
    /// True if no part has an error.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Returns every list with its key and the expected number of entries.
    pub fn lists(&self, gear: &Gear) -> [ErrorList<'_>; 12] {
        let external = ("ring pins", gear.external_sleeves);
        let internal = ("output pins", gear.internal_sleeves);
        let holes = ("holes, disc by disc", gear.internal_sleeves * gear.wheels);
        let wheels = ("wheels", gear.wheels);
        macro_rules! lists {
            ($($field:ident $parts:ident;)*) => {
                [$(ErrorList {
                    key: concat!("gear.errors.", stringify!($field)),
                    parts: $parts.0,
                    count: $parts.1,
                    values: &self.$field,
                }),*]
            };
        }
        lists! {
            external_sleeve_radial_m external;
            external_sleeve_tangential_m external;
            external_sleeve_radius_m external;
            internal_sleeve_radial_m internal;
            internal_sleeve_tangential_m internal;
            internal_sleeve_radius_m internal;
            hole_radial_m holes;
            hole_tangential_m holes;
            hole_radius_m holes;
            crank_phase_rad internal;
            eccentricity_m wheels;
            phase_rad wheels;
        }
    }

    /// Sums the largest magnitude of every list whose key begins with one of `prefixes`, m: the largest combined effect of
    /// several errors of one part. The largest error of an eccentric's angle is added as its arc.
    fn largest_m(&self, gear: &Gear, prefixes: &[&str]) -> f64 {
        let largest = |list: &ErrorList<'_>| {
            let sizes = list.values.iter().map(|x| x.abs());
            sizes.fold(0.0, f64::max)
        };
        let lists = self.lists(gear);
        let named =
            |list: &&ErrorList<'_>| prefixes.iter().any(|name| list.key[12..].starts_with(name));
        let lengths: f64 = lists.iter().filter(named).map(largest).sum();
        let [.., phases] = &lists;
        lengths + largest(phases) * gear.eccentricity_m
    }

    /// Largest amount by which a gap between disc and ring pin exceeds its nominal value, m.
    pub fn largest_of_mesh_m(&self, gear: &Gear) -> f64 {
        self.largest_m(gear, &["external", "eccentricity"])
    }

    /// Largest excess over nominal of the gap between hole and output pin, m.
    pub fn largest_of_holes_m(&self, gear: &Gear) -> f64 {
        self.largest_m(gear, &["internal", "hole", "eccentricity"])
    }
}

impl Gear {
    /// Returns R', m: radius of the circle of the generating pin.
    pub fn generating_radius_m(&self) -> f64 {
        self.pitch_radius_m() + self.modification.radial_m
    }

    /// Returns m' = e zk/R' of the discs' epitrochoid.
    pub fn generating_shortening(&self) -> f64 {
        if self.modification.radial_m == 0.0 {
            return self.shortening;
        }
        self.eccentricity_m * self.external_sleeves as f64 / self.generating_radius_m()
    }

    /// Returns q', m: inward distance of a disc's edge from its epitrochoid.
    pub fn edge_offset_m(&self) -> f64 {
        self.external_sleeve_radius_m + self.modification.equidistant_m
    }

    /// Returns the generating curve with a user-defined offset; `None` without one, or if it folds.
    pub fn own_curve(&self) -> Option<Epitrochoid> {
        let offset = self.modification.normal_m.of_lobe()?;
        let sleeves = u32::try_from(self.external_sleeves).ok()?;
        let shortening = self.generating_shortening();
        Epitrochoid::with_offset(self.eccentricity_m, sleeves, shortening, Some(offset))
    }

    /// Returns the disc's edge as a function of the generating curve's parameter, m; without turned flanks.
    pub fn edge_m(&self) -> impl Fn(f64) -> [f64; 2] {
        let profile = crate::profile::Profile::of(self);
        move |a| profile.offset_point(a)
    }

    /// True if all parts are alike: without errors, and with the flanks of an epitrochoid, not turned.
    pub fn is_plain(&self) -> bool {
        let change = &self.modification;
        self.errors.is_none() && change.rotational_rad == 0.0 && change.normal_m.is_none()
    }

    /// Returns the centre of ring pin `j`, ground frame, m.
    pub fn external_sleeve_m(&self, j: usize) -> [f64; 2] {
        let errors = &self.errors;
        placed(
            TAU * j as f64 / self.external_sleeves as f64,
            self.pitch_radius_m() + self.backlash_m,
            entry(&errors.external_sleeve_radial_m, j),
            entry(&errors.external_sleeve_tangential_m, j),
        )
    }

    /// Radius of ring pin `j`, m.
    pub fn external_sleeve_radius_of_m(&self, j: usize) -> f64 {
        self.external_sleeve_radius_m + entry(&self.errors.external_sleeve_radius_m, j)
    }

    /// Radius of output pin `k`, m.
    pub fn internal_sleeve_radius_of_m(&self, k: usize) -> f64 {
        self.internal_sleeve_radius_m + entry(&self.errors.internal_sleeve_radius_m, k)
    }

    /// Radius of hole `k` of a disc, m.
    pub fn hole_radius_of_m(&self, wheel: usize, k: usize) -> f64 {
        let number = wheel * self.internal_sleeves + k;
        self.hole_radius_m + entry(&self.errors.hole_radius_m, number)
    }

    /// Returns the centre of output pin `k` in the frame of the output, m.
    pub fn internal_sleeve_m(&self, k: usize) -> [f64; 2] {
        placed(
            TAU * k as f64 / self.internal_sleeves as f64,
            self.internal_circle_radius_m,
            entry(&self.errors.internal_sleeve_radial_m, k),
            entry(&self.errors.internal_sleeve_tangential_m, k),
        )
    }

    /// Returns the centre of hole `k` of a disc relative to the disc's centre, m. The disc is turned by `turned` rad from
    /// the position with the nominal hole 0 on the x axis.
    pub fn hole_m(&self, wheel: usize, k: usize, turned: f64) -> [f64; 2] {
        let number = wheel * self.internal_sleeves + k;
        placed(
            TAU * k as f64 / self.internal_sleeves as f64 + turned,
            self.internal_circle_radius_m,
            entry(&self.errors.hole_radial_m, number),
            entry(&self.errors.hole_tangential_m, number),
        )
    }

    /// Eccentricity of a disc, m.
    pub fn eccentricity_of_m(&self, wheel: usize) -> f64 {
        self.eccentricity_m + entry(&self.errors.eccentricity_m, wheel)
    }

    /// Angle of a disc's eccentric from the input's, rad: 2 pi i/n and its error.
    pub fn phase_of_rad(&self, wheel: usize) -> f64 {
        TAU * wheel as f64 / self.wheels as f64 + entry(&self.errors.phase_rad, wheel)
    }

    /// Phase error of crank `k` of an RV gear, rad.
    pub fn crank_phase_of_rad(&self, k: usize) -> f64 {
        entry(&self.errors.crank_phase_rad, k)
    }

    /// Returns the gear without its output pins and holes; their lists of errors become empty.
    pub fn without_internal_sleeves(&self) -> Self {
        let mut gear = self.clone();
        gear.internal_sleeves = 0;
        let errors = &mut gear.errors;
        for list in [
            &mut errors.internal_sleeve_radial_m,
            &mut errors.internal_sleeve_tangential_m,
            &mut errors.internal_sleeve_radius_m,
            &mut errors.hole_radial_m,
            &mut errors.hole_tangential_m,
            &mut errors.hole_radius_m,
            &mut errors.crank_phase_rad,
        ] {
            list.clear();
        }
        gear
    }

    /// Returns the gap of a ring pin at the angle `phi` (rad) from the eccentric at the ideal mesh, to first order, m,
    /// negative for an overlap, and the lever of its normal about the disc's centre, m.
    pub fn initial_gap_m(&self, phi: f64) -> (f64, f64) {
        let m = self.shortening;
        let (sin, cos) = phi.sin_cos();
        let s = (1.0 + m * m - 2.0 * m * cos).sqrt();
        let lever = self.lever_m() * sin / s;
        let change = &self.modification;
        let outwards = self.backlash_m - change.radial_m;
        let gap = change.equidistant_m
            + outwards * (1.0 - m * cos) / s
            + change.rotational_rad * lever.abs()
            // Phase on a lobe of the foot on the flank with the larger gap.
            + change.normal_m.of_lobe().map_or(0.0, |offset| {
                offset.at(PI - phi)[0].max(offset.at(PI + phi)[0])
            });
        (gap, lever)
    }
}

/// Refuses lists of other lengths, and deviations too large for the gear.
pub(crate) fn check(gear: &Gear) -> Result<(), Fault> {
    let lists = gear.errors.lists(gear);
    let empty_or_full = |list: &&ErrorList<'_>| [0, list.count].contains(&list.values.len());
    if let Some(list) = lists.iter().find(|list| !empty_or_full(list)) {
        let ErrorList { count, parts, .. } = *list;
        let length = list.values.len();
        return Err(Fault::new(
            &[list.key],
            format!("has {length} entries, but there are {count} {parts}"),
            format!("give {count} numbers, or leave the list out"),
        ));
    }
    // Deviations beyond half of these leave hardly any contact, as for the backlash.
    let radii = [gear.external_sleeve_radius_m, gear.internal_sleeve_radius_m];
    let most = 0.5 * radii.into_iter().fold(gear.eccentricity_m, f64::min);
    let change = &gear.modification;
    let own = own_profile(gear)?;
    let changes = [
        (
            "gear.modification.normal_m",
            own.map_or(0.0, |offset| offset.largest()),
            most,
        ),
        (
            "gear.modification.equidistant_m",
            change.equidistant_m,
            most,
        ),
        ("gear.modification.radial_m", change.radial_m, most),
        (
            "gear.modification.rotational_rad",
            change.rotational_rad,
            most / gear.lever_m(),
        ),
    ];
    let errors = lists.iter().flat_map(|list| {
        let most = match list.key.ends_with("_rad") {
            true => most / gear.eccentricity_m,
            false => most,
        };
        list.values
            .iter()
            .map(move |value| (list.key, *value, most))
    });
    let mut all = changes.into_iter().chain(errors);
    if let Some((key, value, most)) = all.find(|(_, value, most)| value.abs() > *most) {
        let unit = if key.ends_with("_rad") { "rad" } else { "m" };
        let (value, most) = (short(value), below(most));
        return Err(Fault::new(
            &[key],
            format!(
                "has {value} {unit}, more than half of the eccentricity or of a pin's radius: that is another gear"
            ),
            format!("give at most {most} {unit}"),
        ));
    }
    let shortening = gear.generating_shortening();
    if shortening >= 1.0 {
        let [radius, shortening] = [gear.generating_radius_m(), shortening].map(short);
        return Err(Fault::new(
            &["gear.modification.radial_m"],
            format!(
                "leaves a generating circle of {radius} m, on which the disc's profile crosses itself: e zk/R' is {shortening}"
            ),
            "make it larger, or the eccentricity smaller",
        ));
    }
    if !change.normal_m.is_none() && gear.own_curve().is_none() {
        return Err(Fault::new(
            &["gear.modification.normal_m"],
            "bends so sharply that the generating curve folds or crosses itself",
            "give fewer or smaller waves",
        ));
    }
    Ok(())
}

/// Returns the offset of a user-defined profile.
fn own_profile(gear: &Gear) -> Result<Option<LobeOffset>, Fault> {
    let (change, own) = (&gear.modification, &gear.modification.normal_m);
    let points = own.points_m.len();
    let (what, remedy) = if points > 0 && own.cos_m.len() + own.sin_m.len() > 0 {
        ("gives points and a series".to_owned(), "give one of both")
    } else if !own.is_none() && own.of_lobe().is_none() {
        let what = format!(
            "gives {} numbers",
            points + own.cos_m.len() + own.sin_m.len()
        );
        (
            what,
            "give 3 to 1000 points of a lobe, or up to 1000 orders",
        )
    } else if !own.is_none() && change.rotational_rad > 0.0 {
        let what = "does not go with gear.modification.rotational_rad, whose flanks are turned";
        (
            what.to_owned(),
            "leave one of both out; an offset can turn flanks too",
        )
    } else {
        return Ok(own.of_lobe());
    };
    Err(Fault::new(&["gear.modification.normal_m"], what, remedy))
}
