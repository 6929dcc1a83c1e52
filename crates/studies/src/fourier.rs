//! The discrete Fourier transform of real samples.

use realfft::RealFftPlanner;

/// `|X_k|` of bin 0 to N/2.
pub(crate) fn moduli(mut samples: Vec<f64>) -> Vec<f64> {
    if samples.is_empty() {
        return samples;
    }
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(samples.len());
    let mut bins = plan.make_output_vec();
    // It fails only for buffers of other lengths than its own.
    if plan.process(&mut samples, &mut bins).is_err() {
        return Vec::new();
    }
    bins.iter().map(|bin| bin.norm()).collect()
}
