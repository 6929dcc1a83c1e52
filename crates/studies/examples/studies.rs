//! Prints the studies: `studies atlas [SCENE...] | horizon SCENE... | drift SCENE | published | paper`.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program that prints its tables"
)]

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;
use pinwheel_studies::{Control, Progress, divergence, drift, paper, published, stability};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let never = std::sync::atomic::AtomicBool::new(false);
    let clock = std::time::Instant::now();
    let progress = |p: Progress<'_>| {
        eprintln!(
            "{:6.1} s  {}/{} {}",
            clock.elapsed().as_secs_f64(),
            p.done,
            p.total,
            p.piece
        );
    };
    let control = Control {
        cancel: &never,
        progress: &progress,
    };
    let (what, names) = args.split_first().ok_or("say which study")?;
    let json = match what.as_str() {
        "atlas" => {
            let mut options = stability::Options::default();
            if !names.is_empty() {
                options.scenes = names.to_vec();
            }
            serde_json::to_string_pretty(&stability::run(&options, &control)?)?
        }
        "horizon" => {
            for name in names {
                match divergence::horizon(
                    &Gearbox::new(&Scene::load(name, &[])?)?,
                    divergence::STEP_RAD,
                    &mut |_| false,
                ) {
                    Ok(found) => println!(
                        "{name}: {:?} largest {:.1e} last {:.1e}",
                        found.horizon_s, found.largest_share, found.last_share
                    ),
                    Err(error) => println!("{error}"),
                }
            }
            return Ok(());
        }
        "drift" => serde_json::to_string_pretty(&drift::measure(
            &Scene::load(&names[0], &[])?.into_scene(),
            &control,
        )?)?,
        "limits" => {
            let mut scene = Scene::load("paper", &[])?.into_scene();
            scene.solver.duration_s = 0.05;
            let mut found = Vec::new();
            for step in [1e-5, 5e-6] {
                for switch in published::LIMITED {
                    found.push(published::limit(&scene, switch, step, &control)?);
                }
            }
            serde_json::to_string_pretty(&found)?
        }
        "published" => {
            let mut scene = Scene::load("paper", &[])?.into_scene();
            scene.solver.duration_s = 0.3;
            serde_json::to_string_pretty(&published::run(&scene, &published::DAMPINGS, &control)?)?
        }
        "paper" => serde_json::to_string_pretty(&paper::run(
            &paper::Options {
                figures: names.to_vec(),
                peer: None,
            },
            &control,
        )?)?,
        other => return Err(format!("no study `{other}`").into()),
    };
    println!("{json}");
    Ok(())
}
