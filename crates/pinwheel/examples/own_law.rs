//! A contact law of one's own beside the paper's, dropped onto a pin's flank at rising speeds:
//! `cargo run --release -p pinwheel-dynamics --example own_law`.
//!
//! A law that scenes can name stands in the crate `contact`; this is the way to try one before.
#![allow(clippy::print_stdout, reason = "a program that prints its figures")]

use std::error::Error;

use pinwheel::contact::laws::{NormalLaw, PaperLaw, Ramp};
use pinwheel::contact::{HertzStiffness, Material};

/// Hertz's force with a damping that grows with the penetration: F = K delta^1.5 (1 + d v), never pulling.
struct Own {
    /// d, s/m.
    damping: f64,
}

impl Own {
    /// Normal force, N: stiffness in N/m^1.5, penetration in m, its rate in m/s.
    fn force(&self, stiffness: f64, penetration: f64, rate: f64) -> f64 {
        (stiffness * penetration * penetration.sqrt() * (1.0 + self.damping * rate)).max(0.0)
    }
}

/// Speed after over speed before of a mass (kg) that falls onto a fixed body at a speed (m/s).
fn restitution(mass: f64, speed: f64, force: impl Fn(f64, f64) -> f64) -> f64 {
    let (mut depth, mut rate, step) = (0.0, speed, 1e-9);
    loop {
        // The midpoint rule.
        let acceleration = |depth: f64, rate: f64| match depth > 0.0 {
            true => -force(depth, rate) / mass,
            false => 0.0,
        };
        let half = (
            depth + 0.5 * step * rate,
            rate + 0.5 * step * acceleration(depth, rate),
        );
        depth += step * half.1;
        rate += step * acceleration(half.0, half.1);
        if depth <= 0.0 {
            return -rate / speed;
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let scene = pinwheel::load("paper", &[])?;
    let (gear, contact) = (&scene.gear, &scene.contact);
    // Steel with the scene's multiplier, a pin in a hole of a disc.
    let steel = Material {
        young: 2.0e11,
        poisson: 0.3,
    };
    let hertz = HertzStiffness::new(steel, steel, contact.stiffness_multiplier);
    let stiffness = hertz.of_hole(gear.internal_sleeve_radius_m, gear.hole_radius_m);
    let paper = PaperLaw {
        damping: contact.damping_n_s_m,
        ramp: Ramp::new(contact.ramp_m),
    };
    let own = Own { damping: 0.5 };
    let mass = scene.mass.internal_sleeve.mass_kg;
    println!("K = {stiffness:.3e} N/m^1.5, {mass:.4} kg");
    println!("speed m/s   restitution: paper   own");
    for speed in [0.01, 0.03, 0.1, 0.3] {
        let by_paper = restitution(mass, speed, |depth, rate| {
            paper.force(stiffness, depth, rate)
        });
        let by_own = restitution(mass, speed, |depth, rate| own.force(stiffness, depth, rate));
        println!("{speed:9.2}   {by_paper:18.4}   {by_own:.4}");
    }
    Ok(())
}
