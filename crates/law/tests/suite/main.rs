//! Tests of the law as a library, and from foreign programs.

mod c;
mod ffi;
mod vectors;
