//! Discrete Fourier transform of real samples.

use realfft::RealFftPlanner;

/// Returns `|X_k|` of bins 0 to N/2.
pub(crate) fn moduli(mut samples: Vec<f64>) -> Vec<f64> {
    if samples.is_empty() {
        return samples;
    }
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(samples.len());
    let mut bins = plan.make_output_vec();
    // Fails only for buffers of wrong length.
    if plan.process(&mut samples, &mut bins).is_err() {
        return Vec::new();
    }
    bins.iter().map(|bin| bin.norm()).collect()
}
