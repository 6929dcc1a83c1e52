//! Balances over one period of the mesh, and what is read off them.

use std::f64::consts::{PI, TAU};

use pinwheel_gearbox::contacts::PairContact;
use pinwheel_gearbox::pressure::LinePressure;
use pinwheel_gearbox::statics::{Equilibrium, Statics};
use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_scene::Sleeve;
use serde::Serialize;

use super::orders::ForceHarmonic;
use super::spread::Spread;

/// Places around the eccentric at which the sharing is kept, of each side of it.
const PLACES: usize = 180;

/// Which pins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// On the housing.
    External,
    /// On the output.
    Internal,
}

impl Stage {
    /// Both, external first.
    pub const BOTH: [Self; 2] = [Self::External, Self::Internal];

    fn has(self, sleeve: Sleeve) -> bool {
        matches!(
            (self, sleeve),
            (Self::External, Sleeve::External(_)) | (Self::Internal, Sleeve::Internal(_))
        )
    }
}

/// A touching pair of a balance; of an RV gear a crank's bearing stands for that of an output pin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Disc.
    pub wheel: usize,
    /// Pin.
    pub sleeve: Sleeve,
    /// Where the pin stands from the disc's eccentric about the gear's axis, -pi to pi, rad.
    pub place_rad: f64,
    /// F_n, N.
    pub force_n: f64,
    /// How deep it is pressed in, m.
    pub penetration_m: f64,
    /// p0 of the line contact, Pa.
    pub pressure_pa: f64,
    /// Sliding speed of the disc on a pin that does not turn, m/s.
    pub sliding_m_s: f64,
}

/// A balance.
pub(crate) struct Pose {
    /// Output angle less the ideal mesh's, rad.
    pub(crate) error_rad: f64,
    pub(crate) pairs: Vec<Pair>,
    /// Force of the contacts on every disc, N: away from the input's axis, and counter-clockwise about it.
    pub(crate) bearings: Vec<[f64; 2]>,
}

impl Pose {
    /// `near`: the balance under the same load at the pose before, if there is one; this one afterwards. `pressure`: where that of
    /// the pairs is wanted.
    pub(crate) fn find(
        statics: &mut Statics<'_>,
        pressure: Option<&LinePressure>,
        phi: f64,
        load: f64,
        near: &mut Option<Equilibrium>,
    ) -> Result<Self, GearboxError> {
        let gearbox = statics.gearbox();
        let found = statics.track(near, phi, load)?;
        let touching = statics.touching(found);
        let wheels = gearbox.layout.wheels;
        let phases = &gearbox.geometry.wheel_phases;
        let turned = gearbox.geometry.eccentric_angle(phi, found.output);
        let mut bearings = vec![[0.0; 2]; wheels];
        for contact in &touching {
            let (s, c) = (turned + phases[contact.wheel]).sin_cos();
            let [fx, fy] = contact.force_on_sleeve();
            let sum = &mut bearings[contact.wheel];
            sum[0] -= fx * c + fy * s;
            sum[1] -= fy * c - fx * s;
        }
        let pair = |contact: &PairContact| {
            let wheel = contact.wheel;
            pair(
                gearbox,
                pressure,
                turned + phases[wheel],
                found.wheels[wheel],
                contact,
            )
        };
        let cranks = statics.on_cranks(found);
        let on_crank = |contact: &PairContact| {
            let [x, y] = contact.centre;
            Pair {
                wheel: contact.wheel,
                sleeve: contact.sleeve,
                place_rad: from_eccentric(y.atan2(x), turned + phases[contact.wheel]),
                force_n: contact.normal_force_n,
                penetration_m: contact.penetration_m,
                pressure_pa: 0.0,
                sliding_m_s: 0.0,
            }
        };
        let cranks = cranks.iter().map(on_crank);
        Ok(Self {
            error_rad: found.output + gearbox.flange_twist_rad(load)
                - gearbox.geometry.ideal_output_angle(phi),
            pairs: touching.iter().map(pair).chain(cranks).collect(),
            bearings,
        })
    }

    /// Force on the bearing that carries most, N.
    pub(crate) fn largest_bearing_n(&self) -> f64 {
        let sizes = self.bearings.iter().map(|[r, t]| r.hypot(*t));
        sizes.fold(0.0, f64::max)
    }

    pub(crate) fn of(&self, stage: Stage) -> impl Iterator<Item = &Pair> {
        self.pairs.iter().filter(move |pair| stage.has(pair.sleeve))
    }
}

/// An angle about the gear's axis from an eccentric's, -pi to pi.
fn from_eccentric(angle: f64, eccentric: f64) -> f64 {
    (angle - eccentric + PI).rem_euclid(TAU) - PI
}

/// Place, pressure and sliding of a contact; `eccentric` and `angle`: of the disc's eccentric and of the disc, rad.
fn pair(
    gearbox: &Gearbox,
    pressure: Option<&LinePressure>,
    eccentric: f64,
    angle: f64,
    contact: &PairContact,
) -> Pair {
    let [x, y] = contact.centre;
    let geometry = &gearbox.geometry;
    // Velocity of the disc at W: about its centre at -omega/zs, and with it along the eccentric's circle.
    let omega = gearbox.scene.eccentric_speed_rad_s();
    let rate = -omega / geometry.lobes();
    let (s, c) = eccentric.sin_cos();
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
    Pair {
        wheel: contact.wheel,
        sleeve: contact.sleeve,
        place_rad: from_eccentric(y.atan2(x), eccentric),
        force_n: contact.normal_force_n,
        penetration_m: contact.penetration_m,
        pressure_pa: pressure.map_or(0.0, |pressure| {
            pressure.of(geometry, contact, [e * c, e * s], angle)
        }),
        sliding_m_s: (velocity[1] * nx - velocity[0] * ny).abs(),
    }
}

/// Who carries the load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sharing {
    /// Which pins.
    pub stage: Stage,
    /// Largest force of a pair in a pose, N.
    pub largest_force_n: Spread,
    /// Touching pairs of a disc.
    pub touching: Spread,
    /// Places around the eccentric, degrees: -180 to 180.
    pub place_deg: Vec<f64>,
    /// Largest force of a pair at that place, N; 0 where none touches.
    pub force_n: Vec<f64>,
}

impl Sharing {
    pub(crate) fn of(poses: &[&Pose], stage: Stage) -> Self {
        let wheels = poses.first().map_or(1, |pose| pose.bearings.len());
        let mut force = vec![0.0_f64; 2 * PLACES];
        for pair in poses.iter().flat_map(|pose| pose.of(stage)) {
            let place = ((pair.place_rad / PI + 1.0) * PLACES as f64) as usize;
            let place = &mut force[place.min(2 * PLACES - 1)];
            *place = place.max(pair.force_n);
        }
        let largest = |pose: &&Pose| {
            let forces = pose.of(stage).map(|pair| pair.force_n);
            forces.fold(0.0_f64, f64::max)
        };
        let touching = |pose: &&Pose| pose.of(stage).count() as f64 / wheels as f64;
        let place = |k: usize| 180.0 * ((k as f64 + 0.5) / PLACES as f64 - 1.0);
        Self {
            stage,
            largest_force_n: Spread::of(poses.iter().map(largest)),
            touching: Spread::of(poses.iter().map(touching)),
            place_deg: (0..2 * PLACES).map(place).collect(),
            force_n: force,
        }
    }
}

/// Pressure and sliding over the poses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pressure {
    /// Which pins.
    pub stage: Stage,
    /// Largest p0, Pa.
    pub largest_pa: f64,
    /// Where, from the eccentric, degrees.
    pub largest_at_deg: f64,
    /// Largest sliding speed of a loaded pair on a pin that does not turn, m/s.
    pub sliding_m_s: f64,
    /// Largest product of both in one pair, W/m^2.
    pub pressure_sliding_w_m2: f64,
}

impl Pressure {
    pub(crate) fn of(poses: &[&Pose], stage: Stage) -> Self {
        let mut found = Self {
            stage,
            largest_pa: 0.0,
            largest_at_deg: 0.0,
            sliding_m_s: 0.0,
            pressure_sliding_w_m2: 0.0,
        };
        for pair in poses.iter().flat_map(|pose| pose.of(stage)) {
            if pair.pressure_pa > found.largest_pa {
                found.largest_pa = pair.pressure_pa;
                found.largest_at_deg = pair.place_rad.to_degrees();
            }
            found.sliding_m_s = found.sliding_m_s.max(pair.sliding_m_s);
            let product = pair.pressure_pa * pair.sliding_m_s;
            found.pressure_sliding_w_m2 = found.pressure_sliding_w_m2.max(product);
        }
        found
    }
}

/// Force of the contacts on a disc, which its bearing on the eccentric carries.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bearing {
    /// Disc.
    pub wheel: usize,
    /// Its size, N.
    pub force_n: Spread,
    /// Away from the input's axis, N, over the period.
    pub radial_n: Vec<f64>,
    /// Counter-clockwise about the input's axis, N, over the period: times e, the torque this disc takes.
    pub tangential_n: Vec<f64>,
    /// The largest harmonics of the part away from the axis, largest first.
    pub radial_harmonics: Vec<ForceHarmonic>,
}

impl Bearing {
    /// Size of the force over the period, N.
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
