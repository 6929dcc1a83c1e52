//! Every method on mechanisms with published solutions, at one accuracy each:
//! `cargo bench -p pinwheel-benches --bench mechanisms`.
//!
//! Lagrange form with projection. `crates/mbs/tests/suite/published_mechanisms.rs` holds the solutions against the
//! published ones.

#[path = "../../mbs/tests/suite/mechanisms/mod.rs"]
mod mechanisms;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use pinwheel_mbs::Stabilisation;
use pinwheel_mbs::integrators::{METHODS, StepSettings};

use mechanisms::{andrews, four_bars, pendulum};

fn solve(criterion: &mut Criterion) {
    // Problem, end (s), fixed step (s).
    let problems = [
        (pendulum(), 10.0, 1e-3),
        (four_bars(2), 10.0, 4e-3),
        (four_bars(40), 1.0, 4e-3),
        (andrews(), 0.03, 1e-5),
    ];
    for (problem, end_s, step) in problems {
        let mut group = criterion.benchmark_group(&problem.name);
        group.sample_size(10);
        let settings = StepSettings {
            step,
            tolerance: 1e-6,
        };
        for method in METHODS {
            let solve = || {
                problem
                    .solve(Stabilisation::Projection, method.name, settings, &[end_s])
                    .expect("every method solves it")
            };
            group.bench_function(method.name, |b| b.iter(|| black_box(solve())));
        }
        group.finish();
    }
}

criterion_group!(benches, solve);
criterion_main!(benches);
