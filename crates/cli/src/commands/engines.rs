//! `pinwheel engines`: what this build can compare.

use pinwheel::pages;
use pinwheel::studies::choice;

use crate::args::JsonArgs;
use crate::failure::Failure;
use crate::screen;

pub(crate) fn engines(args: &JsonArgs) -> Result<u8, Failure> {
    let listed = choice::listed();
    screen::show_or_json(args.json, &listed, || pages::engines::text(&listed)).map(|()| 0)
}
