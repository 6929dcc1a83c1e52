//! The study on a terminal: largest steps, scene by scene.

use pinwheel_report::terminal::{self, TITLE, styled};
use pinwheel_studies::stability::Atlas;

use super::maps;

/// The largest step of each method, scene by scene; without the place of the page.
#[must_use]
pub fn text(atlas: &Atlas) -> String {
    format!(
        "{}\n{}\nLargest step with the right picture; of methods with a tolerance, the forces' error.",
        styled(TITLE, "stability"),
        terminal::table(&maps::steps(atlas))
    )
}
