//! Law that engines can call for the time of a run.

use std::sync::Arc;

use pinwheel_gearbox::Gearbox;

use super::law::Law;
use super::mujoco::detach;
use crate::engine::Ending;

/// Law that engines can call until it is dropped.
pub struct Published {
    pub number: usize,
    pub law: Arc<Law>,
}

impl Published {
    /// Publishes the law of a gearbox.
    ///
    /// # Errors
    /// A gearbox without a law.
    pub fn new(gearbox: &Gearbox) -> Result<Self, Ending> {
        let (number, law) = Law::open(gearbox)?;
        Ok(Self { number, law })
    }
}

impl Drop for Published {
    fn drop(&mut self) {
        // However the run ended, by a panic too, MuJoCo must not call any more.
        detach(self.number);
        self.law.close();
    }
}
