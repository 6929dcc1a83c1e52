//! Balances over one period of the mesh, and their evaluation.

use std::f64::consts::{PI, TAU};

use pinwheel_gearbox::contacts::PairContact;
use pinwheel_gearbox::pressure::LinePressure;
use pinwheel_gearbox::statics::{Equilibrium, Statics};
use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_scene::Sleeve;
use serde::Serialize;

use super::orders::ForceHarmonic;
use super::spread::Spread;

/// Number of places on each side of the eccentric for the load sharing.
const PLACES: usize = 180;

/// Kind of pins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// Ring pins.
    External,
    /// Output pins.
    Internal,
}

impl Stage {
    /// Both kinds, external first.
    pub const BOTH: [Self; 2] = [Self::External, Self::Internal];

    fn has(self, sleeve: Sleeve) -> bool {
        matches!(
            (self, sleeve),
            (Self::External, Sleeve::External(_)) | (Self::Internal, Sleeve::Internal(_))
        )
    }
}

/// Touching pair of a balance; in an RV gear a crank's bearing replaces an output pin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Disc.
    pub wheel: usize,
    /// Pin.
    pub sleeve: Sleeve,
    /// Angle of the pin from the disc's eccentric about the gear's axis, -pi to pi, rad.
    pub place_rad: f64,
    /// Normal force F_n, N.
    pub force_n: f64,
    /// Penetration, m.
    pub penetration_m: f64,
    /// Pressure p0 of the line contact, Pa.
    pub pressure_pa: f64,
    /// Sliding speed of the disc on a pin that does not turn, m/s.
    pub sliding_m_s: f64,
}

/// Largest loads on one kind of pins at a balance.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Largest {
    /// Number of touching pairs.
    pub(crate) touching: u32,
    pub(crate) force_n: f64,
    pub(crate) penetration_m: f64,
    pub(crate) pressure_pa: f64,
    pub(crate) pressure_sliding_w_m2: f64,
}

impl Largest {
    /// Returns the larger loads of two poses, with another number of pairs.
    pub(super) fn or_larger(&self, other: &Self, touching: u32) -> Self {
        Self {
            touching,
            force_n: self.force_n.max(other.force_n),
            penetration_m: self.penetration_m.max(other.penetration_m),
            pressure_pa: self.pressure_pa.max(other.pressure_pa),
            pressure_sliding_w_m2: self.pressure_sliding_w_m2.max(other.pressure_sliding_w_m2),
        }
    }

    fn add(&mut self, pair: &Pair) {
        self.touching += 1;
        self.force_n = self.force_n.max(pair.force_n);
        self.penetration_m = self.penetration_m.max(pair.penetration_m);
        self.pressure_pa = self.pressure_pa.max(pair.pressure_pa);
        let product = pair.pressure_pa * pair.sliding_m_s;
        self.pressure_sliding_w_m2 = self.pressure_sliding_w_m2.max(product);
    }
}

/// Results of a balance.
pub(crate) struct Pose {
    /// Output angle less that of the ideal mesh, rad.
    pub(crate) error_rad: f64,
    /// Largest loads on ring pins and on output pins or cranks.
    pub(crate) largest: [Largest; 2],
    /// Touching pairs, and the force of the contacts on every disc, N: away from the input's axis, and counter-clockwise
    /// about it. Both are empty if only largest forces are requested.
    pub(crate) pairs: Vec<Pair>,
    pub(crate) bearings: Vec<[f64; 2]>,
    /// Force on the bearing that carries most, N.
    pub(crate) bearing_n: f64,
    /// Driver torque in slow motion, N m; `None` without friction, or without a balance with friction.
    pub(crate) driver_n_m: Option<f64>,
}

/// Requested loads of a balance.
#[derive(Clone, Copy)]
pub(crate) enum Wanted<'a> {
    Nothing,
    Forces,
    /// All data of every pair.
    Pairs(&'a LinePressure),
}

/// Eccentric of a disc at a pose.
struct Eccentric {
    angle: f64,
    sine: f64,
    cosine: f64,
}

impl Pose {
    /// Solves a pose. `near` is the balance under the same load at the previous pose, if any; on return it is the balance of
    /// this pose.
    pub(crate) fn find(
        statics: &mut Statics<'_>,
        wanted: Wanted<'_>,
        phi: f64,
        load: f64,
        near: &mut Option<Equilibrium>,
    ) -> Result<Self, GearboxError> {
        let balance = statics.track(near, phi, load)?;
        Ok(Self::loaded(statics, wanted, balance, load))
    }

    /// Returns the loads of a balance.
    pub(super) fn loaded(
        statics: &mut Statics<'_>,
        wanted: Wanted<'_>,
        balance: &Equilibrium,
        load: f64,
    ) -> Self {
        let gearbox = statics.gearbox();
        let phi = balance.input;
        let (touching, cranks) = match wanted {
            Wanted::Nothing => Default::default(),
            _ => (statics.touching(balance), statics.on_cranks(balance)),
        };
        let pressure = match wanted {
            Wanted::Pairs(pressure) => Some(pressure),
            _ => None,
        };
        let turned = gearbox.geometry.eccentric_angle(phi, balance.output);
        let eccentric = |phase: &f64| {
            let angle = turned + phase;
            let (sine, cosine) = angle.sin_cos();
            Eccentric {
                angle,
                sine,
                cosine,
            }
        };
        let eccentrics = gearbox.geometry.wheel_phases.iter().map(eccentric);
        let eccentrics: Vec<Eccentric> = eccentrics.collect();
        let mut pose = Self {
            error_rad: balance.output + gearbox.flange_twist_rad(load)
                - gearbox.geometry.ideal_output_angle(phi),
            largest: Default::default(),
            pairs: Vec::new(),
            bearings: Vec::new(),
            bearing_n: 0.0,
            driver_n_m: None,
        };
        if pressure.is_some() {
            pose.pairs.reserve(touching.len() + cranks.len());
            pose.bearings.resize(eccentrics.len(), [0.0; 2]);
        }
        for contact in &touching {
            let mut pair = Pair::loaded(contact);
            if let Some(pressure) = pressure {
                let eccentric = &eccentrics[contact.wheel];
                let disc = balance.bodies[gearbox.layout.wheel_bodies().start + contact.wheel];
                let centre = [disc.x, disc.y];
                pair.pressure_pa = pressure.of(&gearbox.geometry, contact, centre, disc.angle);
                pair.sliding_m_s = sliding_m_s(gearbox, eccentric, contact);
                let [fx, fy] = contact.force_on_sleeve();
                let sum = &mut pose.bearings[contact.wheel];
                sum[0] -= fx * eccentric.cosine + fy * eccentric.sine;
                sum[1] -= fy * eccentric.cosine - fx * eccentric.sine;
            }
            pose.add(pair, contact, pressure.map(|_| &eccentrics));
        }
        for contact in &cranks {
            let pair = Pair::loaded(contact);
            pose.add(pair, contact, pressure.map(|_| &eccentrics));
        }
        let sizes = pose.bearings.iter().map(|[r, t]| r.hypot(*t));
        pose.bearing_n = sizes.fold(0.0, f64::max);
        pose
    }

    /// Adds a pair, and stores it with its place if eccentrics are given.
    fn add(&mut self, mut pair: Pair, contact: &PairContact, from: Option<&Vec<Eccentric>>) {
        let stage = usize::from(Stage::Internal.has(pair.sleeve));
        self.largest[stage].add(&pair);
        if let Some(eccentrics) = from {
            let [x, y] = contact.centre;
            pair.place_rad = from_eccentric(y.atan2(x), eccentrics[contact.wheel].angle);
            self.pairs.push(pair);
        }
    }

    /// Returns the number of touching pairs of a disc.
    pub(crate) fn touching(&self, stage: Stage) -> f64 {
        f64::from(self.largest[stage as usize].touching) / self.bearings.len() as f64
    }

    pub(crate) fn of(&self, stage: Stage) -> impl Iterator<Item = &Pair> {
        self.pairs.iter().filter(move |pair| stage.has(pair.sleeve))
    }
}

impl Pair {
    /// Returns a contact with its force alone.
    fn loaded(contact: &PairContact) -> Self {
        Self {
            wheel: contact.wheel,
            sleeve: contact.sleeve,
            place_rad: 0.0,
            force_n: contact.normal_force_n,
            penetration_m: contact.penetration_m,
            pressure_pa: 0.0,
            sliding_m_s: 0.0,
        }
    }
}

/// Returns an angle about the gear's axis from an eccentric's, -pi to pi.
fn from_eccentric(angle: f64, eccentric: f64) -> f64 {
    (angle - eccentric + PI).rem_euclid(TAU) - PI
}

/// Returns the sliding speed of a disc on a pin that does not turn, m/s.
fn sliding_m_s(gearbox: &Gearbox, eccentric: &Eccentric, contact: &PairContact) -> f64 {
    let geometry = &gearbox.geometry;
    // Velocity of the disc at W: about its centre at -omega/zs, and with it along the eccentric's circle.
    let omega = gearbox.scene.eccentric_speed_rad_s();
    let rate = -omega / geometry.lobes();
    let (s, c) = (eccentric.sine, eccentric.cosine);
    let e = geometry.eccentricities_m[contact.wheel];
    let [wx, wy] = contact.point;
    let mut velocity = [
        -omega * e * s - rate * (wy - e * s),
        omega * e * c + rate * (wx - e * c),
    ];
    if let Sleeve::Internal(_) = contact.sleeve {
        velocity[0] += rate * wy;
        velocity[1] -= rate * wx;
    }
    let [nx, ny] = contact.normal;
    (velocity[1] * nx - velocity[0] * ny).abs()
}

/// Load sharing among the pins.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sharing {
    /// Kind of pins.
    pub stage: Stage,
    /// Largest force of a pair in a pose, N.
    pub largest_force_n: Spread,
    /// Number of touching pairs of a disc.
    pub touching: Spread,
    /// Angles from the eccentric, degrees: -180 to 180.
    pub place_deg: Vec<f64>,
    /// Largest force of a pair at that angle, N; 0 without contact.
    pub force_n: Vec<f64>,
}

impl Sharing {
    pub(crate) fn of(poses: &[Pose], stage: Stage) -> Self {
        let mut force = vec![0.0_f64; 2 * PLACES];
        for pair in poses.iter().flat_map(|pose| pose.of(stage)) {
            let place = ((pair.place_rad / PI + 1.0) * PLACES as f64) as usize;
            let place = &mut force[place.min(2 * PLACES - 1)];
            *place = place.max(pair.force_n);
        }
        let place = |k: usize| 180.0 * ((k as f64 + 0.5) / PLACES as f64 - 1.0);
        Self {
            stage,
            largest_force_n: Spread::of(
                poses
                    .iter()
                    .map(|pose| pose.largest[stage as usize].force_n),
            ),
            touching: Spread::of(poses.iter().map(|pose| pose.touching(stage))),
            place_deg: (0..2 * PLACES).map(place).collect(),
            force_n: force,
        }
    }
}

/// Pressure and sliding over the poses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pressure {
    /// Kind of pins.
    pub stage: Stage,
    /// Largest p0, Pa.
    pub largest_pa: f64,
    /// Angle of the largest pressure from the eccentric, degrees.
    pub largest_at_deg: f64,
    /// Largest sliding speed of a loaded pair on a pin that does not turn, m/s.
    pub sliding_m_s: f64,
    /// Largest product of both in one pair, W/m^2.
    pub pressure_sliding_w_m2: f64,
}

impl Pressure {
    pub(crate) fn of(poses: &[Pose], stage: Stage) -> Self {
        let mut worst = Self {
            stage,
            largest_pa: 0.0,
            largest_at_deg: 0.0,
            sliding_m_s: 0.0,
            pressure_sliding_w_m2: 0.0,
        };
        for pair in poses.iter().flat_map(|pose| pose.of(stage)) {
            if pair.pressure_pa > worst.largest_pa {
                worst.largest_pa = pair.pressure_pa;
                worst.largest_at_deg = pair.place_rad.to_degrees();
            }
            worst.sliding_m_s = worst.sliding_m_s.max(pair.sliding_m_s);
            let product = pair.pressure_pa * pair.sliding_m_s;
            worst.pressure_sliding_w_m2 = worst.pressure_sliding_w_m2.max(product);
        }
        worst
    }
}

/// Force of the contacts on a disc, which its bearing on the eccentric carries.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bearing {
    /// Disc.
    pub wheel: usize,
    /// Magnitude of the force, N.
    pub force_n: Spread,
    /// Component away from the input's axis, N, over the period.
    pub radial_n: Vec<f64>,
    /// Component counter-clockwise about the input's axis, N, over the period: times e, the torque of this disc.
    pub tangential_n: Vec<f64>,
    /// Largest harmonics of the radial component, largest first.
    pub radial_harmonics: Vec<ForceHarmonic>,
}

impl Bearing {
    /// Returns the magnitude of the force over the period, N.
    pub(crate) fn forces_n(&self) -> impl Iterator<Item = f64> {
        (self.radial_n.iter().zip(&self.tangential_n)).map(|(r, t)| r.hypot(*t))
    }
}

impl Bearing {
    pub(crate) fn all(poses: &[&Pose]) -> Vec<Self> {
        let wheels = poses.first().map_or(0, |pose| pose.bearings.len());
        let part = |wheel: usize, part: usize| {
            let forces = poses.iter().map(move |pose| pose.bearings[wheel][part]);
            forces.collect::<Vec<f64>>()
        };
        let size = |[radial, tangential]: [f64; 2]| radial.hypot(tangential);
        let bearing = |wheel: usize| Self {
            wheel,
            force_n: Spread::of(poses.iter().map(|pose| size(pose.bearings[wheel]))),
            radial_n: part(wheel, 0),
            tangential_n: part(wheel, 1),
            radial_harmonics: Vec::new(),
        };
        (0..wheels).map(bearing).collect()
    }
}
