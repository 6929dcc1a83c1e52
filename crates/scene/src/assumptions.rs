//! Assumptions of a scene that its source does not state; part of every report.

use serde::{Deserialize, Serialize};

use pinwheel_contact::laws::{LAWS, LawInfo};
use toml::Value;

use crate::check::doubts;
use crate::checked::{CheckedScene, Origin, Source};
use crate::keys::{Key, key};
use crate::model::{Detection, Formulation, FrictionLaw, Gear, Scene};
use crate::number::short;

/// Assumed value.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Assumption {
    /// Key of the value.
    pub key: String,
    /// Value in this scene, with unit.
    pub value: String,
    /// Reason for the value, with evidence for and against it.
    pub reason: String,
}

/// Returns the assumptions behind a scene: doubtful values, its base, every value that was filled in with its formula or
/// reason, and the gaps in the published gear's source (dimensions of its missing Fig. 3, friction coefficient, moments of
/// inertia of Tab. 2).
pub fn assumptions(scene: &CheckedScene) -> Vec<Assumption> {
    let gear = &scene.gear;
    let mut list = doubts(scene);
    list.extend(filled_in(scene));
    let mut add = |key: &str, value: String, reason: &str| {
        list.push(Assumption {
            key: key.to_owned(),
            value,
            reason: reason.to_owned(),
        });
    };
    if is_the_papers(gear) {
        for (key, length_m, reason) in [
            (
                "gear.internal_sleeve_radius_m",
                gear.internal_sleeve_radius_m,
                "6 mm because Tab. 2 gives ring and output pins the same mass and moment, 5 mm in the author's 2019 optimisation of this gearbox",
            ),
            (
                "gear.hole_radius_m",
                gear.hole_radius_m,
                "sleeve radius + eccentricity is a hole without clearance",
            ),
            (
                "gear.internal_circle_radius_m",
                gear.internal_circle_radius_m,
                "38 mm fits the disc with 6 mm pins, the 2019 optimisation used 30 mm",
            ),
        ] {
            let reason = format!("Fig. 3 of the paper is not available; {reason}");
            add(key, format!("{length_m} m"), &reason);
        }
        add(
            "contact.friction_coefficient",
            format!("{}", scene.contact.friction_coefficient),
            "the paper's Eq. 21 has a friction coefficient but no value for it; 0 leaves the pins' spin out of play, 0.1 is usual for oiled steel",
        );
    }
    for (key, half) in &scene.uncertain {
        let unit = crate::keys::key(key).map_or("", Key::unit);
        add(
            key,
            format!("+- {} {unit}", short(half.plus_minus))
                .trim_end()
                .to_owned(),
            "stated as uncertain: makes the intervals by fit, and counts where the scene is compared with measured data",
        );
    }
    let default = Scene::paper().mass;
    let papers_moments = scene.mass.wheel.moment_kg_m2 == default.wheel.moment_kg_m2
        || scene.mass.external_sleeve.moment_kg_m2 == default.external_sleeve.moment_kg_m2
        || scene.mass.internal_sleeve.moment_kg_m2 == default.internal_sleeve.moment_kg_m2;
    if is_the_papers(gear) && papers_moments {
        add(
            "mass",
            format!(
                "disc {:e}, pins {:e} and {:e} kg m^2",
                scene.mass.wheel.moment_kg_m2,
                scene.mass.external_sleeve.moment_kg_m2,
                scene.mass.internal_sleeve.moment_kg_m2
            ),
            "Tab. 2 as printed, though it contradicts the paper's own shapes: its disc has a radius of gyration of 16 mm where the profile gives about 44 mm, a 6 mm pin 15 mm; the preset paper-geometric has computed moments",
        );
    }
    list
}

/// True if a result of this scene may depend on a key; false for parameters of other laws, of friction and of points that
/// it does not use.
fn is_used(scene: &Scene, key: &str) -> bool {
    let contact = &scene.contact;
    let has_friction = contact.friction_coefficient > 0.0;
    let own = |law: &&LawInfo| law.keys.contains(&key);
    match key {
        "contact.friction_ramp_m_s" | "contact.friction_law" => has_friction,
        "contact.friction_dynamic_coefficient" | "contact.friction_dynamic_speed_m_s" => {
            has_friction && contact.friction_law == FrictionLaw::Adams
        }
        "contact.wheel_points" | "contact.hole_points" => contact.detection == Detection::Points,
        "solver.stabilisation" => scene.solver.formulation == Formulation::Lagrange,
        _ if LAWS.iter().any(|law| own(&law)) => {
            LAWS.iter().filter(own).any(|law| law.name == contact.law)
        }
        _ => true,
    }
}

/// Returns assumptions for keys that the scene's file does not write: one entry for all values of its base, one for each
/// other key.
fn filled_in(scene: &CheckedScene) -> Vec<Assumption> {
    let mut list: Vec<Assumption> = Vec::new();
    let mut inherited: Vec<(&str, Vec<&str>)> = Vec::new();
    let used = |origin: &&Origin| is_used(scene, origin.key);
    for origin in scene.origins().into_iter().filter(used) {
        if let Source::Base(base) = &origin.source {
            match inherited.iter_mut().find(|(known, _)| known == base) {
                Some((_, keys)) => keys.push(origin.key),
                None => inherited.push((base, vec![origin.key])),
            }
            continue;
        }
        let unit = key(origin.key).map_or("", Key::unit);
        let value = match &origin.value {
            Value::String(text) => text.clone(),
            Value::Float(number) => short(*number),
            other => other.to_string(),
        };
        list.push(Assumption {
            key: origin.key.to_owned(),
            value: format!("{value} {unit}").trim_end().to_owned(),
            reason: format!("not in the scene: {}", origin.source.words()),
        });
    }
    let bases = inherited.into_iter().map(|(base, keys)| Assumption {
        key: "base".to_owned(),
        value: base.to_owned(),
        reason: format!("not in the scene but in its base: {}", keys.join(", ")),
    });
    bases.chain(list).collect()
}

/// True if Tab. 1 describes this gear (backlash and discs may differ).
fn is_the_papers(gear: &Gear) -> bool {
    let paper = Scene::paper().gear;
    gear.eccentricity_m == paper.eccentricity_m
        && gear.external_sleeves == paper.external_sleeves
        && gear.shortening == paper.shortening
        && gear.external_sleeve_radius_m == paper.external_sleeve_radius_m
        && gear.internal_sleeves == paper.internal_sleeves
}
