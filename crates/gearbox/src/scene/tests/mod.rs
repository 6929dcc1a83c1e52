//! Tests of the scene as a whole: presets, faults, fuzzing.

mod faults;
mod fuzz;
mod presets;
