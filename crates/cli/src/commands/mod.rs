//! Commands, one file for each or a few similar ones: arguments in, a study of the library, its files and its text out.

pub(crate) mod baseline;
pub(crate) mod bench;
pub(crate) mod compare;
pub(crate) mod design;
pub(crate) mod explore;
pub(crate) mod fmu;
mod idle;
pub(crate) mod open;
pub(crate) mod paper;
pub(crate) mod record;
pub(crate) mod run;
pub(crate) mod shell;
pub(crate) mod solver;
pub(crate) mod stability;
pub(crate) mod sweep;
pub(crate) mod tell;
