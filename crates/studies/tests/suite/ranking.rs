//! Lead of the native solver.

use pinwheel_engines::SharedModel;
use pinwheel_studies::bench::{CostAt, Entry};
use pinwheel_studies::internals::advantage;

fn entry(label: &str, track: SharedModel, cost: CostAt) -> Entry {
    Entry {
        label: label.to_owned(),
        track,
        cpu_s: Some(cost),
        rhs_calls: None,
    }
}

#[test]
fn the_lead_is_over_the_fastest_peer() {
    let own = SharedModel::OwnContact;
    let mut entries = vec![
        entry("a", SharedModel::Native, CostAt::Interpolated(0.5)),
        entry("b", SharedModel::Native, CostAt::Interpolated(0.25)),
        entry("c", SharedModel::Native, CostAt::MoreThan(0.01)),
        entry("slow", SharedModel::SharedLaw, CostAt::Interpolated(50.0)),
        entry("fast", SharedModel::SharedLaw, CostAt::Interpolated(25.0)),
        entry("other law", own, CostAt::MoreThan(1.0)),
    ];
    let lead = advantage(&entries).unwrap();
    assert_eq!((&*lead.native, &*lead.peer), ("b", "fast"));
    assert!((lead.ratio - 100.0).abs() < 1e-12 && !lead.at_least);

    // A peer stopped by the time limit may be the fastest: then the ratio is a bound.
    entries.push(entry(
        "cut off",
        SharedModel::SharedLaw,
        CostAt::MoreThan(5.0),
    ));
    let lead = advantage(&entries).unwrap();
    assert_eq!(lead.peer, "cut off");
    assert!((lead.ratio - 20.0).abs() < 1e-12 && lead.at_least);

    entries.push(entry("own", own, CostAt::Interpolated(2.5)));
    assert_eq!(advantage(&entries).unwrap().peer, "own");
    assert_eq!(advantage(&entries[..3]), None);
    assert_eq!(advantage(&entries[3..]), None);
}
