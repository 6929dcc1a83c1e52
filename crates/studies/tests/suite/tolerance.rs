//! Sensitivities, quantiles and yield of a sample.

use pinwheel_studies::internals::{clopper_pearson, figure, quantile};
use pinwheel_studies::rng::Rng;

/// Functions of uniform a and b with known indices: y = 3 a + b, and y = a^2, which has no linear part.
#[test]
fn published_sensitivities_of_known_functions() {
    let mut rng = Rng::new(7);
    let mut draw = || {
        (0..4000)
            .map(|_| rng.between(-1.0, 1.0))
            .collect::<Vec<f64>>()
    };
    let (a, b) = (draw(), draw());
    let keys = [
        ("a".to_owned(), vec![a.clone()]),
        ("b".to_owned(), vec![b.clone()]),
    ];
    let over = |f: &dyn Fn(f64, f64) -> f64| {
        let values: Vec<Option<f64>> = a.iter().zip(&b).map(|(a, b)| Some(f(*a, *b))).collect();
        figure("y", &values, &keys).expect("it varies")
    };
    let close = |actual: Option<f64>, is: f64| {
        let actual = actual.expect("a value");
        assert!((actual - is).abs() < 0.02, "{actual} is not {is}");
    };
    let line = over(&|a, b| 3.0 * a + b);
    assert_eq!(line.sensitivities[0].key, "a");
    close(line.sensitivities[0].coefficient, (0.9_f64).sqrt());
    close(line.sensitivities[1].coefficient, (0.1_f64).sqrt());
    close(line.sensitivities[0].first_order, 0.9);
    close(line.sensitivities[1].first_order, 0.1);
    close(line.linear, 1.0);
    let bowl = over(&|a, _| a * a);
    let of = |key: &str| bowl.sensitivities.iter().find(|s| s.key == key);
    close(bowl.linear, 0.0);
    close(of("a").and_then(|s| s.first_order), 1.0);
    close(of("b").and_then(|s| s.first_order), 0.0);
}

/// The largest of at least 59 runs exceeds the 95 % quantile with 95 % confidence (S. S. Wilks, Ann. Math. Stat. 12, 1941); with
/// 2.5 % on both sides, as here, of at least 72.
#[test]
fn published_quantiles_and_yield() {
    let ramp = |count: usize| (0..count).map(|k| k as f64).collect::<Vec<f64>>();
    assert_eq!(quantile(&ramp(71), 0.95).interval[1], None);
    assert_eq!(quantile(&ramp(72), 0.95).interval[1], Some(71.0));
    let median = quantile(&ramp(101), 0.5);
    assert_eq!(
        (median.value, median.interval),
        (50.0, [Some(40.0), Some(60.0)])
    );
    // Tabulated Clopper-Pearson interval of 8 in 10.
    let [low, high] = clopper_pearson(8, 10);
    assert!(
        (low - 0.4439).abs() < 1e-4 && (high - 0.9748).abs() < 1e-4,
        "{low} {high}"
    );
    assert_eq!(
        [clopper_pearson(0, 10)[0], clopper_pearson(10, 10)[1]],
        [0.0, 1.0]
    );
}
