//! `pinwheel laws`: the contact laws a scene can name.

use pinwheel::pages;

use crate::args::JsonArgs;
use crate::failure::Failure;
use crate::screen;

pub(crate) fn laws(args: &JsonArgs) -> Result<u8, Failure> {
    screen::show_or_json(args.json, &pages::laws::json(), pages::laws::text).map(|()| 0)
}
