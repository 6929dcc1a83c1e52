//! Tests of the law as a library, and as foreign programs meet it.

mod c;
mod ffi;
mod vectors;
