//! The paper's claims with our figures and verdicts, as the Markdown table of `docs/claims.md`:
//! `cargo run --release -p pinwheel-gearbox --example claims > docs/claims.md`.
#![allow(clippy::print_stdout)]

use pinwheel_gearbox::claims::{Verdict, claims, judge};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("# The paper's claims\n");
    println!("Computed by `cargo run --release -p pinwheel-gearbox --example claims`; texts from");
    println!("`reference/published/paper.toml`, which also says how each is judged.\n");
    println!("| claim | where | our figure | verdict | remark |\n|---|---|---|---|---|");
    for claim in claims()? {
        let (figure, verdict) = match judge(&claim)? {
            Some(judged) => (judged.figure.clone(), words(judged.verdict)),
            None => ("not judged here".to_owned(), "-"),
        };
        println!(
            "| {} | {} | {figure} | {verdict} | {} |",
            claim.claim, claim.place, claim.remark
        );
    }
    Ok(())
}

fn words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Conditional => "holds under a condition",
        Verdict::DoesNotHold => "does not hold",
        Verdict::Meaningless => "has no meaning",
    }
}
