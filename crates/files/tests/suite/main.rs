//! Tests of files: reading, messages, and attacks on what is written.

#[cfg(unix)]
mod attacks;
mod document;
mod error;
mod folder;
mod output;
mod suggest;
