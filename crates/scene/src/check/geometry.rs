//! Check that the parts fit together: profile, pins, holes.

use std::f64::consts::PI;

use super::super::deviations;
use super::super::error::Fault;
use super::super::model::Gear;
use super::super::profile::Profile;
use crate::number::{above, below, short};
use crate::wall::hole_to_profile_m;

/// Relative tolerance for values that are equal in decimal but not in binary (6 + 2.8 = 8.8 mm).
const ROUNDING: f64 = 1e-12;

/// Share of a pit's radius beyond the generating pin's by which a pin may be larger; at 1 it touches both sides of the pit.
const TIGHT: f64 = 0.8;

/// Checks a gear with single values in range.
pub(super) fn entire(gear: &Gear) -> Result<(), Fault> {
    outside(gear)?;
    internal_sleeves(gear)?;
    neighbours(gear)?;
    holes_inside_the_wheel(gear)
}

/// Checks the external stage: profile and ring pins.
pub(super) fn outside(gear: &Gear) -> Result<(), Fault> {
    deviations::check(gear)?;
    profile(gear)?;
    external_sleeves(gear)?;
    backlash(gear)
}

/// Returns half the distance of neighbouring ring pins' centres, m.
pub(super) fn half_pitch(gear: &Gear) -> f64 {
    (gear.pitch_radius_m() + gear.backlash_m) * (PI / gear.external_sleeves as f64).sin()
}

/// Checks that neighbouring ring pins do not touch on their circle of radius R + d.
pub fn external_sleeves(gear: &Gear) -> Result<(), Fault> {
    let q = gear.external_sleeve_radius_m;
    let half_pitch = half_pitch(gear);
    if q >= half_pitch {
        let below = below(half_pitch);
        let circle = gear.pitch_radius_m() + gear.backlash_m;
        let [q, circle, half_pitch] = [q, circle, half_pitch].map(short);
        let count = gear.external_sleeves;
        return Err(Fault::new(
            &[
                "gear.external_sleeve_radius_m",
                "gear.external_sleeves",
                "gear.eccentricity_m",
                "gear.shortening",
            ],
            format!(
                "is {q} m, so that neighbouring ring pins overlap: {count} of them on a circle of {circle} m leave {half_pitch} m each"
            ),
            format!("make it smaller than {below} m, or the pitch circle e zk/m larger"),
        ));
    }
    Ok(())
}

/// Checks that pins and holes with their individual errors do not overlap, and that pins fit into their holes.
fn neighbours(gear: &Gear) -> Result<(), Fault> {
    let errors = &gear.errors;
    if errors.is_none() {
        return Ok(());
    }
    type Part = ([f64; 2], f64);
    let apart = |one: Part, other: Part, (parts, a, b): (&str, usize, usize), key: &'static str| {
        let ([x, y], [u, v]) = (one.0, other.0);
        let room = (x - u).hypot(y - v) - one.1 - other.1;
        if room > 0.0 {
            return Ok(());
        }
        let what = format!("makes {parts} {a} and {b} overlap by {} m", short(-room));
        Err(Fault::new(
            &[key],
            what,
            "make the errors smaller, or these parts",
        ))
    };
    let around = |count: usize| (0..count).map(move |k| (k, (k + 1) % count));
    for (j, next) in around(gear.external_sleeves) {
        let part = |j: usize| {
            (
                gear.external_sleeve_m(j),
                gear.external_sleeve_radius_of_m(j),
            )
        };
        let key = match errors.external_sleeve_radius_m.is_empty() {
            true => "gear.errors.external_sleeve_tangential_m",
            false => "gear.errors.external_sleeve_radius_m",
        };
        apart(part(j), part(next), ("ring pins", j, next), key)?;
    }
    for wheel in 0..gear.wheels {
        for (k, next) in around(gear.internal_sleeves) {
            let part = |k: usize| (gear.hole_m(wheel, k, 0.0), gear.hole_radius_of_m(wheel, k));
            let key = "gear.errors.hole_radius_m";
            apart(part(k), part(next), ("holes", k, next), key)?;
            let (hole, sleeve) = (part(k).1, gear.internal_sleeve_radius_of_m(k));
            if sleeve >= hole {
                let [sleeve, hole] = [sleeve, hole].map(short);
                return Err(Fault::new(
                    &[
                        "gear.errors.internal_sleeve_radius_m",
                        "gear.errors.hole_radius_m",
                    ],
                    format!(
                        "makes output pin {k} {sleeve} m, larger than its hole of {hole} m in disc {wheel}"
                    ),
                    "make the errors smaller, or gear.hole_radius_m larger",
                ));
            }
        }
    }
    Ok(())
}

/// Checks that the disc's edge, the inward offset of C by q, does not fold (undercut).
///
/// The edge then crosses itself nowhere else: with q below the smallest convex radius and pins that do not overlap, no two
/// flanks come within 2 q (measured for zk from 3 up, checked by a property test).
pub fn profile(gear: &Gear) -> Result<(), Fault> {
    let q = gear.edge_offset_m();
    let curve = Profile::of(gear);
    let smallest = curve.smallest_convex_radius();
    // kappa <= 0 everywhere cannot happen on a closed curve, so `smallest` is positive.
    let undercut = q >= smallest;
    // Written only for a fault: remedies are searched by thousands of checks.
    let shown = || [q, smallest].map(short);
    if undercut && !gear.modification.is_none() {
        let plain = Gear {
            modification: crate::model::Modification::default(),
            ..gear.clone()
        };
        // An undercut of the gear without deviations is reported instead.
        profile(&plain)?;
        let most = below(smallest - gear.external_sleeve_radius_m);
        let [shown_q, shown_smallest] = shown();
        return Err(Fault::new(
            match gear.modification.normal_m.is_none() {
                true => &[
                    "gear.modification.equidistant_m",
                    "gear.modification.radial_m",
                ][..],
                false => &["gear.modification.normal_m"],
            },
            format!(
                "makes the generating pin {shown_q} m, so that the disc profile is undercut: its centre's path bends with a radius of {shown_smallest} m"
            ),
            format!(
                "make gear.modification.equidistant_m smaller than {most} m, or waves of gear.modification.normal_m gentler"
            ),
        ));
    }
    let radii = (0..gear.external_sleeves).map(|j| gear.external_sleeve_radius_of_m(j));
    let larger = radii.fold(0.0, f64::max) - q;
    let pit = -1.0 / curve.curvature(-1.0);
    if pit > 0.0 && larger > TIGHT * pit {
        let most = below(TIGHT * pit);
        let [larger, pit] = [larger, pit].map(short);
        return Err(Fault::new(
            &[
                "gear.modification.equidistant_m",
                "gear.errors.external_sleeve_radius_m",
            ],
            format!(
                "leaves ring pins {larger} m larger than the generating one, and the disc's pits are only {pit} m wider than that"
            ),
            format!("leave them at most {most} m larger"),
        ));
    }
    if undercut {
        let most = below(smallest.min(half_pitch(gear)));
        let [shown_q, shown_smallest] = shown();
        return Err(Fault::new(
            &[
                "gear.external_sleeve_radius_m",
                "gear.shortening",
                "gear.eccentricity_m",
                "gear.external_sleeves",
            ],
            format!(
                "is {shown_q} m, so that the disc profile is undercut: the pin centre's path bends with a radius of {shown_smallest} m"
            ),
            format!("make it smaller than {most} m, or e zk/m larger, or the shortening smaller"),
        ));
    }
    Ok(())
}

/// Checks the backlash: lobes reach 2 e between the pins, and half of e already leaves a quarter of that unused.
fn backlash(gear: &Gear) -> Result<(), Fault> {
    let most = 0.5 * gear.eccentricity_m.min(gear.external_sleeve_radius_m);
    if gear.backlash_m > most {
        let (backlash, most) = (short(gear.backlash_m), below(most));
        return Err(Fault::new(
            &["gear.backlash_m"],
            format!(
                "is {backlash} m, more than half of the eccentricity or of the ring pin radius: the lobes would hardly reach the ring pins"
            ),
            format!("give at most {most} m (the paper's largest is 0.0006 m)"),
        ));
    }
    Ok(())
}

/// Checks pins in their holes, and neighbouring holes.
///
/// Pins need no check for overlap: each is smaller than its hole.
fn internal_sleeves(gear: &Gear) -> Result<(), Fault> {
    let (sleeve, hole) = (gear.internal_sleeve_radius_m, gear.hole_radius_m);
    let circle = gear.internal_circle_radius_m;
    let least = sleeve + gear.eccentricity_m;
    let half_pitch = circle * (PI / gear.internal_sleeves as f64).sin();
    if sleeve >= hole {
        let (sleeve, shown, least) = (short(sleeve), short(hole), above(least));
        return Err(Fault::new(
            &["gear.internal_sleeve_radius_m", "gear.hole_radius_m"],
            format!("is {sleeve} m, larger than its hole of {shown} m"),
            format!(
                "make the pin smaller or gear.hole_radius_m at least pin + eccentricity = {least} m"
            ),
        ));
    }
    if hole < least * (1.0 - ROUNDING) {
        let (shown, sum, least) = (short(hole), short(least), above(least));
        return Err(Fault::new(
            &[
                "gear.hole_radius_m",
                "gear.internal_sleeve_radius_m",
                "gear.eccentricity_m",
            ],
            format!(
                "is {shown} m, smaller than output pin + eccentricity = {sum} m: the disc could not orbit"
            ),
            format!("give {least} m or more (exactly that much leaves no clearance)"),
        ));
    }
    if hole >= half_pitch {
        let (count, most) = (gear.internal_sleeves, below(half_pitch));
        let [shown, shown_circle, each] = [hole, circle, half_pitch].map(short);
        return Err(Fault::new(
            &[
                "gear.hole_radius_m",
                "gear.internal_sleeves",
                "gear.internal_circle_radius_m",
            ],
            format!(
                "is {shown} m, so that neighbouring holes overlap: {count} of them on a circle of {shown_circle} m leave {each} m each"
            ),
            format!("make the holes smaller than {most} m, fewer, or their circle larger"),
        ));
    }
    Ok(())
}

/// Checks that every hole lies inside the profile: its centre farther from C than hole radius + q.
///
/// A hole inside the circle through the pits is inside the disc at every angle.
pub fn holes_inside_the_wheel(gear: &Gear) -> Result<(), Fault> {
    let pit = Profile::of(gear).pit_radius();
    let (circle, hole) = (gear.internal_circle_radius_m, gear.hole_radius_m);
    if circle + hole + gear.errors.largest_of_holes_m(gear) < pit {
        return Ok(());
    }
    let wall = hole_to_profile_m(gear);
    if wall > 0.0 {
        return Ok(());
    }
    let most = below((pit - hole).max(0.0));
    let [hole, circle, free] = [hole, circle, (wall + hole).max(0.0)].map(short);
    Err(Fault::new(
        &["gear.hole_radius_m", "gear.internal_circle_radius_m"],
        format!(
            "is {hole} m, so that holes on a circle of {circle} m leave the disc: its edge is {free} m from a hole's centre"
        ),
        format!(
            "make gear.hole_radius_m smaller or gear.internal_circle_radius_m at most {most} m"
        ),
    ))
}
