//! Nothing: the package exists for its benches, `cargo bench -p pinwheel-benches`.
