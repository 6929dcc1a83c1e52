//! Compares engines on one scene and keeps the page: `cargo run --release -p pinwheel-dynamics --example compare_engines`.
#![allow(clippy::print_stdout, reason = "a program that prints its figures")]

use std::error::Error;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use pinwheel::report::terminal::plain;
use pinwheel::studies::choice;
use pinwheel::studies::comparison::{self, Input};
use pinwheel::{Control, Progress, Provenance, pages};

fn main() -> Result<(), Box<dyn Error>> {
    let scene = pinwheel::load("paper", &["solver.duration_s = 0.03"])?;
    // All engines of this build and the recordings of those that it lacks: choice::engines(&[], &scene).
    let names = ["native-reduced", "native-lagrange", "native-resolved"];
    let engines = choice::engines(&names, &scene)?;
    let gearbox = pinwheel::compile(&scene)?;
    let input = Input {
        gearbox: &gearbox,
        engines: &engines,
        data: &[],
    };
    // Who wants to stop sets the flag; progress comes with every sample, of which the first of each piece is told.
    let stop = AtomicBool::new(false);
    let told = AtomicUsize::new(usize::MAX);
    let progress = |at: Progress<'_>| {
        if told.swap(at.done, Ordering::Relaxed) != at.done {
            println!("{} of {}: {}", at.done + 1, at.total, at.piece);
        }
    };
    let control = Control::new(&stop, &progress);
    let found = comparison::run(&input, &control)?;
    let text = pages::comparison::text(&scene, &found);
    println!("{}", plain(&text));

    // Time series, summary.json and the page, as the program writes them.
    let folder = std::env::temp_dir().join("pinwheel-compare-engines");
    std::fs::create_dir_all(&folder)?;
    let made = Provenance::here("the example compare_engines");
    found.write(&folder, &made)?;
    let page = pages::comparison::page(&found, &made);
    std::fs::write(folder.join("index.html"), page)?;
    println!("page: {}", folder.join("index.html").display());
    Ok(())
}
