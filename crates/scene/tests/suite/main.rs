//! Tests of scenes: keys, faults, presets, and derived quantities.

mod assumptions;
mod bearings;
mod body;
mod catalogue;
mod changes;
mod cranks;
mod derived;
mod edit;
mod families;
mod faults;
mod fuzz;
mod geometry;
mod keys;
mod load_profile;
mod number;
mod own;
mod presets;
mod profile;
mod quantity;
mod remedies;
mod scales;
mod select;
mod structure;
mod uncertain;
