//! Materials of gears with their limits.

/// Material: name, E (Pa), Poisson's ratio, density (kg/m^3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Name in scenes and on the command line.
    pub name: &'static str,
    /// Young's modulus, Pa.
    pub young_pa: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Yield strength, Pa; for steel of a hardened part's core.
    pub yield_pa: f64,
    /// Largest product of pressure on the projected area and sliding speed under boundary lubrication, W/m^2.
    pub pressure_sliding_w_m2: Option<f64>,
    /// Coefficient of thermal expansion, 1/K.
    pub expansion_per_k: f64,
}

macro_rules! materials {
    ($($name:literal $young:literal, $poisson:literal, $density:literal, $yield:literal, $pv:expr, $expansion:literal;)*) => {
        &[$(Material {
            name: $name,
            young_pa: $young,
            poisson: $poisson,
            density_kg_m3: $density,
            yield_pa: $yield,
            pressure_sliding_w_m2: $pv,
            expansion_per_k: $expansion,
        }),*]
    };
}

/// Materials for catalogue data. Round values within the ranges of M. F. Ashby, Materials Selection in Mechanical Design,
/// 4th ed. (2011), appendix A; printed parts have less than their plastic. Products of pressure and sliding of leaded tin
/// bronze and of nylon: R. L. Mott, Machine Elements in Mechanical Design, table 16-1.
pub const MATERIALS: &[Material] = materials! {
    "steel" 2.1e11, 0.30, 7850.0, 7.0e8, None, 1.15e-5;
    "cast-iron" 1.7e11, 0.27, 7150.0, 2.0e8, None, 1.1e-5;
    "bronze" 1.1e11, 0.34, 8800.0, 1.5e8, Some(2.6e6), 1.75e-5;
    "aluminium" 7.0e10, 0.33, 2700.0, 2.4e8, None, 2.3e-5;
    "pom" 3.0e9, 0.35, 1410.0, 6.0e7, None, 1.1e-4;
    "nylon" 2.8e9, 0.40, 1140.0, 5.0e7, Some(1.05e5), 1.45e-4;
    "pla" 3.5e9, 0.36, 1240.0, 5.0e7, None, 1.3e-4;
};

/// Returns the material of that name.
pub fn material(name: &str) -> Option<&'static Material> {
    MATERIALS.iter().find(|material| material.name == name)
}
