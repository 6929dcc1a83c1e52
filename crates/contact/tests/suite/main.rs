//! The tests of this crate as one program: linking is most of what a small test costs.

mod brute;
mod feet;
mod lanes;
mod published_impact;
mod published_rollers;
