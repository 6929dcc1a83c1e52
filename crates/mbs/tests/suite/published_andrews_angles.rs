//! Andrews' squeezer in the Test Set's own seven angles and six loop equations, independent of this crate's bodies and joints:
//! it compares the integrators with known errors, and the two models with each other.

use nalgebra::{SMatrix, SVector};
use pinwheel_mbs::OdeSystem;
use pinwheel_mbs::integrators::{StepSettings, start};

use super::bounds;
use super::published;
use bounds::holds;
use published::{number, numbers, table, worst};

/// `[M G'; G 0][q''; lambda] = [f; -G' q' q']`, the index-1 form without stabilisation.
struct Angles;

impl OdeSystem for Angles {
    fn dimension(&self) -> usize {
        14
    }

    fn derivative(&mut self, _: f64, y: &[f64], dydt: &mut [f64]) {
        let [be, th, ga, ph, de, om, ep] = [0, 1, 2, 3, 4, 5, 6].map(|k| y[k]);
        let [bep, thp, gap, php, dep, omp, epp] = [7, 8, 9, 10, 11, 12, 13].map(|k| y[k]);
        let (m, i) = (
            [
                0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498,
            ],
            [
                2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5,
            ],
        );
        let (xb, yb, xc, yc, c0, l0, mom) =
            (-0.03635, 0.03273, 0.014, 0.072, 4530.0, 0.07785, 0.033);
        let (d, da, e, ea, rr, ra) = (0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092);
        let (ss, sa, sb, sc, sd) = (0.035, 0.01874, 0.01043, 0.018, 0.02);
        let (ta, tb, u, ua, ub, zf, zt, fa) = (
            0.02308, 0.00916, 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421,
        );
        let ((sibe, cobe), (sith, coth), (siga, coga)) = (be.sin_cos(), th.sin_cos(), ga.sin_cos());
        let ((siph, coph), (side, code), (siom, coom), (siep, coep)) =
            (ph.sin_cos(), de.sin_cos(), om.sin_cos(), ep.sin_cos());
        let (sibeth, cobeth) = (be + th).sin_cos();
        let (siphde, cophde) = (ph + de).sin_cos();
        let (siomep, coomep) = (om + ep).sin_cos();

        let mut a = SMatrix::<f64, 13, 13>::zeros();
        a[(0, 0)] =
            m[0] * ra * ra + m[1] * (rr * rr - 2.0 * da * rr * coth + da * da) + i[0] + i[1];
        a[(1, 0)] = m[1] * (da * da - da * rr * coth) + i[1];
        a[(1, 1)] = m[1] * da * da + i[1];
        a[(2, 2)] = m[2] * (sa * sa + sb * sb) + i[2];
        a[(3, 3)] = m[3] * (e - ea) * (e - ea) + i[3];
        a[(4, 3)] = m[3] * ((e - ea) * (e - ea) + zt * (e - ea) * siph) + i[3];
        a[(4, 4)] = m[3] * (zt * zt + 2.0 * zt * (e - ea) * siph + (e - ea) * (e - ea))
            + m[4] * (ta * ta + tb * tb)
            + i[3]
            + i[4];
        a[(5, 5)] = m[5] * (zf - fa) * (zf - fa) + i[5];
        a[(6, 5)] = m[5] * ((zf - fa) * (zf - fa) - u * (zf - fa) * siom) + i[5];
        a[(6, 6)] = m[5] * ((zf - fa) * (zf - fa) - 2.0 * u * (zf - fa) * siom + u * u)
            + m[6] * (ua * ua + ub * ub)
            + i[5]
            + i[6];
        let (xd, yd) = (sd * coga + sc * siga + xb, sd * siga - sc * coga + yb);
        let length = (xd - xc).hypot(yd - yc);
        let pull = -c0 * (length - l0) / length;
        let (fx, fy) = (pull * (xd - xc), pull * (yd - yc));
        let mut b = SVector::<f64, 13>::zeros();
        b[0] = mom - m[1] * da * rr * thp * (thp + 2.0 * bep) * sith;
        b[1] = m[1] * da * rr * bep * bep * sith;
        b[2] = fx * (sc * coga - sd * siga) + fy * (sd * coga + sc * siga);
        b[3] = m[3] * zt * (e - ea) * dep * dep * coph;
        b[4] = -m[3] * zt * (e - ea) * php * (php + 2.0 * dep) * coph;
        b[5] = -m[5] * u * (zf - fa) * epp * epp * coom;
        b[6] = m[5] * u * (zf - fa) * omp * (omp + 2.0 * epp) * coom;
        // Rows of G: all six share P = r e^{i beta} - d e^{i(beta + Theta)}.
        for k in 0..3 {
            a[(7 + 2 * k, 0)] = -rr * sibe + d * sibeth;
            a[(7 + 2 * k, 1)] = d * sibeth;
            a[(8 + 2 * k, 0)] = rr * cobe - d * cobeth;
            a[(8 + 2 * k, 1)] = -d * cobeth;
        }
        (a[(7, 2)], a[(8, 2)]) = (-ss * coga, -ss * siga);
        (a[(9, 3)], a[(10, 3)]) = (-e * cophde, -e * siphde);
        (a[(9, 4)], a[(10, 4)]) = (-e * cophde + zt * side, -e * siphde - zt * code);
        (a[(11, 5)], a[(12, 5)]) = (zf * siomep, -zf * coomep);
        (a[(11, 6)], a[(12, 6)]) = (zf * siomep - u * coep, -zf * coomep - u * siep);
        for row in 0..13 {
            for column in 0..row {
                a[(column, row)] = a[(row, column)];
            }
        }
        let (w1, w2) = (bep * bep, (bep + thp) * (bep + thp));
        let common = [
            rr * cobe * w1 - d * cobeth * w2,
            rr * sibe * w1 - d * sibeth * w2,
        ];
        let (w4, w6) = ((php + dep) * (php + dep), (omp + epp) * (omp + epp));
        let own = [
            [-ss * siga * gap * gap, ss * coga * gap * gap],
            [
                -e * siphde * w4 - zt * code * dep * dep,
                e * cophde * w4 - zt * side * dep * dep,
            ],
            [
                -zf * coomep * w6 - u * siep * epp * epp,
                -zf * siomep * w6 + u * coep * epp * epp,
            ],
        ];
        for (k, own) in own.iter().enumerate() {
            b[7 + 2 * k] = common[0] + own[0];
            b[8 + 2 * k] = common[1] + own[1];
        }
        let x = a.lu().solve(&b);
        dydt[..7].copy_from_slice(&y[7..]);
        match x {
            Some(x) => dydt[7..].copy_from_slice(&x.as_slice()[..7]),
            None => dydt[7..].fill(f64::NAN),
        }
    }
}

fn initial() -> Vec<f64> {
    let mut y = vec![
        -0.061_713_890_014_276_5,
        0.0,
        0.455_279_819_163_070_4,
        0.222_668_390_165_885_88,
        0.487_364_979_543_842_55,
        -0.222_668_390_165_885_88,
        1.230_547_444_549_821_2,
    ];
    y.resize(14, 0.0);
    y
}

fn error(method: &str, step: f64, tolerance: f64) -> f64 {
    let data = table("andrews");
    let end = number(&data, "time_s");
    let settings = StepSettings { step, tolerance };
    let mut run = start(method, settings, 0.0, &initial()).unwrap();
    while run.time() < end * (1.0 - 1e-12) {
        run.step(&mut Angles).unwrap();
    }
    let mut y = vec![0.0; 14];
    run.interpolate(&mut Angles, end, &mut y);
    worst(&y[..7], &numbers(&data, "q"))
}

/// Order and size of the errors; the model of bodies and joints has nearly the same.
#[test]
fn fixed_steps_have_their_order_here_too() {
    // Measured at 1e-5 and 5e-6 s: 2.98e-5, 8.3e-6; 7.0e-9, 4.3e-10.
    for (method, order, limit) in [("rk2", 2.0, 6e-5), ("rk4", 4.0, 1.5e-8)] {
        let (coarse, fine) = (error(method, 1e-5, 1e-9), error(method, 5e-6, 1e-9));
        holds(method, "error", coarse, ..limit);
        // The next term of the error is not small yet for the second order: 1.77 is observed.
        let observed = (coarse / fine).log2();
        holds(method, "order", observed, order - 0.35..order + 0.35);
    }
}

#[test]
fn dopri5_solves_it_to_the_published_digits() {
    // Measured 1.4e-5, 8.4e-8, 4.1e-10; the published values themselves are 1.4e-9 off.
    for (tolerance, limit) in [(1e-6, 4e-5), (1e-8, 2.5e-7), (1e-10, 1.2e-9)] {
        let actual = error("dopri5", 1e-5, tolerance);
        let what = format!("error at a tolerance of {tolerance:e}");
        holds("dopri5", &what, actual, ..limit);
    }
}
