//! Pieces of work on several threads.

use pinwheel_studies::internals::map;

#[test]
fn every_piece_once_and_none_after_an_error() {
    for threads in [0, 1, 2, 7] {
        let (all, error) = map(threads, 20, || (), |(), k| Ok::<_, ()>(k));
        assert_eq!((all, error), ((0..20).map(Some).collect(), None));
        let (some, error) = map(threads, 1000, || (), |(), k| (k != 3).then_some(k).ok_or(k));
        assert_eq!(error, Some(3));
        assert!(some.iter().flatten().count() <= 3 + 7, "{threads}");
    }
}
