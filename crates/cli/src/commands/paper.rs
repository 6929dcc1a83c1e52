//! `pinwheel paper`: every figure and claim of the paper, recomputed, on one page.

use pinwheel::pages;
use pinwheel::studies::StudyError;
use pinwheel::studies::paper::{self, Options};

use crate::args::PaperArgs;
use crate::failure::Failure;
use crate::folder::Folder;
use crate::progress::watched;

pub(crate) fn paper(args: &PaperArgs) -> Result<(), Failure> {
    let figures = args.figures.clone();
    let folder = Folder::of(&args.out, "paper", "")?;
    let mut peer = None;
    if figures.is_empty() || figures.iter().any(|f| f == "10") {
        let result = watched(|control| paper::peer(args.against.as_deref(), control));
        peer = result.map_err(|error| match error {
            StudyError::Ended { .. } => {
                Failure::engine(format!("{error}; choose another with --against"))
            }
            error => error.into(),
        })?;
    }
    let options = Options { figures, peer };
    let result = watched(|control| paper::run(&options, control)).map_err(|error| match error {
        StudyError::Cancelled => Failure::stopped(),
        error => Failure::engine(format!(
            "the paper's figures cannot be computed: {error}; leave the figure out with --figures"
        )),
    })?;
    let origin = folder.write(|dir, origin| result.write(dir, &options, origin))?;
    let page = pages::paper::page(&result, &origin);
    folder.show(&page, &pages::paper::text(&result))
}
