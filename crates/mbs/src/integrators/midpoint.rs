//! The explicit midpoint rule, order 2 [Runge 1895].
//!
//! ```text
//! k1 = f(t, y)
//! k2 = f(t + h/2, y + h/2 k1)
//! y+ = y + h k2
//! ```

use super::{MethodInfo, Tableau};

pub(super) const TABLEAU: Tableau = Tableau {
    a: &[&[], &[0.5]],
    b: &[0.0, 1.0],
    c: &[0.0, 0.5],
};

pub(super) const INFO: MethodInfo = MethodInfo {
    name: "rk2-midpoint",
    summary: "explicit midpoint rule, second order, fixed step",
    order: 2,
    adaptive: false,
};
