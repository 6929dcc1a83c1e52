//! Units of columns, which their names end in, and other units of foreign columns with their factors.

use std::f64::consts::PI;

macro_rules! units {
    ($($suffix:literal $label:literal: $($unit:literal $factor:expr),*;)*) => {
        &[$(($suffix, $label, &[$(($unit, $factor)),*])),*]
    };
}

/// Suffix of Pinwheel's names, unit for people, and units as people write them without blanks, each with its factor.
type Row = (&'static str, &'static str, &'static [(&'static str, f64)]);

/// Units of columns; longer suffixes first, as `_n_m` ends in `_m`. 1 lbf = 4.4482216152605 N, 1 ft = 0.3048 m, 1 in = 0.0254
/// m, 1 kgf = 9.80665 N, 1 ozf = 1 lbf / 16, all exact.
const UNITS: &[Row] = units! {
    "_n_m_per_arcmin" "N m/arcmin": ;
    "_n_m15" "N/m^1.5": "N/m^1.5" 1.0, "N/mm^1.5" 31_622.776_601_683_792;
    "_arcmin" "arcmin": "arcmin" 1.0, "arcsec" 1.0 / 60.0, "deg" 60.0, "rad" 10_800.0 / PI, "mrad" 10.8 / PI;
    "_n_m" "N m": "Nm" 1.0, "N*m" 1.0, "Nmm" 1e-3, "N*mm" 1e-3, "mNm" 1e-3, "kNm" 1e3, "Ncm" 1e-2,
        "lbf*ft" 1.355_817_948_331_400_4, "lbf*in" 0.112_984_829_027_616_7, "kgf*cm" 0.098_066_5, "ozf*in" 0.007_061_551_814_226_044;
    "_rad_s2" "rad/s\u{b2}": ;
    "_rad_s" "rad/s": "rad/s" 1.0, "deg/s" PI / 180.0, "rpm" PI / 30.0, "RPM" PI / 30.0, "1/min" PI / 30.0, "rev/min" PI / 30.0,
        "rev/s" 2.0 * PI;
    "_m_s2" "m/s\u{b2}": ;
    "_m_s" "m/s": "m/s" 1.0, "mm/s" 1e-3, "um/s" 1e-6;
    "_kg" "kg": ;
    "_pa" "Pa": ;
    "_hz" "Hz": ;
    "_rad" "rad": "rad" 1.0, "radian" 1.0, "mrad" 1e-3, "deg" PI / 180.0, "degree" PI / 180.0, "\u{b0}" PI / 180.0,
        "arcmin" PI / 10_800.0, "arcsec" PI / 648_000.0, "rev" 2.0 * PI, "turn" 2.0 * PI;
    "_n" "N": "N" 1.0, "newton" 1.0, "mN" 1e-3, "kN" 1e3, "lbf" 4.448_221_615_260_5, "lb" 4.448_221_615_260_5,
        "kgf" 9.806_65, "kp" 9.806_65, "ozf" 4.448_221_615_260_5 / 16.0, "oz" 4.448_221_615_260_5 / 16.0;
    "_w" "W": "W" 1.0, "kW" 1e3, "mW" 1e-3, "Nmm/s" 1e-3;
    "_j" "J": ;
    "_m" "m": "m" 1.0, "meter" 1.0, "mm" 1e-3, "cm" 1e-2, "um" 1e-6, "\u{b5}m" 1e-6, "nm" 1e-9, "in" 0.0254, "ft" 0.3048;
    "_s" "s": "s" 1.0, "sec" 1.0, "second" 1.0, "seconds" 1.0, "ms" 1e-3, "us" 1e-6, "\u{b5}s" 1e-6, "ns" 1e-9, "min" 60.0, "h" 3600.0;
};

/// Returns the part of a name before the unit, and the unit for people; empty if unknown.
pub fn stem_and_unit(name: &str) -> (&str, &'static str) {
    let stem = |suffix: &str| name.strip_suffix(suffix).filter(|stem| !stem.is_empty());
    let mut known = UNITS.iter();
    let entry = known.find_map(|(suffix, label, _)| Some((stem(suffix)?, *label)));
    entry.unwrap_or((name, ""))
}

/// Returns the factor from `unit` to the unit of the column `name` (without its final number).
///
/// # Errors
/// Suitable units; none if the name ends in no known unit.
pub fn factor(name: &str, unit: &str) -> Result<f64, Vec<&'static str>> {
    let stem = crate::group_of(name).0;
    let stem = stem.strip_suffix("_*").unwrap_or(stem);
    let known = UNITS.iter().find(|(suffix, ..)| stem.ends_with(suffix));
    let list = known.map_or(&[][..], |(.., list)| list);
    let wanted = unit.replace(char::is_whitespace, "");
    let wanted = wanted.replace('\u{b7}', "*").replace('\u{3bc}', "\u{b5}");
    let product = || {
        let parts = unit.split([' ', '*', '-', '\u{b7}', '\u{22c5}']);
        let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
        let ([one, other], true) = (parts.as_slice(), stem.ends_with("_n_m")) else {
            return None;
        };
        // `in*lb` is as common as `lb*in`.
        let of = |force, arm| Some(factor("_n", force).ok()? * factor("_m", arm).ok()?);
        of(one, other).or_else(|| of(other, one))
    };
    let entry = list.iter().find(|(name, _)| *name == wanted);
    (entry.map(|(_, factor)| *factor).or_else(product))
        .ok_or_else(|| list.iter().map(|(name, _)| *name).collect())
}

/// Returns one turn in the unit of the column `name`; `None` unless it is an angle.
pub fn turn(name: &str) -> Option<f64> {
    factor(name, "rad").ok()?;
    factor(name, "deg").ok().map(|degree| 360.0 * degree)
}
