//! Geometry of the gear: positions of its parts at the ideal mesh.
//!
//! Disc i of n has its centre at `e e^{i f}`, `f = a + 2 pi i/n`. The angle a of the eccentrics is the input's, except in RV
//! gears ([`Geometry::eccentric_angle`]). The disc meshes exactly at the angle `(pi - f)/zs`. Ring pin j is at `(R + d) e^{2 pi
//! i j/zk}`, output pin k at `R_w e^{i (psi + 2 pi k/zi)}` with the output angle psi. Hole k of every disc surrounds output pin
//! k at t = 0, with its centre at `R_w` from the disc's. Errors of the parts displace them from these positions; a disc's edge
//! is that of its modified profile.

use std::f64::consts::{PI, TAU};

use pinwheel_contact::{Complex, Epitrochoid};
use pinwheel_faults::{Fault, armed};
use pinwheel_mbs::BodyState;
use pinwheel_scene::{largest_hole_play, largest_play};

use crate::GearboxError;
use crate::scene::{Gear, Scene};

/// Derived geometry; disc-frame points are relative to the disc's centre.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Path C of the generating pin's centre; without modification, pin centres are on it.
    pub curve: Epitrochoid,
    /// Distance q' of a disc's edge inside C, m.
    pub edge_offset_m: f64,
    /// Factor e^{i delta} of a rotational modification: the disc is the intersection of two discs rotated by +-delta.
    pub flanks: Option<Complex>,
    /// Nominal directions e^{2 pi i j/zk} of the ring pins, without their errors.
    pub external_directions: Vec<Complex>,
    /// Pin positions on the housing, m.
    pub external_points: Vec<[f64; 2]>,
    /// Radii of the ring pins, m.
    pub external_radii_m: Vec<f64>,
    /// Pin positions on the output shaft, shaft frame, m.
    pub internal_points: Vec<[f64; 2]>,
    /// Radii of the output pins, m.
    pub internal_radii_m: Vec<f64>,
    /// Angles of the eccentrics from the input's, 2 pi i/n, rad.
    pub wheel_phases: Vec<f64>,
    /// Eccentricities of the eccentrics, m.
    pub eccentricities_m: Vec<f64>,
    /// Phase error of each crank of an RV gear, rad; empty for other gears.
    pub crank_phases: Vec<f64>,
    /// Hole centres of every disc, disc frame, m.
    pub hole_centres: Vec<Vec<Complex>>,
    /// Radii of the holes of every disc, m.
    pub hole_radii_m: Vec<Vec<f64>>,
    /// Ratio rho of an RV gear's first stage, teeth of the sun over a planet's; 0 where the input carries the eccentrics.
    pub teeth_ratio: f64,
    /// Largest free rotation of a disc, rad.
    pub wheel_play_rad: f64,
    /// Largest free rotation of the output in its holes, rad.
    pub hole_play_rad: f64,
    lobes: f64,
    /// Ratio of the eccentrics' speed to the input's at the ideal mesh.
    eccentric_per_input: f64,
    /// Turn of the eccentrics against the ring per turn of the input, and per turn of the carrier against the ring while the
    /// input is locked.
    eccentric_per_turn: [f64; 2],
    /// Turn of the input against the ring per turn of the carrier against the ring while the input is locked: 1 if the ring is the
    /// output, else 0.
    pub(crate) input_per_carrier: f64,
}

impl Geometry {
    /// Computes the geometry of a checked scene.
    ///
    /// # Errors
    /// Parameters without a curve.
    pub fn new(scene: &Scene) -> Result<Self, GearboxError> {
        Self::after(None, scene)
    }

    /// Computes the geometry of a checked scene, and reuses the curve of an equal `earlier` one. Most of the cost is in the
    /// curve's reaches.
    pub(crate) fn after(earlier: Option<&Self>, scene: &Scene) -> Result<Self, GearboxError> {
        let gear = &scene.gear;
        let sleeves = u32::try_from(gear.external_sleeves).unwrap_or(u32::MAX);
        let (eccentricity, shortening) = (gear.eccentricity_m, gear.generating_shortening());
        let known = earlier.map(|earlier| &earlier.curve);
        let offset = gear.modification.normal_m.of_lobe();
        let is_same =
            |curve: &&Epitrochoid| curve.is_of(eccentricity, sleeves, shortening, offset.as_ref());
        let curve = match known.filter(is_same) {
            Some(curve) => curve.clone(),
            None => Epitrochoid::with_offset(eccentricity, sleeves, shortening, offset)
                .ok_or_else(|| {
                    let what =
                        "no epitrochoid has this eccentricity, shortening and number of ring pins";
                    GearboxError::Geometry(what.to_owned())
                })?,
        };
        let (wheels, external, internal) =
            (gear.wheels, gear.external_sleeves, gear.internal_sleeves);
        let lobes = gear.external_sleeves as f64 - 1.0;
        // Holes are centred on the pins' positions for eccentrics without errors.
        let start = |i: usize| (PI - TAU * i as f64 / wheels as f64) / lobes;
        let mut wheel_phases: Vec<f64> = (0..wheels).map(|i| gear.phase_of_rad(i)).collect();
        if let (true, Some(last)) = (armed(Fault::WheelPhase), wheel_phases.last_mut()) {
            *last += 1e-4;
        }
        let direction = |j: usize| Complex::unit(TAU * j as f64 / external as f64);
        let turn = gear.modification.rotational_rad;
        Ok(Self {
            curve,
            edge_offset_m: gear.edge_offset_m(),
            flanks: (turn > 0.0).then(|| Complex::unit(turn)),
            external_directions: (0..external).map(direction).collect(),
            external_points: (0..external).map(|j| gear.external_sleeve_m(j)).collect(),
            external_radii_m: (0..external)
                .map(|j| gear.external_sleeve_radius_of_m(j))
                .collect(),
            internal_points: (0..internal).map(|k| gear.internal_sleeve_m(k)).collect(),
            internal_radii_m: (0..internal)
                .map(|k| gear.internal_sleeve_radius_of_m(k))
                .collect(),
            crank_phases: match scene.cranks {
                Some(_) => (0..internal).map(|k| gear.crank_phase_of_rad(k)).collect(),
                None => Vec::new(),
            },
            teeth_ratio: scene.cranks.map_or(0.0, |cranks| cranks.teeth_ratio()),
            wheel_phases,
            eccentricities_m: (0..wheels).map(|i| gear.eccentricity_of_m(i)).collect(),
            hole_centres: (0..wheels)
                .map(|i| {
                    let centre = |k| {
                        let [x, y] = gear.hole_m(i, k, -start(i));
                        Complex::new(x, y)
                    };
                    (0..internal).map(centre).collect()
                })
                .collect(),
            hole_radii_m: (0..wheels)
                .map(|i| (0..internal).map(|k| gear.hole_radius_of_m(i, k)).collect())
                .collect(),
            wheel_play_rad: largest_play(gear),
            hole_play_rad: largest_hole_play(gear),
            lobes,
            eccentric_per_input: scene.eccentric_per_input(),
            eccentric_per_turn: [
                scene.eccentric_per_held_carrier(),
                match scene.cranks {
                    _ if scene.ring_turns() => 1.0,
                    cranks => cranks.map_or(0.0, |cranks| 1.0 + cranks.teeth_ratio()),
                },
            ],
            input_per_carrier: f64::from(u8::from(scene.ring_turns())),
        })
    }

    /// Returns the geometry of a gear whose output has neither pins nor holes.
    pub(crate) fn without_internal_sleeves(&self) -> Self {
        Self {
            internal_points: Vec::new(),
            internal_radii_m: Vec::new(),
            hole_centres: vec![Vec::new(); self.hole_centres.len()],
            hole_radii_m: vec![Vec::new(); self.hole_radii_m.len()],
            ..self.clone()
        }
    }

    /// True if all pins are equal, all holes are equal, and no pin is larger than the tool radius of the profile, as the lanes
    /// assume.
    pub(crate) fn is_uniform(&self, gear: &Gear) -> bool {
        let alike = |all: &[f64], nominal: f64| all.iter().all(|&one| one == nominal);
        let mut holes = self.hole_radii_m.iter();
        gear.is_plain()
            && gear.external_sleeve_radius_m <= self.edge_offset_m
            && alike(&self.external_radii_m, gear.external_sleeve_radius_m)
            && alike(&self.internal_radii_m, gear.internal_sleeve_radius_m)
            && holes.all(|wheel| alike(wheel, gear.hole_radius_m))
    }

    /// Returns the angle of the eccentrics against the ring from those of the input and of the carrier against the ring, rad; rates
    /// likewise. In an RV gear it is (1 + rho) carrier - rho input, and less the input's turn against a ring that is the output.
    pub fn eccentric_angle(&self, input: f64, carrier: f64) -> f64 {
        let [per_input, per_carrier] = self.eccentric_per_turn;
        per_carrier * carrier + per_input * input
    }

    /// Returns the turn of the eccentrics per turn of the carrier, both against the ring, while the input is locked.
    pub(crate) fn eccentric_per_carrier(&self) -> f64 {
        self.eccentric_per_turn[1]
    }

    /// Returns the angle of the eccentrics against the ring from that of the input at the ideal mesh, rad.
    pub fn ideal_eccentric_angle(&self, input: f64) -> f64 {
        self.eccentric_per_input * input
    }

    /// Returns the state of disc `i` on its eccentric; `eccentric` and `own` are angle and rate of eccentric and disc (rad,
    /// rad/s).
    pub(crate) fn wheel_state(&self, i: usize, eccentric: [f64; 2], own: [f64; 2]) -> BodyState {
        let ([turned, speed], [angle, rate]) = (eccentric, own);
        let (s, c) = (turned + self.wheel_phases[i]).sin_cos();
        let e = self.eccentricities_m[i];
        BodyState::new([e * c, e * s, angle], [-speed * e * s, speed * e * c, rate])
    }

    /// Returns the state of output pin `k`, which turns with the output at its angle and rate (rad, rad/s).
    pub(crate) fn internal_state(&self, k: usize, [psi, rate]: [f64; 2]) -> BodyState {
        let (s, c) = psi.sin_cos();
        let [px, py] = self.internal_points[k];
        let (x, y) = (c * px - s * py, s * px + c * py);
        BodyState::new([x, y, psi], [-rate * y, rate * x, rate])
    }

    /// Returns the angle of disc `i` at the ideal mesh, for the input angle `phi`, rad.
    pub fn ideal_wheel_angle(&self, i: usize, phi: f64) -> f64 {
        (PI - self.ideal_eccentric_angle(phi) - self.wheel_phases[i]) / self.lobes
    }

    /// Returns the angle of the carrier against the ring at the ideal mesh, for the input angle `phi`, rad: that of the output, or
    /// its negative if the ring is the output ([`ideal_turn_of_output`](Self::ideal_turn_of_output)).
    pub fn ideal_output_angle(&self, phi: f64) -> f64 {
        -self.ideal_eccentric_angle(phi) / self.lobes
    }

    /// Returns the angle of the output at the ideal mesh, for the input angle `phi`, rad.
    pub fn ideal_turn_of_output(&self, phi: f64) -> f64 {
        let carrier = self.ideal_output_angle(phi);
        if self.ring_turns() { -carrier } else { carrier }
    }

    /// True if the ring is the output.
    pub(crate) fn ring_turns(&self) -> bool {
        self.input_per_carrier != 0.0
    }

    /// Returns zs, the number of lobes of a disc: their pitch is 2 pi/zs.
    pub fn lobes(&self) -> f64 {
        self.lobes
    }
}
