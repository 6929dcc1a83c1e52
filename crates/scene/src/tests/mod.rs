//! Tests of the scene as a whole: presets, faults, fuzzing.

mod changes;
mod faults;
mod fuzz;
mod own;
mod presets;
mod remedies;
mod uncertain;
