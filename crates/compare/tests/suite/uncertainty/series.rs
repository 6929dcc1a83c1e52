//! Coverage of the uncertainties of series and figures.

use super::anywhere;
use super::common::{Random, participant, time_series};
use pinwheel_compare::uncertainty::{Method, Norm, Source};
use pinwheel_compare::{Evidence, Ladder, Level, Rules, SharedModel, compare};
use pinwheel_timeseries::TimeSeries;

/// In every norm u covers the true error in 95 of 100 cases, and is not blunt. The errors of the levels have individual shapes
/// beside the common one.
#[test]
fn crossval_series_and_figures_are_covered() {
    let mut random = Random::new(11);
    let truth = time_series(1.0);
    let norms = [Norm::L2, Norm::Linf, Norm::Mean, Norm::Peak, Norm::Rms];
    let (mut honest, mut cases, mut ratios) = ([0usize; 5], [0usize; 5], vec![Vec::new(); 5]);
    for _ in 0..60 {
        let order = if random.between(0.0, 1.0) < 0.5 {
            2.0
        } else {
            4.0
        };
        let size = 10f64.powf(random.between(-6.0, -3.5));
        let (phase, rate) = (random.between(0.0, 6.0), random.between(20.0, 200.0));
        let mut at = |h: f64| {
            let (own, shift) = (random.between(-0.15, 0.15), random.between(0.0, 6.0));
            let mut time_series = TimeSeries::new(truth.time_s().to_vec()).unwrap();
            for (k, channel) in truth.channels().iter().enumerate() {
                let scale = channel.values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                let error = |t: f64| {
                    let common = (rate * t + phase + k as f64).sin();
                    size * h.powf(order) * scale * (common + own * (77.0 * t + shift).cos())
                };
                let values = channel
                    .values
                    .iter()
                    .zip(truth.time_s())
                    .map(|(v, &t)| v + error(t));
                time_series
                    .push(channel.name.clone(), values.collect())
                    .unwrap();
            }
            time_series
        };
        let finest = at(1.0);
        let levels = [2.0, 4.0].map(|refinement| Level {
            setting: 1e-5 * refinement,
            run: Ok(at(refinement)),
            wall_s: 1.0,
        });
        let ladder = Ladder {
            method: Method::Step { order, rough: None },
            finest: 1e-5,
            floor: 0.0,
            coarser: levels.to_vec(),
        };
        let list = [
            participant("a", SharedModel::Native, finest),
            participant("truth", SharedModel::Native, truth.clone()),
        ];
        let evidence = [
            Evidence::refinement("a", ladder),
            Evidence {
                engine: "truth".to_owned(),
                source: Source::Exact(0.0),
                is_final: None,
            },
        ];
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let comparison = compare(&anywhere(), &list, &rules).unwrap();
        for (entry, own) in comparison.pairs[0]
            .entries
            .iter()
            .zip(&comparison.engines[0].uncertainty)
        {
            let figures = |k: usize| {
                let figures = comparison.engines[k]
                    .figures
                    .iter()
                    .find(|f| f.window == entry.window)
                    .unwrap();
                figures.quantities[&entry.quantity]
            };
            let (a, b) = (figures(0), figures(1));
            let metrics = entry.metrics.as_ref().unwrap();
            let errors = [
                metrics.difference_rms.unwrap(),
                metrics.difference_max.unwrap(),
                (a.mean - b.mean).abs(),
                (a.peak - b.peak).abs(),
                (a.rms - b.rms).abs(),
            ];
            assert_eq!(own.quantity, entry.quantity);
            for (k, norm) in norms.iter().enumerate() {
                if let Some(u) = own.of(*norm).u() {
                    cases[k] += 1;
                    honest[k] += usize::from(u >= errors[k]);
                    ratios[k].push(u / errors[k]);
                }
            }
        }
    }
    for k in 0..5 {
        let mut of = std::mem::take(&mut ratios[k]);
        of.sort_by(f64::total_cmp);
        let (coverage, median) = (honest[k] as f64 / cases[k] as f64, of[of.len() / 2]);
        println!(
            "{:?}: {} cases, coverage {coverage:.3}, median u/error {median:.2}",
            norms[k], cases[k]
        );
        assert!(coverage >= 0.95, "{:?} {coverage}", norms[k]);
        assert!(median < 5.0, "{:?} {median}", norms[k]);
    }
}
