//! What a scene takes for granted that its source does not say. Shown in every report.

use serde::{Deserialize, Serialize};

use super::model::{Gear, Masses, Scene};

/// A value that had to be assumed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Assumption {
    /// The key it concerns.
    pub key: String,
    /// Its value in this scene, with unit.
    pub value: String,
    /// Why this value, and what contradicts or supports it.
    pub reason: String,
}

/// The assumptions behind a scene.
///
/// For the paper's gear (Tab. 1): the dimensions of its missing Fig. 3, the friction coefficient it
/// does not give, and Tab. 2's moments of inertia. For any other gear: the paper's masses, where
/// they were left at their defaults.
#[must_use]
pub fn assumptions(scene: &Scene) -> Vec<Assumption> {
    let gear = &scene.gear;
    let mut list = Vec::new();
    let mut add = |key: &str, value: String, reason: &str| {
        list.push(Assumption {
            key: key.to_owned(),
            value,
            reason: reason.to_owned(),
        });
    };
    if is_the_papers(gear) {
        add(
            "gear.internal_sleeve_radius_m",
            format!("{} m", gear.internal_sleeve_radius_m),
            "Fig. 3 of the paper is not available; 6 mm because Tab. 2 gives internal and external sleeves the same mass and moment, 5 mm in the author's 2019 optimisation of this gearbox",
        );
        add(
            "gear.hole_radius_m",
            format!("{} m", gear.hole_radius_m),
            "Fig. 3 of the paper is not available; sleeve radius + eccentricity is a hole without clearance",
        );
        add(
            "gear.internal_circle_radius_m",
            format!("{} m", gear.internal_circle_radius_m),
            "Fig. 3 of the paper is not available; 38 mm fits the wheel with 6 mm sleeves, the 2019 optimisation used 30 mm",
        );
        add(
            "contact.friction_coefficient",
            format!("{}", scene.contact.friction_coefficient),
            "the paper's Eq. 21 has a friction coefficient but no value for it; 0 leaves the sleeves' spin out of play, 0.1 is usual for oiled steel",
        );
    }
    let default = Masses::default();
    let papers_moments = scene.mass.wheel.moment_kg_m2 == default.wheel.moment_kg_m2
        || scene.mass.external_sleeve.moment_kg_m2 == default.external_sleeve.moment_kg_m2
        || scene.mass.internal_sleeve.moment_kg_m2 == default.internal_sleeve.moment_kg_m2;
    if is_the_papers(gear) && papers_moments {
        add(
            "mass",
            format!(
                "wheel {:e}, sleeves {:e} and {:e} kg m^2",
                scene.mass.wheel.moment_kg_m2,
                scene.mass.external_sleeve.moment_kg_m2,
                scene.mass.internal_sleeve.moment_kg_m2
            ),
            "Tab. 2 as printed, though it contradicts the paper's own shapes: its wheel has a radius of gyration of 16 mm where the profile gives about 44 mm, a 6 mm sleeve 15 mm; the preset paper-geometric has computed moments",
        );
    } else if !is_the_papers(gear) && scene.mass == default {
        add(
            "mass",
            "as in the paper's Tab. 2".to_owned(),
            "the gear is not the paper's but its masses were left at the paper's values; give [mass] for inertia forces that belong to this gear",
        );
    }
    list
}

/// Whether Tab. 1 describes this gear (backlash and wheels may differ).
fn is_the_papers(gear: &Gear) -> bool {
    let paper = Gear::default();
    gear.eccentricity_m == paper.eccentricity_m
        && gear.external_sleeves == paper.external_sleeves
        && gear.shortening == paper.shortening
        && gear.external_sleeve_radius_m == paper.external_sleeve_radius_m
        && gear.internal_sleeves == paper.internal_sleeves
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(scene: &Scene) -> Vec<String> {
        assumptions(scene)
            .into_iter()
            .map(|assumption| assumption.key)
            .collect()
    }

    #[test]
    fn the_papers_gear_names_fig_3_mu_and_tab_2() {
        let keys = keys(&Scene::default());
        for key in [
            "gear.internal_sleeve_radius_m",
            "gear.hole_radius_m",
            "gear.internal_circle_radius_m",
            "contact.friction_coefficient",
            "mass",
        ] {
            assert!(keys.iter().any(|k| k == key), "{key} missing in {keys:?}");
        }
    }

    #[test]
    fn another_gear_only_names_borrowed_masses() {
        let mut scene = Scene::default();
        scene.gear.external_sleeves = 12;
        assert_eq!(keys(&scene), ["mass"]);
        scene.mass.wheel.mass_kg = 0.5;
        assert!(keys(&scene).is_empty());
    }
}
