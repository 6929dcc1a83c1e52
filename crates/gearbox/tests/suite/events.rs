//! Events between two samples.

use pinwheel_gearbox::energy::EnergyAccount;
use pinwheel_gearbox::internals::Event;

fn words(from: f64, to: f64, breaks: &[f64]) -> String {
    let word = |due: &Event| match due {
        Event::Entry(_) => 'e',
        Event::Break(..) => 'B',
        Event::Sample(_) => 's',
    };
    let mut list = vec![Event::Sample(f64::NAN)];
    Event::list(&mut list, from, to, breaks, 1e-5);
    assert!(list.windows(2).all(|p| p[0].time() <= p[1].time()));
    list.iter().map(word).collect()
}

#[test]
fn breaks_come_between_entries_and_before_their_sample() {
    assert_eq!(words(0.0, 1e-4, &[]), "s");
    assert_eq!(words(0.0, 1e-3, &[2e-3]), "eeeeeeeees");
    assert_eq!(words(0.0, 1e-4, &[3e-5]), "eeBeees");
    // On the sample up to rounding, from either side; the next interval then begins there.
    for at in [1e-4, 1e-4 + 1e-17, 1e-4 - 1e-17] {
        assert_eq!(words(0.0, 1e-4, &[at]), "eeBs");
        assert_eq!(words(1e-4, 2e-4, &[at]), "ees");
    }
    assert_eq!(words(0.0, 1e-4, &[3e-5, 3.1e-5]), "eeBeeeBeees");
    assert_eq!(words(0.0, 0.0, &[]), "s");
}

#[test]
fn a_run_without_breaks_has_the_entries_it_always_had() {
    let mut due = Vec::new();
    Event::list(&mut due, 1e-4, 3.5e-4, &[], 1e-5);
    let times: Vec<f64> = due.into_iter().map(Event::time).collect();
    let plain = EnergyAccount::between(1e-4, 3.5e-4, 1e-5, 1);
    assert_eq!(times, plain.chain([3.5e-4]).collect::<Vec<_>>());
}
