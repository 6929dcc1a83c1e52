//! Native runs of presets, and distances between them.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::Kernel;
use pinwheel_gearbox::native::{self, NativeRun};
use pinwheel_scene::{Override, Scene};

pub(crate) fn run(preset: &str, kernel: Kernel, sets: &[(&str, &str)]) -> NativeRun {
    let sets: Vec<Override> = sets.iter().map(|&(k, v)| Override::new(k, v)).collect();
    let mut gearbox = Gearbox::new(&Scene::load(preset, &sets).unwrap()).unwrap();
    gearbox.kernel = kernel;
    native::run(&gearbox, &mut |_| false)
        .unwrap()
        .finished()
        .unwrap()
}

/// Returns the relative L2 distance of all pin forces jointly.
pub(crate) fn distance(a: &NativeRun, b: &NativeRun) -> f64 {
    let (mut difference, mut size) = (0.0, 0.0);
    for channel in b.time_series.channels() {
        if channel.name.contains("sleeve_force") {
            let values = a.time_series.channel(&channel.name).unwrap();
            for (a, b) in values.iter().zip(&channel.values) {
                difference += (a - b) * (a - b);
                size += b * b;
            }
        }
    }
    f64::sqrt(difference / size)
}
