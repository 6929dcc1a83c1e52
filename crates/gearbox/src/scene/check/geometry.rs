//! Whether the parts fit together: profile, sleeves, holes.

use std::f64::consts::{PI, TAU};

use super::super::error::Fault;
use super::super::model::Gear;
use super::super::profile::Profile;
use super::number::{above, below, short};

/// Relative slack for values that meet exactly in decimal but not in binary (6 + 2.8 = 8.8 mm).
const ROUNDING: f64 = 1e-12;

/// Checks a gear whose single values are in range.
pub(super) fn check(gear: &Gear) -> Result<(), Fault> {
    external_sleeves(gear)?;
    profile(gear)?;
    backlash(gear)?;
    internal_sleeves(gear)?;
    holes_inside_the_wheel(gear)
}

/// Neighbouring external sleeves must not touch on their circle of radius R + d.
fn external_sleeves(gear: &Gear) -> Result<(), Fault> {
    let q = gear.external_sleeve_radius_m;
    let half_pitch =
        (gear.pitch_radius_m() + gear.backlash_m) * (PI / gear.external_sleeves as f64).sin();
    if q >= half_pitch {
        return Err(Fault::new(
            &[
                "gear.external_sleeve_radius_m",
                "gear.external_sleeves",
                "gear.eccentricity_m",
                "gear.shortening",
            ],
            format!(
                "is {} m, so that neighbouring external sleeves overlap: {} of them on a circle of {} m leave {} m each",
                short(q),
                gear.external_sleeves,
                short(gear.pitch_radius_m() + gear.backlash_m),
                short(half_pitch)
            ),
            format!(
                "make it smaller than {} m, or the pitch circle e zk/m larger",
                below(half_pitch)
            ),
        ));
    }
    Ok(())
}

/// The wheel's edge, the inward offset of C by q, must neither fold (undercut) nor cross itself.
fn profile(gear: &Gear) -> Result<(), Fault> {
    let q = gear.external_sleeve_radius_m;
    let curve = Profile::of(gear);
    let keys = [
        "gear.external_sleeve_radius_m",
        "gear.shortening",
        "gear.eccentricity_m",
        "gear.external_sleeves",
    ];
    let smallest = curve.smallest_convex_radius();
    // kappa <= 0 everywhere cannot happen on a closed curve, so `smallest` is positive.
    if q >= smallest {
        return Err(Fault::new(
            &keys,
            format!(
                "is {} m, so that the wheel profile is undercut: the sleeve centre's path bends with a radius of {} m",
                short(q),
                short(smallest)
            ),
            format!(
                "make it smaller than {} m, or e zk/m larger, or the shortening smaller",
                below(smallest)
            ),
        ));
    }
    if curve.pit_radius() <= 0.0 || crosses_itself(&curve, q) {
        return Err(Fault::new(
            &keys,
            format!(
                "is {} m, so that opposite flanks of the wheel cross: no wheel is left",
                short(q)
            ),
            "make it smaller, or the pitch circle e zk/m larger",
        ));
    }
    Ok(())
}

/// True when a point of the profile is nearer than q to another part of C.
///
/// Only a wheel of few lobes can be that narrow: the sleeves of a ring do not overlap, so q < R sin(pi/zk),
/// and the wheel's core has the radius R - e - q > R (1 - m/zk - pi/zk), more than q once zk >= 8.
fn crosses_itself(curve: &Profile, q: f64) -> bool {
    if curve.lobes() > 9.0 {
        return false;
    }
    (0..=48).any(|i| {
        let a = PI / curve.lobes() * f64::from(i) / 48.0;
        // Far below the depth of any crossing that matters, far above the rounding of the search.
        curve.distance(curve.offset_point(a), a, PI, 720) < q * (1.0 - 1e-6)
    })
}

/// Lobes reach 2 e between the sleeves; a backlash of half of e already leaves a quarter of that unused.
fn backlash(gear: &Gear) -> Result<(), Fault> {
    let most = 0.5 * gear.eccentricity_m.min(gear.external_sleeve_radius_m);
    if gear.backlash_m > most {
        return Err(Fault::new(
            &["gear.backlash_m"],
            format!(
                "is {} m, more than half of the eccentricity or of the external sleeve radius: the lobes would hardly reach the sleeves",
                short(gear.backlash_m)
            ),
            format!(
                "give at most {} m (the paper's largest is 0.0006)",
                below(most)
            ),
        ));
    }
    Ok(())
}

/// Sleeves in their holes, holes beside each other.
///
/// Sleeves that overlap need no check of their own: each is smaller than its hole.
fn internal_sleeves(gear: &Gear) -> Result<(), Fault> {
    let (sleeve, hole) = (gear.internal_sleeve_radius_m, gear.hole_radius_m);
    let circle = gear.internal_circle_radius_m;
    if sleeve >= hole {
        return Err(Fault::new(
            &["gear.internal_sleeve_radius_m", "gear.hole_radius_m"],
            format!(
                "is {} m, larger than its hole of {} m",
                short(sleeve),
                short(hole)
            ),
            format!(
                "make the sleeve smaller or gear.hole_radius_m at least sleeve + eccentricity = {} m",
                above(sleeve + gear.eccentricity_m)
            ),
        ));
    }
    let least = sleeve + gear.eccentricity_m;
    if hole < least * (1.0 - ROUNDING) {
        return Err(Fault::new(
            &[
                "gear.hole_radius_m",
                "gear.internal_sleeve_radius_m",
                "gear.eccentricity_m",
            ],
            format!(
                "is {} m, smaller than internal sleeve + eccentricity = {} m: the wheel could not orbit",
                short(hole),
                short(least)
            ),
            format!(
                "give {} m or more (exactly that much leaves no clearance)",
                above(least)
            ),
        ));
    }
    let half_pitch = circle * (PI / gear.internal_sleeves as f64).sin();
    if hole >= half_pitch {
        return Err(Fault::new(
            &[
                "gear.hole_radius_m",
                "gear.internal_sleeves",
                "gear.internal_circle_radius_m",
            ],
            format!(
                "is {} m, so that neighbouring holes overlap: {} of them on a circle of {} m leave {} m each",
                short(hole),
                gear.internal_sleeves,
                short(circle),
                short(half_pitch)
            ),
            format!(
                "make the holes smaller than {} m, fewer, or their circle larger",
                below(half_pitch)
            ),
        ));
    }
    if hole >= circle {
        return Err(Fault::new(
            &["gear.hole_radius_m", "gear.internal_circle_radius_m"],
            format!(
                "is {} m, so that the holes on a circle of {} m reach the wheel's centre",
                short(hole),
                short(circle)
            ),
            "make the holes smaller or their circle larger",
        ));
    }
    Ok(())
}

/// Every hole must lie inside the profile: its centre farther from C than hole radius + q.
///
/// A hole that stays inside the circle through the pits is inside whatever its angle. Otherwise
/// each hole of each wheel is measured where it stands between lobe and pit.
fn holes_inside_the_wheel(gear: &Gear) -> Result<(), Fault> {
    let curve = Profile::of(gear);
    let (circle, hole) = (gear.internal_circle_radius_m, gear.hole_radius_m);
    if circle + hole < curve.pit_radius() {
        return Ok(());
    }
    let needed = hole + gear.external_sleeve_radius_m;
    let leaves = |free: f64| {
        Fault::new(
            &["gear.hole_radius_m", "gear.internal_circle_radius_m"],
            format!(
                "is {} m, so that holes on a circle of {} m leave the wheel: its edge is {} m from a hole's centre",
                short(hole),
                short(circle),
                short(free.max(0.0))
            ),
            format!(
                "make gear.hole_radius_m smaller or gear.internal_circle_radius_m at most {} m",
                below((curve.pit_radius() - hole).max(0.0))
            ),
        )
    };
    // Outside C altogether: the distance alone would not tell.
    if circle >= gear.pitch_radius_m() + gear.eccentricity_m {
        return Err(leaves(0.0));
    }
    let pitch = TAU / curve.lobes();
    for wheel in 0..gear.wheels {
        let phase = TAU * wheel as f64 / gear.wheels as f64;
        let turned = (PI - phase) / curve.lobes();
        for k in 0..gear.internal_sleeves {
            let angle = TAU * k as f64 / gear.internal_sleeves as f64 - turned;
            // All lobes are alike: only the place between two of them counts.
            let angle = angle.rem_euclid(pitch);
            let centre = [circle * angle.cos(), circle * angle.sin()];
            // The nearest part of C lies within a lobe's pitch on either side, or half a turn for very few lobes.
            let free = curve.distance(centre, angle, pitch.min(PI), 96);
            let [x, y] = curve.point(parameter_at(&curve, angle));
            if free <= needed || x.hypot(y) <= circle {
                return Err(leaves(free - gear.external_sleeve_radius_m));
            }
        }
    }
    Ok(())
}

/// The parameter a at which C(a) has the polar angle `angle`, by fixed-point iteration with half steps:
/// the polar angle grows with a at a rate between (1 - m)/(1 - m/zk) > 0 and (1 + m)/(1 + m/zk) < 2.
fn parameter_at(curve: &Profile, angle: f64) -> f64 {
    let mut a = angle;
    for _ in 0..60 {
        let [x, y] = curve.point(a);
        let error = (y.atan2(x) - angle + PI).rem_euclid(TAU) - PI;
        a -= 0.5 * error;
    }
    a
}
