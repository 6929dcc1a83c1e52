//! Wall between a disc's holes and its edge.

use std::cell::RefCell;
use std::f64::consts::{PI, TAU};

use crate::model::Gear;
use crate::profile::Profile;

thread_local! {
    /// Last gear measured, with its wall: parameters of a law are requested several times in a row.
    static LAST: RefCell<Option<(Gear, f64)>> = const { RefCell::new(None) };
}

/// Returns the smallest wall between a hole and the disc's edge, m; negative if a hole leaves the disc.
pub(crate) fn hole_to_profile_m(gear: &Gear) -> f64 {
    LAST.with_borrow_mut(|last| match last {
        Some((known, wall)) if known == gear => *wall,
        _ => last.insert((gear.clone(), measured_m(gear))).1,
    })
}

/// Measures each hole of each disc at its position relative to lobes and pits.
fn measured_m(gear: &Gear) -> f64 {
    let curve = Profile::of(gear);
    let (circle, hole) = (gear.internal_circle_radius_m, gear.hole_radius_m);
    // Outside C, which the distance alone does not show.
    if circle >= gear.generating_radius_m() + gear.eccentricity_m {
        return -hole;
    }
    let pitch = TAU / curve.lobes();
    let mut least = f64::INFINITY;
    for wheel in 0..gear.wheels {
        let phase = TAU * wheel as f64 / gear.wheels as f64;
        let turned = (PI - phase) / curve.lobes();
        for k in 0..gear.internal_sleeves {
            let nominal = TAU * k as f64 / gear.internal_sleeves as f64;
            let angle = nominal - turned;
            // All lobes are equal, so only the position between two lobes counts.
            let angle = angle.rem_euclid(pitch);
            let needed = gear.hole_radius_of_m(wheel, k) + gear.edge_offset_m();
            // The distance to the common part of two turned discs is that to the nearer edge.
            for flank in flanks(gear) {
                let centre = gear.hole_m(wheel, k, angle + flank - nominal);
                // The nearest part of C lies within a lobe's pitch on either side, or half a turn for very few lobes.
                let free = curve.distance(centre, angle, pitch.min(PI), 96);
                let [x, y] = curve.point(parameter_at(&curve, angle));
                if x.hypot(y) <= circle {
                    return -hole;
                }
                least = least.min(free - needed);
            }
        }
    }
    least
}

/// Returns the rotations of the turned discs whose common part is the modified disc, rad.
fn flanks(gear: &Gear) -> impl Iterator<Item = f64> {
    let turn = gear.modification.rotational_rad;
    [turn, -turn]
        .into_iter()
        .take(if turn == 0.0 { 1 } else { 2 })
}

/// Returns the parameter a of C(a) with the polar angle `angle`, by fixed-point iteration with half steps: the polar angle
/// grows with a at a rate between (1 - m)/(1 - m/zk) > 0 and (1 + m)/(1 + m/zk) < 2.
fn parameter_at(curve: &Profile, angle: f64) -> f64 {
    let mut a = angle;
    for _ in 0..60 {
        let [x, y] = curve.point(a);
        let error = (y.atan2(x) - angle + PI).rem_euclid(TAU) - PI;
        a -= 0.5 * error;
    }
    a
}
