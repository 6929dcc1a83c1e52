//! Order conditions for the coefficients of RODAS5P.

use pinwheel_mbs::internals::{A, C, D, GAMMA, H, STAGES, TIMES};

type Matrix = [[f64; STAGES]; STAGES];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..STAGES).map(|k| a[i][k] * b[k][j]).sum()))
}

fn apply(a: &Matrix, x: &[f64; STAGES]) -> [f64; STAGES] {
    std::array::from_fn(|i| (0..STAGES).map(|j| a[i][j] * x[j]).sum())
}

/// Coefficients of the method. Stages in the implementation's variables are U = Gamma k, and its C is diag(1/gamma) - Gamma^-1.
struct Method {
    gamma: Matrix,
    /// Product alpha = a Gamma.
    alpha: Matrix,
    /// Matrix a, with the two rows that repeat; its row of ones gives y+.
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

/// Rooted tree, as a list of its branches.
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

/// Returns all trees of `order` vertices: 1, 1, 2, 4, 9.
fn trees(order: usize) -> Vec<Tree> {
    fn forests(vertices: usize, largest: usize) -> Vec<Vec<Tree>> {
        if vertices == 0 {
            return vec![Vec::new()];
        }
        let mut all = Vec::new();
        for size in 1..=largest.min(vertices) {
            let same = trees(size);
            for rest in forests(vertices - size, size) {
                // Branches of equal size in the order of their list, to avoid repeated trees.
                let last = rest.first().filter(|r: &&Tree| r.order() == size);
                let from = last.map_or(0, |r| {
                    let shape = |t: &Tree| format!("{:?}", shape(t));
                    same.iter().position(|t| shape(t) == shape(r)).unwrap_or(0)
                });
                for tree in &same[from..] {
                    let mut forest = vec![tree.clone()];
                    forest.extend(rest.iter().cloned());
                    all.push(forest);
                }
            }
        }
        all
    }
    fn shape(tree: &Tree) -> Vec<String> {
        tree.0.iter().map(|b| format!("{:?}", shape(b))).collect()
    }
    forests(order - 1, order - 1)
        .into_iter()
        .map(Tree)
        .collect()
}

/// Returns the largest residual of the conditions of one order for the weights of U.
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
    // y+ adds the last stage to the argument of the last but one; that argument is the embedded solution.
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

/// y(theta) satisfies the conditions of order 4 with theta^order/density.
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
