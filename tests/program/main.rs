//! Tests of the program in use, in one test program: they share its build and the machine.

mod bad_input;
mod baseline;
mod bench;
mod commands;
mod crashes;
mod explore;
mod fmu;
mod foreign;
mod kept;
mod remedies;
mod safety;
mod solvers;
mod stability;
mod stages;
mod sweep;
