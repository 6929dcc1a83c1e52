//! `pinwheel completions`: scripts for shells from the definition of the command line.

use crate::args;
use crate::failure::Failure;
use crate::screen;

pub(crate) fn completions(shell: clap_complete::Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut args::definition(), "pinwheel", &mut script);
    screen::show(&String::from_utf8_lossy(&script))
}
