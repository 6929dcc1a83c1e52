//! The fixed set: which scenes, over which window, by which formulations and integrators.
//!
//! Windows are short. The start-up transient excites every vibration and two and a half meshes pass
//! through it, so errors of a method, of a contact and of a step control all show within 20 ms.
//! All hard presets are in it but these: scenes whose forces are only rounding (no load), the one no method resolves
//! (feather-light sleeves), and `hard-long-run`, which is `paper` for longer.

use pinwheel_scene::{CheckedScene, Override, Scene, SceneError};

/// A scene of the set.
#[derive(Debug, Clone, Copy)]
pub struct SceneCase {
    /// Name in the baseline, and of its file there.
    pub name: &'static str,
    /// Preset it is made of.
    pub preset: &'static str,
    /// Keys it changes.
    pub sets: &'static [(&'static str, &'static str)],
    /// What it is in the set for.
    pub why: &'static str,
    /// By which solvers it runs.
    pub choices: &'static [Choice],
}

/// A formulation with an integrator and its step or tolerance.
#[derive(Debug, Clone, Copy)]
pub struct Choice {
    /// Name: `<formulation>-<integrator>`, and what else sets it apart.
    pub name: &'static str,
    /// Keys it sets.
    pub sets: &'static [(&'static str, &'static str)],
}

/// By which a scene is run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way<'a> {
    /// Name in the baseline.
    pub(super) name: &'a str,
    /// Keys it sets.
    pub(super) sets: &'static [(&'static str, &'static str)],
    /// A solver that joined instead of our own.
    pub(super) solver: Option<&'a str>,
}

impl From<&'static Choice> for Way<'_> {
    fn from(choice: &'static Choice) -> Self {
        Self {
            name: choice.name,
            sets: choice.sets,
            solver: None,
        }
    }
}

/// Sampling of every scene: whole courses enter the exact summary, a few samples of them are kept.
/// The sampling step is no multiple of the paper's step, so that the states between steps are checked too.
pub(super) const WINDOW: [(&str, &str); 2] = [
    ("solver.duration_s", "0.02"),
    ("solver.sample_s", "1.03e-4"),
];

macro_rules! choice {
    ($constant:ident, $name:literal, $formulation:literal, $integrator:literal $(, $key:literal = $value:literal)*) => {
        const $constant: Choice = Choice {
            name: $name,
            sets: &[
                ("solver.formulation", $formulation),
                ("solver.integrator", $integrator),
                $(($key, $value)),*
            ],
        };
    };
}

choice!(
    RK2,
    "reduced-rk2",
    "reduced",
    "rk2",
    "solver.step_s" = "1e-5"
);
choice!(
    RK4,
    "reduced-rk4",
    "reduced",
    "rk4",
    "solver.step_s" = "1e-5"
);
choice!(
    RK4_FINE,
    "reduced-rk4-fine",
    "reduced",
    "rk4",
    "solver.step_s" = "2e-6"
);
choice!(
    DOPRI5,
    "reduced-dopri5",
    "reduced",
    "dopri5",
    "solver.tolerance" = "1e-6"
);
choice!(
    ETD,
    "reduced-etd-adams",
    "reduced",
    "etd-adams",
    "solver.tolerance" = "1e-6"
);
choice!(
    DOP853,
    "reduced-dop853",
    "reduced",
    "dop853",
    "solver.tolerance" = "1e-6"
);
choice!(
    IMEX2,
    "reduced-imex2",
    "reduced",
    "imex2",
    "solver.step_s" = "1e-5"
);
choice!(
    IMEX2_ADAPTIVE,
    "reduced-imex2-adaptive",
    "reduced",
    "imex2-adaptive",
    "solver.tolerance" = "1e-3"
);
choice!(
    RODAS5P,
    "reduced-rodas5p",
    "reduced",
    "rodas5p",
    "solver.tolerance" = "1e-6"
);
choice!(
    LAGRANGE_RK2,
    "lagrange-rk2",
    "lagrange",
    "rk2",
    "solver.step_s" = "1e-5"
);
choice!(
    LAGRANGE_DOPRI5,
    "lagrange-dopri5",
    "lagrange",
    "dopri5",
    "solver.tolerance" = "1e-6"
);
choice!(
    LAGRANGE_IMEX2,
    "lagrange-imex2",
    "lagrange",
    "imex2",
    "solver.step_s" = "1e-5"
);
choice!(
    LAGRANGE_BAUMGARTE,
    "lagrange-rk4-baumgarte",
    "lagrange",
    "rk4",
    "solver.step_s" = "1e-5",
    "solver.stabilisation" = "baumgarte"
);
choice!(
    LAGRANGE_LOOSE,
    "lagrange-rk4-unstabilised",
    "lagrange",
    "rk4",
    "solver.step_s" = "1e-5",
    "solver.stabilisation" = "none"
);

macro_rules! scene {
    ($name:literal from $preset:literal { $($key:literal = $value:literal),* } $choices:expr, $why:literal) => {
        SceneCase {
            name: $name,
            preset: $preset,
            sets: &[$(($key, $value)),*],
            why: $why,
            choices: $choices,
        }
    };
    ($preset:literal, $choices:expr, $why:literal) => {
        scene!($preset from $preset {} $choices, $why)
    };
}

/// The set.
pub const SCENES: &[SceneCase] = &[
    scene!(
        "paper",
        &[
            RK2,
            RK4,
            DOPRI5,
            ETD,
            DOP853,
            IMEX2,
            IMEX2_ADAPTIVE,
            LAGRANGE_RK2,
            LAGRANGE_DOPRI5,
            LAGRANGE_IMEX2,
            LAGRANGE_BAUMGARTE,
            LAGRANGE_LOOSE,
        ],
        "every method and both formulations on the main case"
    ),
    scene!(
        "paper-loaded" from "paper" { "drive.start" = "equilibrium", "drive.load_ramp_s" = "0.01" } &[RK4, DOPRI5, ETD],
        "statics at the start, and a load that rises"
    ),
    scene!("paper-2019", &[RK2, DOPRI5], "other holes and sleeves"),
    scene!("paper-geometric", &[RK2, DOPRI5], "other inertias"),
    scene!(
        "backlash-0.6",
        &[RK2, DOPRI5, ETD],
        "contacts that open and close"
    ),
    scene!("one-wheel", &[DOPRI5, LAGRANGE_RK2], "one wheel"),
    scene!(
        "eleven-pins",
        &[RK2, DOPRI5, LAGRANGE_RK2],
        "another gear: eleven sleeves, three wheels"
    ),
    scene!(
        "forty-pins",
        &[RK2, DOPRI5, ETD],
        "another gear: forty sleeves"
    ),
    scene!(
        "steel",
        &[RK4_FINE, DOPRI5, ETD, DOP853],
        "hundred times the stiffness"
    ),
    scene!(
        "paper-rough",
        &[RK2, RK4],
        "the published detection, coarse"
    ),
    scene!(
        "paper-refined",
        &[RK2, RK4],
        "the published detection, fine"
    ),
    scene!(
        "paper-friction",
        &[IMEX2, IMEX2_ADAPTIVE, RODAS5P, LAGRANGE_IMEX2],
        "friction"
    ),
    scene!(
        "paper-adams-friction" from "paper" {
            "contact.friction_coefficient" = "0.1", "contact.friction_law" = "adams",
            "contact.friction_dynamic_coefficient" = "0.07", "contact.friction_ramp_m_s" = "5e-3",
            "contact.friction_dynamic_speed_m_s" = "2e-2"
        } &[RK4_FINE, DOPRI5],
        "friction that falls with speed"
    ),
    scene!("paper-conservative" from "paper" { "contact.law" = "paper-conservative" } &[RK4, DOPRI5, ETD], "the law with a potential"),
    scene!("flores" from "paper" { "contact.law" = "flores" } &[RK4, DOPRI5], "hysteresis damping"),
    scene!("line-contact" from "paper" { "contact.law" = "line-contact" } &[RK4, DOPRI5], "line contact"),
    scene!(
        "hard-friction-light-sleeves",
        &[IMEX2, RODAS5P, LAGRANGE_IMEX2],
        "friction thirteen times as stiff"
    ),
    scene!(
        "hard-friction-narrow",
        &[IMEX2, IMEX2_ADAPTIVE],
        "friction ten times as narrow"
    ),
    scene!(
        "hard-friction-wide",
        &[IMEX2, RK4, DOPRI5],
        "friction that explicit methods stand"
    ),
    scene!(
        "hard-backlash-1",
        &[RK4, DOPRI5, ETD],
        "impacts after a long fall"
    ),
    scene!("hard-damping-64", &[RK4, DOPRI5], "damping that dominates"),
    scene!(
        "hard-load-doubled",
        &[RK2, RK4, DOPRI5, LAGRANGE_RK2],
        "a jump of the load between two steps"
    ),
    scene!(
        "hard-load-reversal",
        &[RK4, DOPRI5, ETD],
        "all contacts open at once, and strike"
    ),
    scene!("hard-load-reversed", &[RK4, DOPRI5], "the other flanks"),
    scene!(
        "hard-load-step",
        &[RK4, DOPRI5, ETD],
        "a jump that the step control must survive"
    ),
    scene!(
        "hard-ramp-1e-9",
        &[RK4, DOPRI5],
        "forces that begin with a jump"
    ),
    scene!("hard-rpm-6000", &[RK4, DOPRI5], "twelve times the speed"),
    scene!(
        "hard-steel-damped",
        &[RK4_FINE, DOPRI5],
        "high frequency and strong damping"
    ),
    // The other hard presets that hold, one run each: a change that breaks only one of them is seen.
    scene!("hard-adhesive", &[DOPRI5], "contacts that pull"),
    scene!("hard-all-open", &[DOPRI5], "no contact at the start"),
    scene!("hard-backlash-0.1", &[DOPRI5], "little play"),
    scene!("hard-damping-0", &[DOPRI5], "nothing dies out"),
    scene!("hard-damping-1", &[DOPRI5], "little damping"),
    scene!("hard-damping-512", &[DOPRI5], "damping that is stiff"),
    scene!("hard-forty-sleeves", &[IMEX2], "many pairs with friction"),
    scene!("hard-load-removed", &[DOPRI5], "a load that goes away"),
    scene!("hard-one-sleeve", &[DOPRI5], "one loaded sleeve"),
    scene!("hard-points-120", &[RK4], "a polygon as profile"),
    scene!("hard-points-600", &[RK4], "the published polygon"),
    scene!("hard-points-16000", &[RK4], "a fine polygon"),
    scene!("hard-ramp-1e-7", &[DOPRI5], "forces that begin steeply"),
    scene!("hard-rpm-20", &[DOPRI5], "almost at rest"),
    scene!(
        "hard-steel",
        &[RK4_FINE],
        "steel by a fixed step that just resolves it"
    ),
    scene!(
        "hard-stiffness-0.1",
        &[DOPRI5, ETD],
        "ten times the stiffness"
    ),
    scene!(
        "hard-stiffness-0.1-damped",
        &[DOPRI5],
        "that with strong damping"
    ),
];

impl SceneCase {
    /// Every key that it and its window change, as one would type them.
    #[must_use]
    pub fn changes(&self) -> Vec<String> {
        let all = WINDOW.iter().chain(self.sets);
        all.map(|(key, value)| format!("{key}={value}")).collect()
    }

    /// The scene with these settings of a solver.
    ///
    /// # Errors
    /// A key or value of the set is wrong.
    pub fn scene(&self, solver: &[(&str, &str)]) -> Result<CheckedScene, SceneError> {
        let keys = WINDOW.iter().chain(self.sets).chain(solver);
        let overrides: Vec<Override> = keys
            .map(|&(key, value)| Override::new(key, value))
            .collect();
        Scene::load(self.preset, &overrides)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use pinwheel_mbs::integrators::METHODS;

    use super::*;

    #[test]
    fn the_set_is_sound() {
        let mut names = BTreeSet::new();
        for case in SCENES {
            assert!(names.insert(case.name), "{} twice", case.name);
            let mut choices = BTreeSet::new();
            for choice in case.choices {
                assert!(
                    choices.insert(choice.name),
                    "{} twice in {}",
                    choice.name,
                    case.name
                );
                let scene = case.scene(choice.sets).unwrap();
                assert!(
                    choice.name.contains(&scene.solver.integrator),
                    "{}",
                    choice.name
                );
            }
        }
    }

    /// A hard case that nobody watches would break unseen.
    #[test]
    fn every_hard_case_that_holds_is_in_the_set() {
        let left_out = [
            "hard-feather-sleeves",
            "hard-long-run",
            "hard-zero-load",
            "hard-zero-load-friction",
        ];
        for preset in pinwheel_scene::PRESETS {
            let hard = preset.name.starts_with("hard-") && !left_out.contains(&preset.name);
            let watched = SCENES.iter().any(|case| case.preset == preset.name);
            assert_eq!(
                hard,
                watched && preset.name.starts_with("hard-"),
                "{}",
                preset.name
            );
        }
    }

    /// A method that nobody watches would move unseen.
    #[test]
    fn every_method_is_in_the_set() {
        let used: BTreeSet<String> = SCENES
            .iter()
            .flat_map(|case| {
                case.choices
                    .iter()
                    .map(|choice| case.scene(choice.sets).unwrap())
            })
            .map(|scene| scene.solver.integrator.clone())
            .collect();
        for method in METHODS {
            assert!(
                used.contains(method.name),
                "no scene runs by {}; add one",
                method.name
            );
        }
    }
}
