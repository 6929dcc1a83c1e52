//! The tests of this crate as one program: linking is most of what a small test costs.

mod brute;
mod closest;
mod complex;
mod dual;
mod epitrochoid;
mod feet;
mod friction;
mod hertz;
mod lanes;
mod laws;
mod pin_law;
mod points;
mod published_impact;
mod published_rollers;
mod search;
