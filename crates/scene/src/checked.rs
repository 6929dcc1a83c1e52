//! Scene whose values were checked: the only form from which a gearbox is built and run.

use std::ops::Deref;
use std::sync::Arc;

use serde::Serialize;
use toml::{Table, Value};

use crate::check;
use crate::error::Fault;
use crate::model::{Scene, Solver};
use crate::table::{insert, lookup};

/// Scene that passed [`Scene::check`]. It reads like the [`Scene`] inside, and only [`changed`](Self::changed), which
/// checks again, changes it.
///
/// ```
/// use pinwheel_scene::Scene;
///
/// let paper = Scene::load("paper", &[])?;
/// let loose = paper.changed(|scene| scene.gear.backlash_m = 6e-4)?;
/// assert_eq!(loose.gear.backlash_m, 6e-4);
/// assert!(paper.changed(|scene| scene.solver.step_s = 0.0).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Serialize)]
#[serde(transparent)]
pub struct CheckedScene {
    scene: Scene,
    #[serde(skip)]
    origins: Arc<[Origin]>,
}

/// Value that the file itself does not write.
#[derive(Debug, Clone, PartialEq)]
pub struct Origin {
    /// Key of the value.
    pub key: &'static str,
    /// Value of the key.
    pub value: Value,
    /// Source of the value.
    pub source: Source,
}

/// Source of a value that the file itself does not write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// Scene that the file names as its base.
    Base(String),
    /// Usual value, with its reason.
    Constant(&'static str),
    /// Formula for the value.
    Formula(&'static str),
}

impl Source {
    /// Returns the source as text, `from the base paper`.
    pub fn words(&self) -> String {
        match self {
            Self::Base(base) => format!("from the base {base}"),
            Self::Constant(why) => (*why).to_owned(),
            Self::Formula(formula) => (*formula).to_owned(),
        }
    }
}

/// Equality ignores the sources of values.
impl PartialEq for CheckedScene {
    fn eq(&self, other: &Self) -> bool {
        self.scene == other.scene
    }
}

impl Scene {
    /// Checks every value, each alone and then together.
    ///
    /// # Errors
    /// First fault: its keys, description and remedy.
    pub fn check(self) -> Result<CheckedScene, Fault> {
        check::check(&self)?;
        Ok(CheckedScene::unchecked(self))
    }
}

impl CheckedScene {
    /// Returns a copy with changes, checked again.
    ///
    /// # Errors
    /// Errors of [`Scene::check`].
    pub fn changed(&self, change: impl FnOnce(&mut Scene)) -> Result<Self, Fault> {
        self.changed_within(change, check::check)
    }

    /// Returns a copy with other solver settings. Checks only these, alone and with the values that they depend on.
    ///
    /// # Errors
    /// Errors of [`Scene::check`].
    pub fn with_solver(&self, change: impl FnOnce(&mut Solver)) -> Result<Self, Fault> {
        self.changed_within(|scene| change(&mut scene.solver), check::solver)
    }

    fn changed_within(
        &self,
        change: impl FnOnce(&mut Scene),
        check: impl FnOnce(&Scene) -> Result<(), Fault>,
    ) -> Result<Self, Fault> {
        let mut changed = self.clone();
        change(&mut changed.scene);
        if changed.scene != self.scene {
            check(&changed.scene)?;
        }
        Ok(changed)
    }

    /// Returns the number at a key, `None` for other values.
    pub fn number(&self, key: &str) -> Option<f64> {
        let table = Table::try_from(&self.scene).ok()?;
        lookup(&table, key).and_then(Value::as_float)
    }

    /// Returns the scene with another value of a number, without its uncertainty, checked again.
    ///
    /// # Errors
    /// A key without a number, or a value that the scene's checks refuse.
    pub fn with_number(&self, key: &str, value: f64) -> Result<Self, Fault> {
        let fault = |what: String| Fault {
            keys: vec![key.to_owned().into()],
            what,
            remedy: "give a key of this scene that holds a number".to_owned(),
        };
        let mut table = Table::try_from(&self.scene).map_err(|error| fault(error.to_string()))?;
        if lookup(&table, key).and_then(Value::as_float).is_none() {
            return Err(fault("holds no number".to_owned()));
        }
        let path: Vec<&str> = key.split('.').collect();
        insert(&mut table, &path, Value::Float(value));
        let changed: Scene = Value::Table(table)
            .try_into()
            .map_err(|error: toml::de::Error| fault(error.message().to_owned()))?;
        self.changed(|scene| {
            *scene = changed;
            scene.uncertain.remove(key);
        })
    }

    /// Checks a scene whose single values are in range, and stores the origins of its values.
    pub(crate) fn together(scene: Scene, origins: Vec<Origin>) -> Result<Self, Fault> {
        // m follows from R alone.
        let gives_circle = origins.iter().any(|origin| origin.key == "gear.shortening");
        check::together(&scene, gives_circle)?;
        let origins = origins.into();
        Ok(Self { scene, origins })
    }

    /// Returns the origins of values that the scene's file does not write, in the order of [`crate::KEYS`], except values
    /// that a later change has replaced.
    pub fn origins(&self) -> Vec<&Origin> {
        let now = Table::try_from(&self.scene).unwrap_or_default();
        let holds = |origin: &&Origin| lookup(&now, origin.key) == Some(&origin.value);
        self.origins.iter().filter(holds).collect()
    }

    /// Returns the unchecked scene, which may be changed.
    pub fn into_scene(self) -> Scene {
        self.scene
    }

    /// Accepts a scene that the checks refuse, for studies of published models with unphysical values (negative damping)
    /// and for tests of kernels. The caller is responsible for a run that ends.
    pub fn unchecked(scene: Scene) -> Self {
        Self {
            scene,
            origins: Arc::default(),
        }
    }
}

impl Deref for CheckedScene {
    type Target = Scene;

    fn deref(&self) -> &Scene {
        &self.scene
    }
}
