//! Discrete Fourier transforms of real samples.

use realfft::RealFftPlanner;
pub use realfft::num_complex::Complex64;

/// Returns X_k of bins 0 to N/2, none without samples.
pub fn forward(mut samples: Vec<f64>) -> Vec<Complex64> {
    if samples.is_empty() {
        return Vec::new();
    }
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(samples.len());
    let mut bins = plan.make_output_vec();
    // Fails only for buffers of wrong length.
    let done = plan.process(&mut samples, &mut bins);
    done.map_or_else(|_| Vec::new(), |()| bins)
}

/// Returns the sums over all bins at `count` samples, not divided by their number; `bins` are those of [`forward`].
pub fn inverse(mut bins: Vec<Complex64>, count: usize) -> Vec<f64> {
    let plan = RealFftPlanner::<f64>::new().plan_fft_inverse(count);
    let mut samples = plan.make_output_vec();
    // Fails only for buffers of wrong length, or if the first or the last bin is not real.
    let done = plan.process(&mut bins, &mut samples);
    done.map_or_else(|_| Vec::new(), |()| samples)
}
