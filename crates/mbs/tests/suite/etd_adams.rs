//! Tests of the matrix exponential and of the history of `etd-adams`.

use pinwheel_mbs::Structure;
use pinwheel_mbs::internals::{
    Columns, Linear, Lu, Propagator, ROWS, padded, step_back, to_differences,
};

/// With more rows than a block the product equals that by rows, bit by bit.
#[test]
fn products_are_those_by_rows() {
    let (rows, columns) = (ROWS + 3, 7);
    let mut matrix = Columns::zero(rows, columns);
    let number = |k: usize| (1.7 * k as f64).sin();
    for i in 0..rows {
        for j in 0..columns {
            *matrix.entry_mut(i, j) = number(i * columns + j);
        }
    }
    let x: Vec<f64> = (0..4).map(|k| number(100 + k)).collect();
    let mut out = vec![0.0; padded(rows)];
    matrix.multiply(2, &x, &mut out);
    for (i, out) in out.iter().take(rows).enumerate() {
        let terms = x.iter().enumerate();
        let sum = terms.fold(0.0, |sum, (j, x)| sum + x * number(i * columns + 2 + j));
        assert_eq!(*out, sum, "row {i}");
    }
}

/// With more freedoms than rows of a block, a system of second order has the propagator of the equivalent first-order system,
/// and it can be inverted.
#[test]
fn upper_rows_give_the_lower_ones() {
    let (freedoms, terms, tau) = (ROWS + 1, 5, -0.7);
    let n = 2 * freedoms;
    let second = Structure::SecondOrder {
        is_leaf: vec![false; freedoms],
    };
    let number = |k: usize| (1.7 * k as f64).sin();
    let [full, halves] = [Structure::FirstOrder, second].map(|structure| {
        let mut linear = Linear::new(&structure, &vec![1.0; n]);
        let below = freedoms - linear.first;
        for i in 0..freedoms {
            if below > 0 {
                *linear.rows.entry_mut(i, freedoms + i) = 1.0;
            }
            for j in 0..n {
                *linear.rows.entry_mut(below + i, j) = number(n * i + j);
            }
        }
        linear.size = 20.0;
        let mut propagator = Propagator::new(&linear, terms);
        propagator.build(&linear, tau, 0.4);
        (linear, propagator)
    });
    for i in 0..n {
        for j in 0..n + terms * freedoms {
            let (k, c) = (
                j.saturating_sub(n) / freedoms,
                j.saturating_sub(n) % freedoms,
            );
            let other = if j < n { j } else { n + k * n + freedoms + c };
            let (a, b) = (halves.1.matrix.entry(i, j), full.1.matrix.entry(i, other));
            assert!((a - b).abs() < 1e-11, "{i}, {j}: {a} {b}");
        }
    }
    let known: Vec<f64> = (0..n + terms * freedoms).map(number).collect();
    let (mut x, mut out) = (vec![0.0; padded(n)], vec![0.0; padded(n)]);
    halves.1.advance(&known, &mut x);
    let mut back = Lu::new(n);
    assert!(halves.1.factor(&halves.0, &mut back));
    x.truncate(n);
    halves.1.retreat(&back, &known[n..], &mut x, &mut out);
    for (x, known) in x.iter().zip(&known) {
        assert!((x - known).abs() < 1e-9, "{x} {known}");
    }
}

/// A polynomial by its coefficients, by its differences at another distance, and by those one point earlier.
#[test]
fn differences_are_those_of_the_polynomial() {
    let (coefficients, share) = ([0.3, -1.2, 2.0, 0.7, -0.4], 0.6);
    let value = |s: f64| {
        let mut power = 1.0;
        let terms = coefficients.iter().zip(1..).map(|(b, k)| {
            let term = b * power;
            power *= s / f64::from(k);
            term
        });
        terms.sum::<f64>()
    };
    let difference = |at: f64, order: u32| {
        let mut weight = 1.0;
        let terms = (0..=order).map(|i| {
            let term = weight * value(share * (at - f64::from(i)));
            weight *= -f64::from(order - i) / f64::from(i + 1);
            term
        });
        terms.sum::<f64>()
    };
    // Two columns, the second of which is twice the first.
    let mut differences: Vec<f64> = coefficients.iter().flat_map(|b| [*b, 2.0 * b]).collect();
    to_differences(&mut differences, 2, share);
    for at in [0.0, -1.0, -2.0] {
        for (order, both) in (0..).zip(differences.chunks_exact(2)) {
            let exact = difference(at, order);
            assert!(
                (both[0] - exact).abs() < 1e-13,
                "{at} {order}: {both:?} {exact}"
            );
            assert!((both[1] - 2.0 * exact).abs() < 1e-13);
        }
        step_back(&mut differences, 2);
    }
}
