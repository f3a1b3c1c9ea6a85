// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/core/fitting/response_prior.hpp"

#include <cmath>
#include <numbers>

namespace stillhand::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t kLines = 32;  // an input
constexpr double kLowest = 0.1;     // of the lower edge of the band

Complex polynomial(const std::vector<double>& coefficients, const Complex& step) {
  Complex sum = 0.0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) sum = sum * step + *c;
  return sum;
}

Complex response_at(const Body& body, std::size_t input, const Complex& step) {
  return polynomial(body.numerators[input], step) / polynomial(body.denominator, step);
}

// From a tenth of the band's lower edge to half the rate, evenly on a logarithmic axis.
double frequency_of(std::size_t line, const ExcitedBand& band, double rate_hz) {
  const double low_hz = std::max(kLowest * band.low_hz, 1e-3 * rate_hz / kLines);
  const double share = static_cast<double>(line) / (kLines - 1);
  return low_hz * std::pow(0.5 * rate_hz / low_hz, share);
}

Complex step_of(double frequency_hz, double rate_hz) {
  return std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz / rate_hz);
}

// Evenly over the band.
double line_in(const ExcitedBand& band, std::size_t line) {
  return band.low_hz + static_cast<double>(line) / (kLines - 1) * (band.high_hz - band.low_hz);
}

// Root mean square over lines within the band.
double gain_in_band(const Body& body, std::size_t input, const ExcitedBand& band, double rate_hz) {
  double sum = 0.0;
  for (std::size_t i = 0; i < kLines; ++i) {
    sum += std::norm(response_at(body, input, step_of(line_in(band, i), rate_hz)));
  }
  return std::sqrt(sum / kLines);
}

}  // namespace

Body scaled_to(const Body& other, const Body& body, const std::vector<ExcitedBand>& bands,
               double rate_hz) {
  Body scaled = body;
  for (std::size_t input = 0; input < body.numerators.size(); ++input) {
    const ExcitedBand& band = bands.at(input);
    double product = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < kLines; ++i) {
      const Complex step = step_of(line_in(band, i), rate_hz);
      const Complex response = response_at(body, input, step);
      product += (std::conj(response) * response_at(other, input, step)).real();
      square += std::norm(response);
    }
    if (!(square > 0.0)) continue;
    for (double& b : scaled.numerators[input]) b *= product / square;
  }
  return scaled;
}

ResponsePrior::ResponsePrior(const Body& body, const std::vector<ExcitedBand>& bands,
                             double rate_hz, double noise, double spread) {
  for (std::size_t input = 0; input < body.numerators.size(); ++input) {
    const ExcitedBand& band = bands.at(input);
    if (!(band.low_hz < band.high_hz)) continue;
    const double likely = spread * gain_in_band(body, input, band, rate_hz);
    if (!(likely > 0.0)) continue;
    for (std::size_t i = 0; i < kLines; ++i) {
      const double at_hz = frequency_of(i, band, rate_hz);
      if (at_hz >= band.low_hz && at_hz <= band.high_hz) continue;
      const Complex step = step_of(at_hz, rate_hz);
      lines_.push_back({input, step, response_at(body, input, step), noise / likely});
    }
  }
}

double ResponsePrior::error(const Body& body) const {
  double sum = 0.0;
  for (const Line& line : lines_) {
    sum += std::norm(line.weight * (line.response - response_at(body, line.input, line.step)));
  }
  return sum;
}

void ResponsePrior::add(const Body& body, Eigen::MatrixXd& gram) const {
  const Eigen::Index last = gram.cols() - 1;
  Eigen::VectorXcd row(gram.cols());
  for (const Line& line : lines_) {
    row.setZero();
    const Complex difference = 1.0 - line.step;
    const Complex denominator = polynomial(body.denominator, line.step);
    const Complex response = response_at(body, line.input, line.step);
    // B = sum_i d_i D^i and A = 1 + q^-1 sum_j g_j D^j, Eq. DG-8.
    Eigen::Index at = 1;  // behind the offset
    for (std::size_t input = 0; input < body.numerators.size(); ++input) {
      Complex power = line.weight / denominator;
      for (std::size_t i = 0; i < body.numerators[input].size(); ++i) {
        if (input == line.input) row[at] = power;
        power *= difference;
        ++at;
      }
    }
    Complex power = -line.weight * line.step * response / denominator;
    for (std::size_t j = 0; j < body.order(); ++j) {
      row[at++] = power;
      power *= difference;
    }
    row[last] = line.weight * (line.response - response);
    gram += (row.conjugate() * row.transpose()).real();
  }
}

}  // namespace stillhand::diagnosis
