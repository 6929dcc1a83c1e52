//! The characteristic sizes of a gear under its largest static load: forces, penetrations, frequencies.
//!
//! They set error scales, steps, samples and windows, so that a gear of millimetres and one of metres are treated
//! alike. Linear springs without clearance: the most loaded pin of a stage carries about F = 4 T/(l z) (T: load on one
//! disc, l: lever, e zs or R_w, z: pins). The scene's own law tells how far it is pressed in by that, and its tangent
//! stiffness k. A quarter of all pins, weighted by their levers, make
//! the torsional stiffness k l^2 z/4. All discs in phase and the output are then two masses on two springs:
//!
//! ```text
//! I_w theta'' = -A theta - B (theta - psi),    I_o psi'' = -w B (psi - theta)
//! ```
//! whose two modes are in closed form. Impacts press deeper than the load does and are a little stiffer (by the cube root
//! of the depth's square root for a point contact), which is what the verification of a run is for.

use std::f64::consts::PI;

use pinwheel_contact::laws::law_info;
use pinwheel_contact::{
    HertzStiffness, Law, LawParameters, Material, NormalLaw as _, PaperLaw, PinLaw, Ramp,
};

use crate::bearings::{BearingLaw, typical_force};
use crate::check::hole_to_profile_m;
use crate::load_profile;
use crate::model::Scene;

/// See the module. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Load torque on one disc, N m: the largest of the run, or where there is none what makes the [`least_depth`].
    pub wheel_torque_n_m: f64,
    /// Largest static force of a ring pin on a disc, N.
    pub external_force_n: f64,
    /// Penetration under the external force, m.
    pub penetration_m: f64,
    /// Tangent stiffness of an external contact under its largest force, N/m.
    pub contact_stiffness_n_m: f64,
    /// Slowest and fastest mode of the discs and the output together, rad/s.
    pub modes_rad_s: [f64; 2],
}

/// Least depth of contact that anything is measured by, as a share of the ring pins' radius: what stands in for the
/// load of a gear without any. The paper's unloaded gear is then measured by 1.4 mN.
const LEAST_DEPTH: f64 = 1e-5;

/// The depth that stands in for no load, m.
#[must_use]
pub fn least_depth(scene: &Scene) -> f64 {
    LEAST_DEPTH * scene.gear.external_sleeve_radius_m
}

const DEPTH: &str = "contact.disc_depth_m";
const SPRING: &str = "contact.external_spring_n_m";

/// Springs of a scene's external and internal contacts, N/m: its own, or the secants of rollers under the largest static
/// forces.
fn springs(scene: &Scene) -> [f64; 2] {
    let (contact, gear) = (&scene.contact, &scene.gear);
    let mut rollers = scene.clone();
    "line-hertz".clone_into(&mut rollers.contact.law);
    let (hertz, load) = (hertz(&rollers), load_profile::largest(&scene.drive));
    let torque = load / gear.wheels as f64;
    let secant = |stiffness: f64, force: f64| {
        let spring = Spring::of(&rollers, stiffness);
        let depth = spring.depth(force, least_depth(scene));
        spring.force(depth) / depth
    };
    let (pin, hole) = (gear.internal_sleeve_radius_m, gear.hole_radius_m);
    let hole = hole.max(pin + gear.eccentricity_m);
    [
        contact.external_spring_n_m.unwrap_or_else(|| {
            let flat = hertz.on_flat(gear.external_sleeve_radius_m);
            secant(flat, external_force(gear, torque))
        }),
        contact
            .internal_spring_n_m
            .unwrap_or_else(|| secant(hertz.of_hole(pin, hole), internal_force(gear, torque))),
    ]
}

/// True if a scene's law reads a key.
fn reads(scene: &Scene, key: &str) -> bool {
    law_info(&scene.contact.law).is_some_and(|law| law.keys.contains(&key))
}

/// States the depth of the discs that the law would measure in the gear each time it is asked for.
pub fn state_depth(scene: &mut Scene) {
    if reads(scene, DEPTH) {
        let depth = law_parameters(scene).disc_depth;
        scene.contact.disc_depth_m = Some(depth);
    }
}

/// Parameters that a scene's law reads from it.
#[must_use]
pub fn law_parameters(scene: &Scene) -> LawParameters {
    let contact = &scene.contact;
    let pin = Material {
        young: contact.pin_young_pa.unwrap_or(contact.young_pa),
        poisson: contact.pin_poisson.unwrap_or(contact.poisson),
    };
    let springs = match reads(scene, SPRING) {
        true => springs(scene),
        false => [1.0; 2],
    };
    let least = 0.5 * scene.gear.external_sleeve_radius_m;
    let wall = || reads(scene, DEPTH).then(|| hole_to_profile_m(&scene.gear).max(least));
    LawParameters {
        damping: contact.damping_n_s_m,
        ramp: contact.ramp_m,
        constant_stiffness: contact.constant_stiffness_n_m15,
        stiffness_multiplier: contact.stiffness_multiplier,
        internal_multiplier: contact
            .internal_stiffness_multiplier
            .unwrap_or(contact.stiffness_multiplier),
        springs,
        line_length: contact.line_length_m,
        pin,
        disc: Material {
            young: contact.young_pa,
            poisson: contact.poisson,
        },
        disc_depth: contact.disc_depth_m.or_else(wall).unwrap_or_default(),
        sleeve_radius: scene.gear.external_sleeve_radius_m,
        restitution: contact.restitution,
        impact_speed: contact.impact_speed_m_s,
    }
}

/// Hertz' stiffness of a scene's materials, as its law wants it.
#[must_use]
pub fn hertz(scene: &Scene) -> HertzStiffness {
    law_parameters(scene).hertz(&scene.contact.law)
}

/// The law that a scene names; `None` if there is none of that name.
#[must_use]
pub fn law(scene: &Scene) -> Option<Law> {
    Law::named(&scene.contact.law, &law_parameters(scene))
}

/// The law that a scene names, with the bending of its output pins.
#[must_use]
pub fn pin_law(scene: &Scene) -> Option<PinLaw> {
    Some(PinLaw {
        law: law(scene)?,
        pin_n_m: scene.bearings.internal_sleeve_stiffness_n_m,
    })
}

/// A contact at rest under a scene's law.
#[derive(Debug, Clone, Copy)]
pub struct Spring {
    law: Law,
    hertz: f64,
}

impl Spring {
    /// Where Hertz' stiffness is `hertz`, N/m^1.5; of a law that is none a spring after Hertz.
    #[must_use]
    pub fn of(scene: &Scene, hertz: f64) -> Self {
        let plain = || PaperLaw {
            damping: 0.0,
            ramp: Ramp::new(scene.contact.ramp_m),
        };
        Self {
            law: law(scene).unwrap_or_else(|| Law::Paper(plain())),
            hertz,
        }
    }

    /// F, N.
    #[must_use]
    pub fn force(&self, depth: f64) -> f64 {
        self.law.elastic(self.hertz, depth)
    }

    /// delta under a force, m, and at least `least`.
    #[must_use]
    pub fn depth(&self, force_n: f64, least: f64) -> f64 {
        if force_n > 0.0 {
            self.law.depth(self.hertz, force_n).max(least)
        } else {
            least
        }
    }

    /// dF/d delta, N/m.
    #[must_use]
    pub fn tangent(&self, depth: f64) -> f64 {
        self.law.tangent(self.hertz, depth)
    }
}

/// 4 T/(e zs zk): the largest force of a ring pin on a disc under the torque T, N.
#[must_use]
pub fn external_force(gear: &crate::Gear, wheel_torque_n_m: f64) -> f64 {
    4.0 * wheel_torque_n_m / (gear.lever_m() * gear.external_sleeves as f64)
}

/// 4 T/(zi R_w): the largest force of an output pin on a disc under the torque T, N.
#[must_use]
pub fn internal_force(gear: &crate::Gear, wheel_torque_n_m: f64) -> f64 {
    4.0 * wheel_torque_n_m / (gear.internal_sleeves as f64 * gear.internal_circle_radius_m)
}

/// How far a disc turns freely to one side because of backlash and modification, rad, among pins without errors at all
/// angles: d sqrt(1 - m^2)/(e zs) of a backlash alone, 0 where they overlap.
#[must_use]
pub fn free_play(gear: &crate::Gear) -> f64 {
    let m = gear.shortening;
    if gear.modification.is_none() {
        return gear.backlash_m * (1.0 - m * m).sqrt() / gear.lever_m();
    }
    // Where all that makes play is positive, the pin with the longest lever (cos phi = m) closes it.
    let share = |cos: f64| {
        let (gap, lever) = gear.initial_gap_m(cos.acos());
        gap / lever
    };
    let tried = (1..400).map(|k| share((PI * f64::from(k) / 400.0).cos()));
    tried.fold(share(m), f64::min).max(0.0)
}

/// How far a disc turns freely at most, rad: what [`free_play`] is, and what individual errors may add.
#[must_use]
pub fn largest_play(gear: &crate::Gear) -> f64 {
    free_play(gear) + gear.errors.largest_of_mesh_m(gear) / gear.lever_m()
}

/// Largest free rotation of the output in its holes, rad.
#[must_use]
pub fn largest_hole_play(gear: &crate::Gear) -> f64 {
    let clearance = gear.hole_radius_m - gear.internal_sleeve_radius_m - gear.eccentricity_m;
    (clearance.max(0.0) + gear.errors.largest_of_holes_m(gear)) / gear.internal_circle_radius_m
}

/// Share of a scene's largest static force that is rounding: 16 digits, times some ten thousand for what the bodies and a
/// solver add. 1.0e-9 N for the paper's gear.
const ROUNDING: f64 = 1e-11;

/// A ring pin on a disc at rest.
fn outer(scene: &Scene, hertz: &HertzStiffness) -> Spring {
    Spring::of(scene, hertz.on_flat(scene.gear.external_sleeve_radius_m))
}

/// Load torque on one disc, N m: the largest of the run, or where there is none what makes the [`least_depth`].
pub(crate) fn wheel_torque_n_m(scene: &Scene) -> f64 {
    wheel_torque_of(scene, &outer(scene, &hertz(scene)))
}

/// Load torque on one disc for known springs, N m: the largest of the run, but at least a quarter of that of the
/// unloaded contacts.
fn wheel_torque_of(scene: &Scene, outer: &Spring) -> f64 {
    let gear = &scene.gear;
    let unloaded = outer.force(least_depth(scene));
    let load = load_profile::largest(&scene.drive) / gear.wheels as f64;
    load.max(0.25 * unloaded * gear.lever_m() * gear.external_sleeves as f64)
}

impl Scales {
    /// Force above which a contact presses, N: less is the rounding of pins that only just touch, as all of them do in
    /// the ideal mesh of a gear without backlash.
    #[must_use]
    pub fn pressing_n(&self) -> f64 {
        ROUNDING * self.external_force_n
    }

    /// Torque below which there is only rounding, N m.
    #[must_use]
    pub fn rounding_n_m(&self) -> f64 {
        ROUNDING * self.wheel_torque_n_m
    }

    /// The scales of a scene whose values are in range.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let gear = &scene.gear;
        let hertz = hertz(scene);
        let outer = outer(scene, &hertz);
        // A hole that fits tightly is far stiffer; nothing moves faster than in one with the usual clearance of e.
        let sleeve = gear.internal_sleeve_radius_m;
        let hole = gear.hole_radius_m.max(sleeve + gear.eccentricity_m);
        let inner = Spring::of(scene, hertz.of_hole(sleeve, hole));
        let lever = gear.lever_m();
        let least = least_depth(scene);
        let load = load_profile::largest(&scene.drive) / gear.wheels as f64;
        let torque = wheel_torque_of(scene, &outer);
        let torsion = |spring: Spring, pin: Option<f64>, lever: f64, sleeves: usize| {
            let sleeves = sleeves as f64;
            let depth = spring.depth(4.0 * load / (lever * sleeves), least);
            let contact = spring.tangent(depth);
            let tangent = pin.map_or(contact, |pin| contact * pin / (contact + pin));
            0.25 * sleeves * tangent * lever * lever
        };
        let force = external_force(gear, torque);
        let penetration = outer.depth(force, least);
        let housing = torsion(outer, None, lever, gear.external_sleeves);
        let (circle, sleeves) = (gear.internal_circle_radius_m, gear.internal_sleeves);
        let on_cranks = scene.cranks.and_then(|_| BearingLaw::of(scene));
        let output = match on_cranks {
            Some(bearing) => {
                let stiffness = bearing.slope_under(typical_force(scene));
                sleeves as f64 * stiffness * circle * circle
            }
            None => {
                let pin = scene.bearings.internal_sleeve_stiffness_n_m;
                torsion(inner, pin, circle, sleeves)
            }
        };
        Self {
            wheel_torque_n_m: torque,
            external_force_n: force,
            penetration_m: penetration,
            contact_stiffness_n_m: outer.tangent(penetration),
            modes_rad_s: modes(scene, housing, output),
        }
    }

    /// Time after which free vibrations of the slowest mode are a thousandth, s: damping proportional to stiffness
    /// makes a mode decay at the rate omega^2 C/(2 k). `None` without damping.
    #[must_use]
    pub fn settling_s(&self, damping_n_s_m: f64) -> Option<f64> {
        let [slow, _] = self.modes_rad_s;
        let rate = 0.5 * slow * slow * damping_n_s_m / self.contact_stiffness_n_m;
        (rate > 0.0).then(|| 1000_f64.ln() / rate)
    }
}

/// Frequencies of [[n I, 0], [0, J]] with [[n (k + c), -n c], [-n c, n c]]: the discs with the output and against it.
fn modes(scene: &Scene, housing: f64, coupling: f64) -> [f64; 2] {
    let (gear, mass) = (&scene.gear, &scene.mass);
    let radius = gear.internal_circle_radius_m;
    let wheels = gear.wheels as f64;
    let carried = mass.internal_sleeve.mass_kg * radius * radius * gear.internal_sleeves as f64;
    let output = scene.output_shaft().moment_kg_m2 + carried;
    let wheel = mass.wheel.moment_kg_m2;
    let (a, b, c) = (
        (housing + coupling) / wheel,
        wheels * coupling / output,
        coupling / wheel,
    );
    // Roots of (a - x)(b - x) = c b; their product is a b - c b = b k/I.
    let fast = 0.5 * (a + b + ((a - b) * (a - b) + 4.0 * c * b).sqrt());
    let slow = b * (housing / wheel) / fast;
    [slow.sqrt(), fast.sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Modes of the paper's gear by an independent eigenvalue solution under its load: 530, 1660 and 1740 Hz.
    #[test]
    fn the_papers_modes() {
        let scales = Scales::of(&Scene::paper());
        let [slow, fast] = scales.modes_rad_s.map(|rate| rate / std::f64::consts::TAU);
        assert!((slow / 530.0 - 1.0).abs() < 0.3, "{slow}");
        assert!((fast / 1740.0 - 1.0).abs() < 0.3, "{fast}");
        let settled = scales.settling_s(8.0).unwrap();
        assert!((0.1..0.4).contains(&settled), "{settled}");
    }

    /// A hundred times the Hertzian stiffness, and a law whose stiffness is not Hertz'.
    #[test]
    fn the_law_decides() {
        let mut scene = Scene::paper();
        let [_, soft] = Scales::of(&scene).modes_rad_s;
        scene.contact.stiffness_multiplier = 1.0;
        // k grows with K^(2/3) at a given force.
        let [_, stiff] = Scales::of(&scene).modes_rad_s;
        assert!((stiff / soft - 100.0_f64.powf(1.0 / 3.0)).abs() < 1e-9);
        scene.contact.law = "line-contact".to_owned();
        assert!(Scales::of(&scene).modes_rad_s[1] > 1.5 * stiff);
    }

    /// Lengths, masses, times and forces of a gear scaled together: every ratio stays.
    #[test]
    fn similar_gears_have_similar_scales() {
        for load in [22.0, 0.0] {
            let mut scene = Scene::paper();
            scene.drive.output_torque_n_m = load;
            let one = Scales::of(&scene);
            let (length, mass, time) = (0.1, 1e-4, 0.5);
            let gear = &mut scene.gear;
            gear.eccentricity_m *= length;
            gear.external_sleeve_radius_m *= length;
            gear.internal_sleeve_radius_m *= length;
            gear.internal_circle_radius_m *= length;
            gear.hole_radius_m *= length;
            let force = mass * length / (time * time);
            scene.mass.wheel.moment_kg_m2 *= mass * length * length;
            scene.mass.output_shaft.moment_kg_m2 *= mass * length * length;
            scene.mass.internal_sleeve.mass_kg *= mass;
            scene.drive.output_torque_n_m *= force * length;
            scene.contact.young_pa *= force / (length * length);
            let other = Scales::of(&scene);
            let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
            near(other.penetration_m, one.penetration_m * length);
            near(other.external_force_n, one.external_force_n * force);
            for k in 0..2 {
                near(other.modes_rad_s[k], one.modes_rad_s[k] / time);
            }
        }
    }
}
