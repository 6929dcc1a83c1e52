//! Writes and reads time series, and finds the strongest orders of the driver's torque:
//! `cargo run --release -p pinwheel-dynamics --example read_courses`.
#![allow(clippy::print_stdout, reason = "a program that prints its figures")]

use std::error::Error;
use std::f64::consts::TAU;

use pinwheel::TimeSeries;
use pinwheel::compare::quantities::INPUT_TORQUE;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = pinwheel::load(
        "paper",
        &["solver.duration_s = 0.24", "drive.start = \"equilibrium\""],
    )?;
    let file = std::env::temp_dir().join("pinwheel-timeseries.csv");
    pinwheel::run(&scene, "native")?
        .run
        .time_series
        .save_csv(&file)?;

    // Any CSV with a column time_s; names end in their unit, numbered ones make a group.
    let time_series = TimeSeries::load_csv(&file)?;
    println!(
        "{}: {} samples of {} columns, {} ring pins",
        file.display(),
        time_series.len(),
        time_series.channels().len(),
        time_series.group("external_sleeve_force_n").len()
    );

    // Amplitude at multiples of the input's speed, over the last turn.
    let turn_s = TAU / scene.drive.input_speed_rad_s.abs();
    let end = scene.solver.duration_s;
    let window = time_series.window(end - turn_s, end);
    let time = &time_series.time_s()[window.clone()];
    let torque = &time_series.channel(INPUT_TORQUE).ok_or("no torque")?[window];
    let mut orders: Vec<(u32, f64)> = (1..=60)
        .map(|order| {
            let sum = time.iter().zip(torque).fold((0.0, 0.0), |sum, (t, value)| {
                let (sine, cosine) = (TAU * f64::from(order) * t / turn_s).sin_cos();
                (sum.0 + value * cosine, sum.1 + value * sine)
            });
            (order, 2.0 * sum.0.hypot(sum.1) / time.len() as f64)
        })
        .collect();
    orders.sort_by(|a, b| b.1.total_cmp(&a.1));
    for (order, amplitude) in &orders[..3] {
        println!("order {order} of the input: {amplitude:.4} N m");
    }
    Ok(())
}
