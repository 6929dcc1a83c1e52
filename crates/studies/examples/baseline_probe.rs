//! probe
use pinwheel_studies::baseline::*;
use pinwheel_studies::{Control, Progress};
fn main() {
    let only: Vec<String> = std::env::args().skip(1).collect();
    let t0 = std::time::Instant::now();
    let last = std::cell::RefCell::new((String::new(), 0.0));
    let progress = |p: Progress<'_>| {
        let mut l = last.borrow_mut();
        let now = t0.elapsed().as_secs_f64();
        if now - l.1 > 0.5 {
            eprintln!("{:.1} s {}", now - l.1, l.0);
        }
        *l = (p.piece.to_owned(), now);
    };
    let never = std::sync::atomic::AtomicBool::new(false);
    let control = Control {
        cancel: &never,
        progress: &progress,
    };
    let made = Made {
        date: String::new(),
        commit: String::new(),
        version: String::new(),
        build: String::new(),
        vectors: String::new(),
        processor: String::new(),
        no_instructions: no_instructions(),
    };
    let options = Options {
        only,
        repeats: 1,
        ..Options::default()
    };
    match record(made.clone(), vec![], &options, &control) {
        Err(e) => println!("ERROR {e}"),
        Ok(b) => {
            for s in &b.scenes {
                let own: Vec<String> = s
                    .reference
                    .quantities
                    .iter()
                    .map(|q| format!("{:.0e}", q.own_error))
                    .collect();
                println!("{:28} own {}", s.scene, own.join(" "));
                for c in &s.cases {
                    let e: Vec<String> = c
                        .quantities
                        .iter()
                        .map(|q| format!("{:.1e}/{:.0e}", q.error, q.rounding))
                        .collect();
                    println!(
                        "   {:26} {} | {:?} {} {} {} t {:.1}",
                        c.choice,
                        e.join(" "),
                        c.costs.right_hand_sides,
                        c.costs.steps,
                        c.costs.rejections,
                        c.costs.newton_steps,
                        c.costs.time_ratio.unwrap_or(0.0)
                    );
                }
            }
            let dir = std::env::temp_dir().join("probe-baseline");
            std::fs::create_dir_all(&dir).unwrap();
            b.write(&dir).unwrap();
            eprintln!(
                "total {:.1} s; {}",
                t0.elapsed().as_secs_f64(),
                b.head.made.no_instructions
            );
            let b = Baseline::read(&dir).unwrap();
            let t0 = std::time::Instant::now();
            let c = check(
                &b,
                made,
                &Options {
                    repeats: 0,
                    ..options
                },
                &Control::quiet(),
            )
            .unwrap();
            println!(
                "{}\n check {:.1} s",
                table::text(&c),
                t0.elapsed().as_secs_f64()
            );
        }
    }
}
