//! Tests across crates, in one program: they share its build and the machine.

mod comments;
mod crossval_limits;
mod crossval_parry;
mod crossval_rapier;
mod dependencies;
mod hard;
mod own_gears;
mod random_gears;
