//! The gearbox in motion on a page, from the time series that a study computed.

mod picture;

use pinwheel_studies::motion::Motion;

pub(crate) use picture::{Animation, markup};

use crate::study::Block;

/// Blocks of a gearbox's motion for a place beside the first screen.
pub(crate) fn aside(motion: Option<&Motion>) -> Vec<Block> {
    let drawn = motion.and_then(|motion| beside(std::slice::from_ref(motion)));
    let blocks = drawn.map(|block| vec![Block::heading("The gearbox in motion"), block]);
    blocks.unwrap_or_default()
}

/// Packs a motion for the page's script; `None` where there is nothing to show.
pub(crate) fn drawn(motion: &Motion) -> Option<Animation> {
    let title = motion.title.as_str();
    Animation::of(title, &motion.scene, &motion.time_series, motion.span_s)
}

/// Draws gearboxes side by side, over the same time; `None` where there is nothing to show.
pub(crate) fn beside(motions: &[Motion]) -> Option<Block> {
    let begin_s = motions.first()?.begin_s;
    let views: Vec<Animation> = motions.iter().filter_map(drawn).collect();
    (!views.is_empty()).then(|| Block::Html(markup(&views, begin_s)))
}
