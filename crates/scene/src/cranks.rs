//! RV reducers: cranks in place of one eccentric and of the output pins.
//!
//! A sun on the input drives planets, each on a crank; the cranks are mounted in the output and carry the discs. With phi
//! the input's angle, psi the output's and rho = z_sun/z_planet a crank turns by
//!
//! ```text
//! gamma = (1 + rho) psi - rho phi,     at the ideal mesh psi = -gamma/zs:     phi/psi = 1 + zk/rho
//! ```
//! so the output turns with the input. At a constant input speed the cranks' inertia about their own axes acts on the
//! output multiplied by (1 + rho)^2.

use crate::error::Fault;
use crate::model::{BodyMass, Cranks, Gear, OutputPart, Scene};
use crate::number::short;
use crate::{load_profile, speed_profile};

/// Pressure angle of involute teeth (ISO 53).
const PRESSURE_ANGLE_DEG: f64 = 20.0;

impl Cranks {
    /// Returns the ratio rho: teeth of the sun over teeth of a planet.
    pub fn teeth_ratio(&self) -> f64 {
        self.sun_teeth as f64 / self.planet_teeth as f64
    }

    /// Returns the base radius of a planet, m: standard teeth at a centre distance of the circle's radius.
    pub fn planet_base_radius_m(&self) -> f64 {
        let pitch_radius = self.circle_radius_m / (1.0 + self.teeth_ratio());
        pitch_radius * PRESSURE_ANGLE_DEG.to_radians().cos()
    }
}

impl Scene {
    /// True if the ring is the output, and the carrier is held.
    pub fn ring_turns(&self) -> bool {
        self.drive.output == OutputPart::Ring
    }

    /// Returns the rotation of the eccentrics per rotation of the input while the carrier is held: 1, and -rho of an RV gear.
    pub fn eccentric_per_held_carrier(&self) -> f64 {
        self.cranks.map_or(1.0, |cranks| -cranks.teeth_ratio())
    }

    /// Returns the rotation of the eccentrics against the ring per rotation of the input at the ideal mesh: 1, -rho zs/(zk
    /// + rho) of an RV gear, and zs/zk of that with a held carrier if the ring is the output.
    pub fn eccentric_per_input(&self) -> f64 {
        let (zs, zk) = (self.gear.lobes() as f64, self.gear.external_sleeves as f64);
        let held = self.eccentric_per_held_carrier();
        match &self.cranks {
            _ if self.ring_turns() => held * zs / zk,
            Some(cranks) => held * zs / (zk + cranks.teeth_ratio()),
            None => held,
        }
    }

    /// Returns the moment on the carrier per moment on the output, unsigned: 1, zs/zk of a ring, R/(R - 1) of that of an RV gear.
    pub fn carrier_moment_per_output(&self) -> f64 {
        match self.ring_turns() {
            true => (1.0 - self.output_per_input()).abs(),
            false => 1.0,
        }
    }

    /// Returns the largest load torque of the run on one disc, N m, unsigned.
    pub fn largest_disc_load_n_m(&self) -> f64 {
        self.carrier_moment_per_output() * load_profile::largest(&self.drive)
            / self.gear.wheels as f64
    }

    /// Returns the rotation of the output per rotation of the input: -1/zs, 1/(1 + zk/rho) of an RV gear, and 1/zk or -rho/zk of
    /// a ring.
    pub fn output_per_input(&self) -> f64 {
        let carrier = -self.eccentric_per_input() / self.gear.lobes() as f64;
        if self.ring_turns() { -carrier } else { carrier }
    }

    /// Returns the input turns per output turn, unsigned.
    pub fn ratio(&self) -> f64 {
        let gear = &self.gear;
        let (planet, sun) = (self.cranks).map_or((1, 1), |c| (c.planet_teeth, c.sun_teeth));
        let of_ring = (gear.external_sleeves * planet) as f64 / sun as f64;
        match self.cranks {
            _ if self.ring_turns() => of_ring,
            Some(_) => 1.0 + of_ring,
            None => gear.lobes() as f64,
        }
    }

    /// Returns the largest speed of the eccentrics at the ideal mesh, rad/s.
    pub fn eccentric_speed_rad_s(&self) -> f64 {
        self.eccentric_per_input() * speed_profile::fastest_rad_s(&self.drive)
    }

    /// Returns the input shaft with its share of the turning cranks' inertia, the part that a torque on the sun
    /// accelerates. [`output_shaft`](Self::output_shaft) has the other share; at the ideal mesh both add up to the full
    /// inertia.
    pub fn input_shaft(&self) -> BodyMass {
        let mut shaft = self.mass.input_shaft;
        if let Some(cranks) = &self.cranks {
            let on_output = (1.0 + cranks.teeth_ratio()) * self.output_per_input();
            let share = match self.ring_turns() {
                true => cranks.teeth_ratio().powi(2),
                false => self.eccentric_per_input().powi(2) - on_output.powi(2),
            };
            let turning = cranks.count as f64 * self.mass.internal_sleeve.moment_kg_m2;
            shaft.moment_kg_m2 += share * turning;
        }
        shaft
    }

    /// Returns the output shaft with its share of the turning cranks' inertia; a ring has none.
    pub fn output_shaft(&self) -> BodyMass {
        let mut shaft = self.mass.output_shaft;
        if let Some(cranks) = self.cranks.filter(|_| !self.ring_turns()) {
            let turning = cranks.count as f64 * self.mass.internal_sleeve.moment_kg_m2;
            shaft.moment_kg_m2 += (1.0 + cranks.teeth_ratio()).powi(2) * turning;
        }
        shaft
    }
}

/// Checks the requirements of an RV reducer, and refuses keys that do not apply to it.
pub(crate) fn check(scene: &Scene) -> Result<(), Fault> {
    let (gear, contact) = (&scene.gear, &scene.contact);
    let Some(cranks) = &scene.cranks else {
        return at_least_three(gear);
    };
    let own = |key: &'static str, is: f64, by: &str, wanted: f64| {
        if is == wanted {
            return Ok(());
        }
        let [is, wanted] = [is, wanted].map(short);
        Err(Fault::new(
            &[key],
            format!(
                "is {is}, but cranks stand in the place of output pins and {by} makes it {wanted}"
            ),
            "leave it out",
        ))
    };
    own(
        "gear.internal_sleeves",
        gear.internal_sleeves as f64,
        "cranks.count",
        cranks.count as f64,
    )?;
    let circle = (gear.internal_circle_radius_m, cranks.circle_radius_m);
    own(
        "gear.internal_circle_radius_m",
        circle.0,
        "cranks.circle_radius_m",
        circle.1,
    )?;
    let shaft = cranks.bore_radius_m - gear.eccentricity_m;
    if shaft <= 0.0 {
        return Err(Fault::new(
            &["cranks.bore_radius_m"],
            format!(
                "is {} m, no larger than the eccentricity: a crank's shaft cannot pass it",
                short(cranks.bore_radius_m)
            ),
            "make the bore larger",
        ));
    }
    own(
        "gear.internal_sleeve_radius_m",
        gear.internal_sleeve_radius_m,
        "cranks.bore_radius_m",
        shaft,
    )?;
    let bore = gear.hole_radius_m;
    own(
        "gear.hole_radius_m",
        bore,
        "cranks.bore_radius_m",
        gear.internal_sleeve_radius_m + gear.eccentricity_m,
    )?;
    let clearance = scene
        .bearings
        .eccentric
        .and_then(|bearing| bearing.clearance_m);
    let all = (0..gear.wheels).flat_map(|wheel| (0..cranks.count).map(move |crank| (wheel, crank)));
    let tightest = all.map(|(wheel, crank)| {
        let wider = gear.hole_radius_of_m(wheel, crank) - gear.hole_radius_m;
        wider - (gear.internal_sleeve_radius_of_m(crank) - gear.internal_sleeve_radius_m)
    });
    let tightest = tightest.fold(0.0, f64::min) + clearance.unwrap_or_default();
    // Radii are sums with rounding errors.
    if tightest < -4.0 * f64::EPSILON * gear.hole_radius_m {
        return Err(Fault::new(
            &[
                "gear.errors.hole_radius_m",
                "bearings.eccentric.clearance_m",
            ],
            format!(
                "leaves a crank's bearing a clearance of {} m, and bearings under preload are not modelled",
                short(tightest)
            ),
            "make the errors smaller, or bearings.eccentric.clearance_m larger",
        ));
    }
    if scene.bearings.eccentric.is_none() {
        return Err(Fault::new(
            &["bearings.eccentric.stiffness_n_m"],
            "is missing; discs on several rigid cranks are held more often than they can move, so that no forces follow".to_owned(),
            "give stiffness_n_m, or rollers and roller_length_m",
        ));
    }
    let bearings = &scene.bearings;
    let of_sleeves = [
        ("gear.internal_sleeves_turn", !gear.internal_sleeves_turn),
        (
            "contact.internal_spring_n_m",
            contact.internal_spring_n_m.is_some(),
        ),
        (
            "contact.internal_stiffness_multiplier",
            contact.internal_stiffness_multiplier.is_some(),
        ),
        (
            "bearings.internal_sleeve_stiffness_n_m",
            bearings.internal_sleeve_stiffness_n_m.is_some(),
        ),
        (
            "bearings.internal_sleeves_held",
            bearings.internal_sleeves_held.is_some(),
        ),
        (
            "bearings.internal_sleeve_gap_m",
            bearings.internal_sleeve_gap_m.is_some(),
        ),
    ];
    if let Some((key, _)) = of_sleeves.iter().find(|(_, is_given)| *is_given) {
        return Err(Fault::new(
            &[key],
            "is for output pins, and an RV gear has none".to_owned(),
            "leave it out",
        ));
    }
    Ok(())
}

fn at_least_three(gear: &Gear) -> Result<(), Fault> {
    if gear.internal_sleeves >= 3 {
        return Ok(());
    }
    Err(Fault::new(
        &["gear.internal_sleeves"],
        format!(
            "is {}, and fewer than three cannot hold the output shaft",
            gear.internal_sleeves
        ),
        "give at least 3, or [cranks] for an RV gear",
    ))
}
