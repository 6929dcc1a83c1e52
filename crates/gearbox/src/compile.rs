//! From a checked scene to a [`Gearbox`].

use pinwheel_scene::channels::Channels;

use crate::contacts::Kernel;
use crate::geometry::Geometry;
use crate::scene::{CheckedScene, Start};
use crate::statics::Statics;
use crate::{Gearbox, GearboxError, Layout};

impl Gearbox {
    /// Compiles a checked scene.
    ///
    /// # Errors
    /// Parameters that only fail once the model is built (see [`GearboxError`]).
    pub fn new(scene: &CheckedScene) -> Result<Self, GearboxError> {
        Self::after(None, scene)
    }

    /// The same gearbox as [`new`](Self::new) gives, made with less work where one like it was made before.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn after(earlier: Option<&Self>, scene: &CheckedScene) -> Result<Self, GearboxError> {
        pinwheel_faults::compiled();
        let earlier = earlier.map(|gearbox| &gearbox.geometry);
        let geometry = Geometry::after(earlier, &scene.gear)?;
        let mut gearbox = Self {
            scene: scene.clone(),
            layout: Layout::of(&scene.gear),
            geometry,
            channels: Channels::of(scene).map_err(GearboxError::Channel)?,
            kernel: Kernel::default(),
            start: None,
        };
        gearbox.contact_field()?;
        if scene.drive.start == Start::Equilibrium {
            let start = Statics::new(&gearbox)?.moving()?;
            gearbox.start = Some(start);
        }
        Ok(gearbox)
    }
}
