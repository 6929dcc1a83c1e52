//! Animation of the gearbox on a page, from the time series of a study.

mod picture;

use pinwheel_studies::motion::Motion;

pub(crate) use picture::{Animation, markup};

use crate::study::Block;

/// Returns the animation beside the first screen.
pub(crate) fn aside(motion: Option<&Motion>) -> Vec<Block> {
    let drawn = motion.and_then(|motion| beside(std::slice::from_ref(motion)));
    let blocks = drawn.map(|block| vec![Block::heading("The gearbox in motion"), block]);
    blocks.unwrap_or_default()
}

/// Packs a motion for the page's script; `None` without samples.
pub(crate) fn drawn(motion: &Motion) -> Option<Animation> {
    let title = motion.title.as_str();
    Animation::of(title, &motion.scene, &motion.time_series, motion.span_s)
}

/// Draws gearboxes side by side over the same time; `None` without samples.
pub(crate) fn beside(motions: &[Motion]) -> Option<Block> {
    let begin_s = motions.first()?.begin_s;
    let views: Vec<Animation> = motions.iter().filter_map(drawn).collect();
    (!views.is_empty()).then(|| Block::Html(markup(&views, begin_s)))
}
