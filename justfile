# The commands of CONTRIBUTING.md under short names: `just` lists them.

_:
    @just --list

# All that a change must pass
ci:
    bash .ci/run

# Formatting and lints
lint:
    cargo fmt --all -- --check
    cargo clippy --workspace --all-targets --features crossval -- -D warnings

# The tests, or some by name
test *what:
    cargo test --features crossval {{ what }}

# The Python package as it is installed
python:
    python/check

# Every page in a browser
pages:
    cargo test --features browser --test browser

# Mutated inputs for so many seconds
fuzz seconds="60":
    PINWHEEL_FUZZ_S={{ seconds }} cargo test -p pinwheel-fuzz -- --nocapture

# Differences from the accepted results
baseline:
    cargo run --release -- baseline check

# Vectors of the law, and the benchmark, anew
vectors:
    cargo run --release -p pinwheel-law --example vectors -- reference/law-vectors
    cargo run --release -p pinwheel-studies --example benchmark -- reference/benchmark

# The site, in target/site
site:
    cargo build --release -p pinwheel-cli
    tools/site target/release/pinwheel

# Release archives in dist, and each tried
dist profile="release":
    tools/dist {{ profile }}
    tools/try-dist
