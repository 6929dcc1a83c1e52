//! Coefficients of RODAS5P [Steinebach 2023], in the variables of the implementation (see [`super::rodas5p`]).
//!
//! The tests at the end recover alpha and Gamma from them and check every condition of order 5, so a wrong digit is found.

/// Stages.
pub(super) const STAGES: usize = 8;
/// The diagonal of Gamma.
pub(super) const GAMMA: f64 = 0.211_937_563_194_290_14;

/// Arguments of the stages in the stages before, row by row; the last two add one stage each to the row above.
pub(super) const A: [&[f64]; STAGES - 2] = [
    &[],
    &[3.0],
    &[2.849_394_379_747_939, 0.458_422_422_044_639_23],
    &[
        -6.954_028_509_809_101,
        2.489_845_061_869_568,
        -10.358_996_098_473_584,
    ],
    &[
        2.802_998_627_562_896_4,
        0.507_246_473_622_820_6,
        -0.398_831_254_177_052_4,
        -0.047_211_872_304_046_41,
    ],
    &[
        -7.502_846_399_306_121,
        2.561_846_144_803_919,
        -11.627_539_656_261_098,
        -0.182_687_676_599_422_56,
        0.030_198_172_008_377_946,
    ],
];

/// Right-hand sides of the stages in the stages before, over h.
pub(super) const C: [&[f64]; STAGES] = [
    &[],
    &[-14.155_112_264_123_755],
    &[-17.972_960_358_859_52, -2.859_693_295_451_294],
    &[
        147.121_502_757_117_16,
        -1.412_214_027_182_13,
        71.689_402_513_023_58,
    ],
    &[
        165.435_170_248_716_76,
        -0.459_282_345_649_112_6,
        42.909_383_369_586_03,
        -5.961_986_721_573_306,
    ],
    &[
        24.854_864_614_690_072,
        -3.000_922_700_283_218_6,
        47.493_111_002_076_8,
        5.581_419_782_155_812_5,
        -0.661_069_182_524_947_1,
    ],
    &[
        30.912_732_140_285_99,
        -3.120_824_334_993_797_4,
        77.799_546_460_708_92,
        34.286_460_282_947_83,
        -19.097_331_116_725_623,
        -28.087_943_162_872_662,
    ],
    &[
        37.802_771_233_905_63,
        -3.257_196_902_907_227_6,
        112.269_188_494_963_27,
        66.934_723_124_404_7,
        -40.066_189_370_910_02,
        -54.667_802_628_779_68,
        -9.488_616_523_096_27,
    ],
];

/// Times of the stages, in steps.
pub(super) const TIMES: [f64; STAGES] = [
    0.0,
    0.635_812_689_582_870_4,
    0.409_579_839_339_753_5,
    0.976_930_672_506_071_6,
    0.428_840_360_955_866_4,
    1.0,
    1.0,
    1.0,
];

/// Weights of h df/dt: the row sums of Gamma.
pub(super) const D: [f64; STAGES] = [
    0.211_937_563_194_290_14,
    -0.423_875_126_388_580_27,
    -0.338_462_712_623_592_4,
    1.804_645_287_288_273_4,
    2.325_825_639_765_069,
    0.0,
    0.0,
    0.0,
];

/// Continuous extension of order 4: coefficients of the stages.
pub(super) const H: [[f64; STAGES]; 3] = [
    [
        25.948_786_856_663_858,
        -2.557_972_484_584_623_5,
        10.433_815_404_888_879,
        -2.367_925_102_268_520_4,
        0.524_948_541_321_073,
        1.124_108_831_045_040_4,
        0.427_287_619_443_187_4,
        -0.172_022_210_701_554_93,
    ],
    [
        -9.915_688_506_951_71,
        -0.968_994_459_411_515_4,
        3.043_803_724_297_845_3,
        -24.495_224_566_215_796,
        20.176_138_334_709_044,
        15.980_663_614_246_51,
        -6.789_040_303_419_874,
        -6.710_236_069_923_372,
    ],
    [
        11.419_903_575_922_262,
        2.887_964_514_613_699_4,
        72.921_379_959_960_29,
        80.125_118_346_226_43,
        -52.072_871_366_152_654,
        -59.789_936_252_667_29,
        -0.155_826_842_827_519_13,
        4.883_087_185_713_722,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    type Matrix = [[f64; STAGES]; STAGES];

    fn product(a: &Matrix, b: &Matrix) -> Matrix {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..STAGES).map(|k| a[i][k] * b[k][j]).sum())
        })
    }

    fn apply(a: &Matrix, x: &[f64; STAGES]) -> [f64; STAGES] {
        std::array::from_fn(|i| (0..STAGES).map(|j| a[i][j] * x[j]).sum())
    }

    /// Stages in the variables of the implementation are U = Gamma k, and its C is diag(1/gamma) - Gamma^-1.
    struct Method {
        gamma: Matrix,
        /// alpha = a Gamma.
        alpha: Matrix,
        /// a, with the two rows that repeat; its row of ones makes y+.
        a: Matrix,
    }

    fn method() -> Method {
        let entry = |rows: &[&[f64]], i: usize, j: usize| {
            rows.get(i)
                .and_then(|row| row.get(j))
                .copied()
                .unwrap_or(0.0)
        };
        // Gamma^-1 X = I by forward substitution.
        let mut gamma: Matrix = [[0.0; STAGES]; STAGES];
        for i in 0..STAGES {
            let mut row = [0.0; STAGES];
            row[i] = 1.0;
            for (j, above) in gamma[..i].iter().enumerate() {
                for (x, above) in row.iter_mut().zip(above) {
                    *x += entry(&C, i, j) * above;
                }
            }
            gamma[i] = row.map(|x| GAMMA * x);
        }
        let mut a: Matrix = [[0.0; STAGES]; STAGES];
        for (i, row) in a.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x = entry(&A, i.min(A.len() - 1), j);
                if i >= A.len() && (A.len() - 1..i).contains(&j) {
                    *x = 1.0;
                }
            }
        }
        Method {
            alpha: product(&a, &gamma),
            gamma,
            a,
        }
    }

    /// A rooted tree: its branches.
    #[derive(Clone)]
    struct Tree(Vec<Tree>);

    impl Tree {
        fn order(&self) -> usize {
            1 + self.0.iter().map(Tree::order).sum::<usize>()
        }

        fn density(&self) -> f64 {
            self.order() as f64 * self.0.iter().map(Tree::density).product::<f64>()
        }

        /// Elementary weight by stage: a single branch goes through beta = alpha + gamma, several through alpha
        /// [Hairer & Wanner 1996, IV.7].
        fn weight(&self, m: &Method) -> [f64; STAGES] {
            match &self.0[..] {
                [] => [1.0; STAGES],
                [one] => {
                    let below = one.weight(m);
                    let (a, g) = (apply(&m.alpha, &below), apply(&m.gamma, &below));
                    std::array::from_fn(|i| a[i] + g[i])
                }
                many => {
                    let mut all = [1.0; STAGES];
                    for branch in many {
                        let below = apply(&m.alpha, &branch.weight(m));
                        all.iter_mut().zip(below).for_each(|(x, y)| *x *= y);
                    }
                    all
                }
            }
        }
    }

    /// All trees of `order` vertices: 1, 1, 2, 4, 9.
    fn trees(order: usize) -> Vec<Tree> {
        fn forests(vertices: usize, largest: usize) -> Vec<Vec<Tree>> {
            if vertices == 0 {
                return vec![Vec::new()];
            }
            let mut found = Vec::new();
            for size in 1..=largest.min(vertices) {
                let same = trees(size);
                for rest in forests(vertices - size, size) {
                    // Branches of one size in the order of their list, or a tree would come twice.
                    let last = rest.first().filter(|r: &&Tree| r.order() == size);
                    let from = last.map_or(0, |r| {
                        let shape = |t: &Tree| format!("{:?}", shape(t));
                        same.iter().position(|t| shape(t) == shape(r)).unwrap_or(0)
                    });
                    for tree in &same[from..] {
                        let mut forest = vec![tree.clone()];
                        forest.extend(rest.iter().cloned());
                        found.push(forest);
                    }
                }
            }
            found
        }
        fn shape(tree: &Tree) -> Vec<String> {
            tree.0.iter().map(|b| format!("{:?}", shape(b))).collect()
        }
        forests(order - 1, order - 1)
            .into_iter()
            .map(Tree)
            .collect()
    }

    /// Largest residual of the conditions of one order for the weights of U.
    fn residual(m: &Method, weights: &[f64; STAGES], order: usize) -> f64 {
        let b: [f64; STAGES] =
            std::array::from_fn(|j| (0..STAGES).map(|i| weights[i] * m.gamma[i][j]).sum());
        let one = |tree: &Tree| {
            let sum: f64 = b.iter().zip(tree.weight(m)).map(|(b, w)| b * w).sum();
            (sum - 1.0 / tree.density()).abs()
        };
        trees(order).iter().map(one).fold(0.0, f64::max)
    }

    #[test]
    fn published_coefficients_have_order_5_and_4() {
        assert_eq!([1, 2, 3, 4, 5].map(|p| trees(p).len()), [1, 1, 2, 4, 9]);
        let m = method();
        // y+ adds the last stage to the argument of the last but one; the embedded solution is that argument.
        let mut step = m.a[STAGES - 1];
        let embedded = step;
        step[STAGES - 1] = 1.0;
        for order in 1..=5 {
            let (high, low) = (residual(&m, &step, order), residual(&m, &embedded, order));
            println!("order {order}: {high:.1e}, embedded {low:.1e}");
            // Rounding of the coefficients: measured at most 3e-14.
            assert!(high < 1e-12, "order {order}: {high:e}");
            assert!((low < 1e-12) == (order < 5), "embedded, {order}: {low:e}");
        }
        let ones = [1.0; STAGES];
        for i in 0..STAGES {
            let (time, slope) = (apply(&m.alpha, &ones)[i], apply(&m.gamma, &ones)[i]);
            assert!((time - TIMES[i]).abs() < 1e-13, "time of stage {i}: {time}");
            assert!((slope - D[i]).abs() < 1e-12, "df/dt of stage {i}: {slope}");
        }
    }

    /// y(theta) has the conditions of order 4 with theta^order/density.
    #[test]
    fn published_continuous_extension_has_order_4() {
        let m = method();
        let mut step = m.a[STAGES - 1];
        step[STAGES - 1] = 1.0;
        for share in [0.1, 0.5, 0.8] {
            let u = 1.0 - share;
            let weights: [f64; STAGES] = std::array::from_fn(|i| {
                share * (step[i] + u * (H[0][i] + share * (H[1][i] + share * H[2][i])))
            });
            let b: [f64; STAGES] =
                std::array::from_fn(|j| (0..STAGES).map(|i| weights[i] * m.gamma[i][j]).sum());
            for order in 1..=4_u8 {
                for tree in trees(order.into()) {
                    let sum: f64 = b.iter().zip(tree.weight(&m)).map(|(b, w)| b * w).sum();
                    let off = (sum - f64::powi(share, order.into()) / tree.density()).abs();
                    assert!(off < 1e-12, "share {share}, order {order}: {off:e}");
                }
            }
        }
    }
}
