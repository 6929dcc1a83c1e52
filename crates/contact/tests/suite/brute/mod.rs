//! Depth below the curve by brute force: slow, simple, and independent of the searches that it verifies.

use pinwheel_contact::{Complex, Epitrochoid};

/// Returns the depth of `p` below the curve, m: its distance from the curve, above 0 inside.
pub(crate) fn depth(curve: &Epitrochoid, p: Complex) -> f64 {
    let radial = radial_depth(curve, p);
    let distance = distance(curve, p, radial.abs());
    if radial > 0.0 { distance } else { -distance }
}

/// Largest difference between the parameter of a point of the curve and its polar angle: asin(e/R), and e/R = m/zk.
fn swing(curve: &Epitrochoid) -> f64 {
    (1.0 / f64::from(curve.lobes() + 1)).asin()
}

/// Returns the radius of the curve at the polar angle of `p` less that of `p`. The polar angle grows with the parameter (m <
/// 1), so the sign distinguishes inside from outside.
fn radial_depth(curve: &Epitrochoid, p: Complex) -> f64 {
    let (mut low, mut high) = (p.arg() - swing(curve), p.arg() + swing(curve));
    for _ in 0..60 {
        let a = 0.5 * (low + high);
        if curve.at(a).position.cross(p) > 0.0 {
            low = a;
        } else {
            high = a;
        }
    }
    curve.at(low).position.norm() - p.norm()
}

/// Returns the least distance from the curve, m, known to be at most `bound`: a dense scan of all polar angles that can be so
/// near, with every minimum refined by golden section.
fn distance(curve: &Epitrochoid, p: Complex, bound: f64) -> f64 {
    const PER_LOBE: u32 = 200;
    let step = std::f64::consts::TAU / f64::from(PER_LOBE * curve.lobes());
    let half = if bound < p.norm() {
        (bound / p.norm()).asin() + swing(curve)
    } else {
        std::f64::consts::PI
    };
    let distance = |a: f64| (p - curve.at(a).position).norm();
    let first = p.arg() - half - 2.0 * step;
    let count = (2.0 * half / step).ceil() as usize + 5;
    let scan: Vec<f64> = (0..count)
        .map(|k| distance(first + k as f64 * step))
        .collect();
    let minima = (1..count - 1).filter(|&k| scan[k] <= scan[k - 1] && scan[k] <= scan[k + 1]);
    minima
        .map(|k| {
            let at = first + k as f64 * step;
            golden(&distance, at - step, at + step)
        })
        .fold(f64::INFINITY, f64::min)
}

/// Returns the least value of `f` between two bounds around one minimum.
fn golden(f: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let (mut x, mut y) = (high - SHARE * (high - low), low + SHARE * (high - low));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..70 {
        if fx < fy {
            (high, y, fy) = (y, x, fx);
            x = high - SHARE * (high - low);
            fx = f(x);
        } else {
            (low, x, fx) = (x, y, fy);
            y = low + SHARE * (high - low);
            fy = f(y);
        }
    }
    fx.min(fy)
}
