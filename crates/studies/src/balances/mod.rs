//! Figures of a gear by statics: balances over one period of the mesh, and data-sheet figures from them.
//!
//! ```text
//! poses ──> solve ──> mesh: pairs, sharing, pressure, bearings ──> branches: friction ──> figures, orders
//! ```

pub(crate) mod branches;
pub(crate) mod figures;
pub(crate) mod mesh;
pub(crate) mod orders;
pub(crate) mod poses;
pub(crate) mod solve;
pub(crate) mod spread;
