//! `pinwheel completions` and `pinwheel man`: what shells and `man` read, from the definition of the command line.

use std::io::Write as _;
use std::path::Path;

use crate::args;
use crate::failure::Failure;
use crate::folder::replace_all;
use crate::screen;

pub(crate) fn completions(shell: clap_complete::Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut args::definition(), "pinwheel", &mut script);
    screen::show(&String::from_utf8_lossy(&script))
}

pub(crate) fn man(out: Option<&Path>) -> Result<(), Failure> {
    let page = |command: &clap::Command| -> Result<String, Failure> {
        let mut text = Vec::new();
        let written = clap_mangen::Man::new(command.clone())
            .render(&mut text)
            .and_then(|()| text.flush());
        written.map_err(|error| Failure::input(format!("the man page cannot be made: {error}")))?;
        Ok(String::from_utf8_lossy(&text).into_owned())
    };
    let mut program = args::definition();
    program.build();
    let Some(dir) = out else {
        return screen::show(&page(&program)?);
    };
    let mut pages = vec![(dir.join("pinwheel.1"), page(&program)?)];
    for command in program.get_subcommands() {
        let name = format!("pinwheel-{}", command.get_name());
        // Beside the program's own page it needs its whole name.
        let named = command.clone().name(name.clone());
        pages.push((dir.join(format!("{name}.1")), page(&named)?));
    }
    let ours = |content: &[u8]| String::from_utf8_lossy(content).contains("\n.TH pinwheel");
    replace_all(&pages, &ours)
}
