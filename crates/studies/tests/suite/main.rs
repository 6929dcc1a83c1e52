//! Tests of the studies, in one program: they share its build and the machine.

mod bench;
mod calibration;
mod data_set;
mod load_changes;
mod losses;
mod patience;
mod printed_drive;
mod published_paper;
mod records;
mod regress;
mod sampling;
mod studies;
mod sweep;
