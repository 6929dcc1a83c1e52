//! Heun's method, order 2 [Heun 1900]: the paper's "2nd-order Runge-Kutta".
//!
//! ```text
//! k1 = f(t, y)
//! k2 = f(t + h, y + h k1)
//! y+ = y + h/2 (k1 + k2)
//! ```

use super::{FIXED, Family, MethodInfo, Tableau};

pub(super) const TABLEAU: Tableau = Tableau {
    a: &[&[], &[(0, 1.0)]],
    b: &[(0, 0.5), (1, 0.5)],
    c: &[0.0, 1.0],
};

pub(super) const INFO: MethodInfo = MethodInfo {
    name: "rk2",
    summary: "Heun, second order, fixed step (the paper's method)",
    order: 2,
    family: Family::Explicit,
    ..FIXED
};
