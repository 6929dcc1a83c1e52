//! Quantities that follow from a scene by closed forms: sizes, curvatures, frequencies, expected loads.

use std::f64::consts::{PI, TAU};

use serde::Serialize;

use super::model::{Gear, Scene};
use super::profile::Profile;
use crate::body::bore_radius_m;
use crate::wall::hole_to_profile_m;
use crate::{load_profile, scales, speed_profile};

/// Figures that follow from a checked scene without a run. SI units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Derived {
    /// R = e zk/m, m.
    pub pitch_radius_m: f64,
    /// Number of lobes zs.
    pub lobes: usize,
    /// Input turns per output turn; both turn in opposite directions, and in the same direction in an RV gear.
    pub ratio: f64,
    /// Radius of curvature of the profile at a lobe's tip, m.
    pub tip_curvature_radius_m: f64,
    /// Radius of curvature of the profile in a pit, m; negative where the profile is concave.
    pub pit_curvature_radius_m: f64,
    /// Smallest convex radius of the pin centre's path, m; a larger pin undercuts the disc.
    pub smallest_convex_radius_m: f64,
    /// Largest and smallest distance of the profile from the disc centre, m.
    pub profile_radii_m: [f64; 2],
    /// Thickness of the material between holes, profile and pins.
    pub walls: Walls,
    /// Clearance of a pin in its hole beyond the orbit: hole - pin - e, m.
    pub hole_clearance_m: f64,
    /// Free rotation of a disc to one side by backlash and modification, rad ([`scales::free_play`]).
    pub free_play_rad: f64,
    /// Driver torque without losses: load/ratio, N m; of a changing load the final one.
    pub ideal_input_torque_n_m: f64,
    /// Largest force of a ring pin on a disc, rigid and without clearance, N:
    /// about 4 T/(e zs zk) with T the largest load on one disc.
    pub external_force_estimate_n: f64,
    /// Largest force of an output pin on a disc, rigid and without clearance, N: 4 T/(zi Rw).
    pub internal_force_estimate_n: f64,
    /// Frequencies at which results may oscillate.
    pub frequencies: Vec<Frequency>,
    /// True if the ripples of the discs' mesh at the ring pins are in phase.
    pub external_ripple_in_phase: bool,
    /// True if the ripples of the discs at the output pins are in phase.
    pub internal_ripple_in_phase: bool,
}

/// Least wall thicknesses, m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Walls {
    /// Wall of a disc, between a hole and the profile.
    pub hole_to_profile_m: f64,
    /// Wall of a disc, between neighbouring holes.
    pub hole_to_hole_m: f64,
    /// Wall of a disc, between a hole and the bore assumed for masses: 0.6 (circle - hole).
    pub hole_to_bore_m: f64,
    /// Gap between neighbouring ring pins.
    pub sleeve_to_sleeve_m: f64,
}

impl Walls {
    fn of(gear: &Gear) -> Self {
        let apart = |circle: f64, count: usize, radius: f64| {
            2.0 * (circle * (PI / count as f64).sin() - radius)
        };
        let (circle, hole) = (gear.internal_circle_radius_m, gear.hole_radius_m);
        Self {
            hole_to_profile_m: hole_to_profile_m(gear),
            hole_to_hole_m: apart(circle, gear.internal_sleeves, hole),
            hole_to_bore_m: circle - hole - bore_radius_m(gear),
            sleeve_to_sleeve_m: apart(
                gear.pitch_radius_m() + gear.backlash_m,
                gear.external_sleeves,
                gear.external_sleeve_radius_m,
            ),
        }
    }
}

/// Figure of [`Derived`] with its name, for tables.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Line {
    /// Name of the quantity.
    pub what: &'static str,
    /// Value in SI units.
    pub value: f64,
    /// `m`, `rad`, `N m`, `N`; empty for the ratio.
    pub unit: &'static str,
    /// Formula or meaning of the figure.
    pub how: &'static str,
}

/// Predicted frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Frequency {
    /// Event that repeats with the frequency.
    pub what: &'static str,
    /// Multiple of the input frequency.
    pub order: f64,
    /// Frequency, Hz.
    pub hertz: f64,
}

impl Derived {
    /// Returns quantities that follow from the dimensions and the load, in reading order, for the `scene` of these figures.
    pub fn lines(&self, scene: &Scene) -> Vec<Line> {
        macro_rules! lines {
            ($($what:literal $value:expr, $unit:literal, $how:expr;)*) => {
                vec![$(Line { what: $what, value: $value, unit: $unit, how: $how }),*]
            };
        }
        let expected = if scene.drive.load_changes.is_empty() {
            "load/ratio, if the contacts neither lose nor create energy"
        } else {
            "the last load/ratio, if the contacts neither lose nor create energy"
        };
        let direction = match scene.cranks {
            Some(_) if scene.ring_turns() => "zk planet/sun: the ring turns against the input",
            None if scene.ring_turns() => "zk: the ring turns with the input",
            Some(_) => "1 + zk planet/sun: the output turns with the input",
            None => "the output turns against the input",
        };
        let circle = self.pitch_radius_m + scene.gear.backlash_m;
        let [tips, pits] = self.profile_radii_m;
        let walls = self.walls;
        let mut lines = lines! {
            "ratio" self.ratio, "", direction;
            "circle of the ring pins" circle, "m", "R + d, R = e zk/m";
            "profile from" pits, "m", "pits";
            "profile to" tips, "m", "lobe tips";
            "radius of curvature, lobe tip" self.tip_curvature_radius_m, "m", "";
            "radius of curvature, pit" self.pit_curvature_radius_m, "m", "negative: concave";
            "largest ring pin" self.smallest_convex_radius_m, "m", "a larger one undercuts the disc";
            "clearance in the holes" self.hole_clearance_m, "m", "hole - pin - eccentricity";
            "wall, hole to profile" walls.hole_to_profile_m, "m", "thinnest place of all holes";
            "wall, hole to hole" walls.hole_to_hole_m, "m", "";
            "gap, ring pins" walls.sleeve_to_sleeve_m, "m", "between neighbours";
            "free play to one side" self.free_play_rad, "rad", "d sqrt(1 - m^2)/(e zs), at the disc";
            "driver torque, ideal" self.ideal_input_torque_n_m, "N m", expected;
            "largest ring pin force" self.external_force_estimate_n, "N", "a disc, springs all alike, without clearance: 4 T/(e zs zk); the contact law and play move it, see `pinwheel design`";
            "largest output pin force" self.internal_force_estimate_n, "N", "a disc, likewise: 4 T/(zi Rw)";
        };
        if scene.cranks.is_some() {
            let of_sleeves = ["clearance in the holes", "largest output pin force"];
            lines.retain(|line| !of_sleeves.contains(&line.what));
        }
        lines
    }
}

/// Returns hole - pin - e, m; 0 for a rounding error.
fn hole_clearance(gear: &Gear) -> f64 {
    let clearance = gear.hole_radius_m - gear.internal_sleeve_radius_m - gear.eccentricity_m;
    if clearance.abs() < 1e-12 * gear.hole_radius_m {
        0.0
    } else {
        clearance
    }
}

/// Derives the closed-form figures of a scene that passed [`Scene::check`].
pub fn derived(scene: &Scene) -> Derived {
    let gear = &scene.gear;
    let curve = Profile::of(gear);
    let (q, [pit, tip]) = (gear.edge_offset_m(), curve.radii());
    let (zk, zs) = (gear.external_sleeves as f64, gear.lobes() as f64);
    let turning = scene.eccentric_per_input().abs();
    let zi = gear.internal_sleeves as f64;
    let wheel_torque = scene.largest_disc_load_n_m();
    let input_hertz = speed_profile::final_rad_s(scene).abs() / TAU;
    let frequency = |what, order: f64| Frequency {
        what,
        order,
        hertz: order * input_hertz,
    };
    let mut frequencies = vec![frequency("input shaft turns", 1.0)];
    match scene.cranks {
        Some(_) => frequencies.push(frequency("cranks turn", turning)),
        None => frequencies.extend([
            frequency("a given output pin is loaded", zk / zs),
            frequency("a disc passes from output pin to output pin", zi * zk / zs),
        ]),
    }
    frequencies.push(frequency(
        "a disc passes from ring pin to ring pin",
        zk * turning,
    ));
    Derived {
        pitch_radius_m: gear.pitch_radius_m(),
        lobes: gear.lobes(),
        ratio: scene.ratio(),
        tip_curvature_radius_m: 1.0 / curve.curvature(1.0) - q,
        pit_curvature_radius_m: 1.0 / curve.curvature(-1.0) - q,
        smallest_convex_radius_m: curve.smallest_convex_radius(),
        profile_radii_m: [tip, pit],
        walls: Walls::of(gear),
        hole_clearance_m: hole_clearance(gear),
        free_play_rad: scales::free_play(gear),
        ideal_input_torque_n_m: -load_profile::final_load(scene) * scene.output_per_input(),
        external_force_estimate_n: scales::external_force(gear, wheel_torque),
        internal_force_estimate_n: scales::internal_force(gear, wheel_torque),
        frequencies,
        // Disc i is the first disc 2 pi i/n of input later; a ripple of order p per turn is in phase if p i/n is an integer
        // for every i.
        external_ripple_in_phase: gear.external_sleeves.is_multiple_of(gear.wheels),
        internal_ripple_in_phase: gear.internal_sleeves.is_multiple_of(gear.wheels),
    }
}
