// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace stillhand::signal {

/// One-sided spectral densities of two records, README Eq. SG-8; vectors of segment/2 + 1 lines.
struct CrossSpectra {
  std::vector<double> frequency_hz;        ///< [Hz] 0 to rate / 2
  std::vector<double> s_xx;                ///< [unit_x^2/Hz]
  std::vector<double> s_yy;                ///< [unit_y^2/Hz]
  std::vector<std::complex<double>> s_xy;  ///< [unit_x unit_y/Hz], conj(X) Y
  double independent_averages = 0.0;       ///< n_d [-], Eq. SG-10
};

/// Welch's method, Eq. SG-8: Hann window, 50 % overlap, mean of each segment removed,
///
///   S_xy(f) = 2 / (rate sum w^2 K) sum_k conj(X_k(f)) Y_k(f)      (factor 1 at 0 and rate / 2)
///
/// Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15(2), 1967.  Pure; FFT of Eigen.
/// @param segment_samples  length of a segment, even, 8 to the length of the records
/// @throws stillhand::ConfigError when lengths differ or are too short, or the rate isn't positive.
CrossSpectra cross_spectra(const std::vector<double>& x, const std::vector<double>& y,
                           double rate_hz, std::size_t segment_samples);

/// Ordinary coherence [-] |S_xy|^2 / (S_xx S_yy), Eq. SG-9; 0 where a density is 0.
std::vector<double> coherence(const CrossSpectra& spectra);

/// Estimate of a frequency response with its uncertainty.
struct TransferEstimate {
  std::vector<double> frequency_hz;            ///< [Hz]
  std::vector<std::complex<double>> response;  ///< H [unit_y/unit_x]
  std::vector<double> coherence;               ///< [-]
  std::vector<double> magnitude_ci95;          ///< half width of 95 % interval over |H| [-]
  double independent_averages = 0.0;           ///< n_d [-]
};

/// H = S_xy / S_xx as MATLAB's tfestimate (paper III-A), Eq. SG-9, with the random error of Bendat
/// and Piersol, Eq. SG-10: 1.96 sqrt(1 - g^2) / (g sqrt(2 n_d)), g^2 the coherence; infinite where
/// the coherence is 0.  Good while it stays below about 0.3.
/// Source: Bendat and Piersol, Random Data, 4th ed., table 9.6.
TransferEstimate transfer_estimate(const CrossSpectra& spectra);

/// Fourier coefficient of one line with a whole number of cycles in the record, Eq. SG-11:
///
///   X = 2/N sum_n x[n] exp(-2 pi j k n / N),   A cos(2 pi k n/N + phi) gives A exp(j phi)
///
/// By direct summation with the phase reduced in integers; error below 1e-14 of max |x| for a
/// million samples.  @param cycles_in_record  k [-], 0 < k < N/2
/// @throws stillhand::ConfigError when k is outside.
std::complex<double> line_at(const std::vector<double>& x, std::int64_t cycles_in_record);

}  // namespace stillhand::signal
