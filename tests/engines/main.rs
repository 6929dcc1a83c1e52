//! Tests across crates, in one program: they share its build and the machine.

mod budgets;
mod crossval_limits;
mod crossval_parry;
mod crossval_rapier;
mod dependencies;
mod hard;
mod instructions;
mod layout;
mod loops;
mod own_gears;
mod random_gears;
