//! Styles and scripts that every page carries, embedded when the program is built.

/// What the pages' frame needs.
pub(crate) struct Assets {
    pub(crate) plot_css: &'static str,
    pub(crate) css: &'static str,
    pub(crate) plot_js: &'static str,
    pub(crate) charts_js: &'static str,
    pub(crate) packed_js: &'static str,
    pub(crate) shell_js: &'static str,
}

pub(crate) const ASSETS: Assets = Assets {
    plot_css: include_str!("../assets/vendor/uplot/uPlot.min.css"),
    css: include_str!("../assets/report.css"),
    plot_js: include_str!("../assets/vendor/uplot/uPlot.iife.min.js"),
    charts_js: include_str!("../assets/charts.js"),
    packed_js: include_str!("../assets/packed.js"),
    shell_js: include_str!("../assets/shell.js"),
};
