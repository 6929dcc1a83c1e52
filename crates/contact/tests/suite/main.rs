//! Tests of this crate as one program, because linking dominates the cost of a small test.

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
