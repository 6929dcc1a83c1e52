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
    let mut least = f64::INFINITY;
    for wheel in 0..gear.wheels {
        let phase = TAU * wheel as f64 / gear.wheels as f64;
        let turned = (PI - phase) / curve.lobes();
        for k in 0..gear.internal_sleeves {
            let needed = gear.hole_radius_of_m(wheel, k) + gear.edge_offset_m();
            // The distance to the common part of two turned discs is that to the nearer edge.
            for flank in flanks(gear) {
                let outside = curve.distance(gear.hole_m(wheel, k, flank - turned));
                if outside >= 0.0 {
                    return -gear.hole_radius_m;
                }
                least = least.min(-outside - needed);
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
