//! Numbers in messages and files.

use pinwheel_scene::internals::{above, below, short, written};

#[test]
fn roundings_stay_on_their_side() {
    assert_eq!(short(0.0131225849), "0.0131226");
    assert_eq!(short(2.0e11), "2e11");
    assert_eq!(short(16.0), "16");
    assert_eq!(written(0.1 + 0.2), "0.3");
    assert_eq!(written(2.0), "2.0", "a float in TOML");
    assert_eq!(above(0.006 + 0.0028), "0.0088");
    for value in [
        0.013_122_58,
        0.029_299_999,
        1.0e-7,
        12_345.678,
        9.999_99,
        0.0088,
    ] {
        assert!(
            below(value).parse::<f64>().unwrap() <= value,
            "{}",
            below(value)
        );
        assert!(
            above(value).parse::<f64>().unwrap() >= value,
            "{}",
            above(value)
        );
    }
}
