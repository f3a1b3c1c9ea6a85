// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/response_prior.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t kLines = 32;  // an input
constexpr double kLowest = 0.1;     // of the lower edge of the band

Complex response_at(const Body& body, std::size_t input, const Complex& step) {
  return signal::polynomial_at(body.numerators[input], step) /
         signal::polynomial_at(body.denominator, step);
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

// A linear path of one channel through the body's poles: a sign or a square of the channel has
// power above the channel's band.
bool is_path(const Effect& effect, const Body& body) {
  const ControlRole role = effect_kind(effect.kind).body_role(effect);
  const auto* path = std::get_if<control::Path>(&role);
  return path != nullptr && path->through_body && effect.channels.size() == 1 &&
         effect.coefficients.size() == body.order() + 1;
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

ResponsePrior::ResponsePrior(const Model& model, const Signals& signals, double noise) {
  for (const Effect& effect : model.effects) {
    if (!is_path(effect, model.body)) continue;
    const std::string& channel = effect.channels.front();
    const Signal& signal = signals.at(channel);
    const ExcitedBand band = excited_band(channel, signal.values, signal.mean, signals.rate_hz());
    if (!(band.low_hz < band.high_hz)) continue;
    const Body path{{difference_basis(effect.coefficients)}, model.body.denominator};
    const double likely = gain_in_band(path, 0, band, signals.rate_hz());
    if (!(likely > 0.0)) continue;
    for (std::size_t i = 0; i < kLines; ++i) {
      const double at_hz = frequency_of(i, band, signals.rate_hz());
      if (at_hz <= band.high_hz) continue;
      paths_.push_back({channel, step_of(at_hz, signals.rate_hz()), noise / likely});
    }
  }
}

template <class Visit>
void ResponsePrior::visit_paths(const Model& model, const Visit& line) const {
  Eigen::Index at = 1 + static_cast<Eigen::Index>(model.body.order());
  for (const auto& numerator : model.body.numerators) at += std::ssize(numerator);
  for (const Effect& effect : model.effects) {
    if (!effect.is_whole()) continue;
    if (is_path(effect, model.body)) {
      for (const PathLine& each : paths_) {
        if (each.channel == effect.channels.front()) line(effect.coefficients, at, each);
      }
    }
    at += std::ssize(effect.coefficients);
    at += std::ranges::count(effect.parameters, true, &Parameter::fitted);
  }
}

double ResponsePrior::error(const Model& model) const {
  double sum = 0.0;
  for (const Line& line : lines_) {
    sum +=
        std::norm(line.weight * (line.response - response_at(model.body, line.input, line.step)));
  }
  visit_paths(model, [&](const auto& coefficients, Eigen::Index, const PathLine& line) {
    sum += std::norm(line.weight * signal::polynomial_at(coefficients, 1.0 - line.step) /
                     signal::polynomial_at(model.body.denominator, line.step));
  });
  return sum;
}

void ResponsePrior::add(const Model& model, Eigen::MatrixXd& gram) const {
  add_lines_of_body(model.body, gram);
  add_lines_of_paths(model, gram);
}

// The response of a path is C / A with C = sum_i c_i D^i; 0 is assumed of it.
void ResponsePrior::add_lines_of_paths(const Model& model, Eigen::MatrixXd& gram) const {
  Eigen::VectorXcd row(gram.cols());
  const Eigen::Index denominators =
      1 + std::accumulate(
              model.body.numerators.begin(), model.body.numerators.end(), Eigen::Index{0},
              [](Eigen::Index sum, const auto& numerator) { return sum + std::ssize(numerator); });
  visit_paths(model, [&](const auto& coefficients, Eigen::Index at, const PathLine& line) {
    row.setZero();
    const Complex difference = 1.0 - line.step;
    const Complex denominator = signal::polynomial_at(model.body.denominator, line.step);
    const Complex response = signal::polynomial_at(coefficients, difference) / denominator;
    Complex power = line.weight / denominator;
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      row[at + static_cast<Eigen::Index>(i)] = power;
      power *= difference;
    }
    power = -line.weight * line.step * response / denominator;
    for (std::size_t j = 0; j < model.body.order(); ++j) {
      row[denominators + static_cast<Eigen::Index>(j)] = power;
      power *= difference;
    }
    row[gram.cols() - 1] = -line.weight * response;
    gram += (row.conjugate() * row.transpose()).real();
  });
}

void ResponsePrior::add_lines_of_body(const Body& body, Eigen::MatrixXd& gram) const {
  const Eigen::Index last = gram.cols() - 1;
  Eigen::VectorXcd row(gram.cols());
  for (const Line& line : lines_) {
    row.setZero();
    const Complex difference = 1.0 - line.step;
    const Complex denominator = signal::polynomial_at(body.denominator, line.step);
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
