//! Classical Runge-Kutta method, order 4 [Kutta 1901].
//!
//! ```text
//! k1 = f(t, y)                    k3 = f(t + h/2, y + h/2 k2)
//! k2 = f(t + h/2, y + h/2 k1)     k4 = f(t + h, y + h k3)
//! y+ = y + h/6 (k1 + 2 k2 + 2 k3 + k4)
//! ```

use super::{FIXED, Family, MethodInfo, Tableau};

pub(super) const TABLEAU: Tableau = Tableau {
    a: &[&[], &[(0, 0.5)], &[(1, 0.5)], &[(2, 1.0)]],
    b: &[
        (0, 1.0 / 6.0),
        (1, 1.0 / 3.0),
        (2, 1.0 / 3.0),
        (3, 1.0 / 6.0),
    ],
    c: &[0.0, 0.5, 0.5, 1.0],
};

pub(super) const INFO: MethodInfo = MethodInfo {
    name: "rk4",
    summary: "classical Runge-Kutta, fourth order, fixed step",
    order: 4,
    family: Family::Explicit,
    ..FIXED
};
