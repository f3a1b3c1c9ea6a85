// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/verdict/control_response.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/close_the_loop/verdict/control_laws.hpp"
#include "services/core/cancellation/control_model_filter.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/modes.hpp"
#include "services/core/identification/polynomial.hpp"
#include "services/core/identification/rate_conversion.hpp"
#include "services/core/signal/decompositions.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::close_the_loop {
namespace {

using diagnosis::Effect;
using Complex = std::complex<double>;
using cancellation::ControlModelFilter;

constexpr Eigen::Index kPoints = 241;  // of a response, each with a real and an imaginary part
constexpr double kOuterWeight = 0.2;
// At 1 kHz, 36 Hz: a body without poles cannot lead.
constexpr double kPoleOfStatic = 0.8;

// Eq. CL-1: z' = z^(rate/1000 Hz).
std::vector<double> carried_poles(const std::vector<double>& denominator, double rate_hz) {
  const double share = rate_hz / kControlRateHz;
  const std::vector<double> reversed(denominator.rbegin(), denominator.rend());
  std::vector<Complex> poles = identification::roots(reversed);
  for (Complex& z : poles) {
    constexpr double kLeast = 1e-3;
    const bool turns = std::abs(z.imag()) > 1e-12;
    z = std::polar(std::pow(std::max(std::abs(z), kLeast), share),
                   turns ? std::arg(z) * share : 0.0);
  }
  const identification::Polynomial ascending = identification::from_roots(poles);
  return {ascending.rbegin(), ascending.rend()};
}

// Without the poles that the canceller finds too slow, Eq. CC-4: in a body of too high an order its
// own zeros cancel them.  None: no pole is, or all are.
std::optional<std::vector<double>> without_slow_poles(const std::vector<double>& denominator,
                                                      double rate_hz) {
  const std::vector<double> reversed(denominator.rbegin(), denominator.rend());
  std::vector<Complex> poles = identification::roots(reversed);
  const double longest =
      static_cast<double>(cancellation::kMaxSettle_ticks) * rate_hz / kControlRateHz;
  const auto slow = [&](const Complex& z) { return std::pow(std::abs(z), longest) > 0.01; };
  if (std::erase_if(poles, slow) == 0 || poles.empty()) return std::nullopt;
  const identification::Polynomial ascending = identification::from_roots(poles);
  return std::vector<double>{ascending.rbegin(), ascending.rend()};
}

// A mode in addition to the body, at the model's own rate.
struct ModeOf {
  std::vector<double> factors;
  std::vector<double> denominator;
};

std::vector<ModeOf> modes_of(const diagnosis::Model& model) {
  std::vector<ModeOf> modes;
  for (const Effect& effect : model.effects) {
    const diagnosis::ControlRole role = diagnosis::effect_kind(effect.kind).body_role(effect);
    if (const auto* mode = std::get_if<diagnosis::control::Mode>(&role)) {
      modes.push_back(
          {factors_of(effect),
           diagnosis::mode_denominator(mode->frequency_hz, mode->damping_ratio, model.rate_hz)});
    }
  }
  return modes;
}

// Poles of Pade's approximation of order 4 to a delay, at the control rate: with zeros of their own
// a path is late by as much.  1: no delay.
std::vector<double> delay_poles(double delay_s) {
  if (delay_s < kControlPeriod_s) return {1.0};
  // Roots of 1 + x/2 + 3 x^2/28 + x^3/84 + x^4/1680.
  constexpr Complex kRoots[] = {{-5.7924211, 1.7344683}, {-4.2075788, 5.3148361}};
  std::vector<double> product{1.0};
  for (const Complex& root : kRoots) {
    const Complex z = std::exp(root * kControlPeriod_s / delay_s);
    product = diagnosis::product(product, {1.0, -2.0 * z.real(), std::norm(z)});
  }
  return product;
}

// Body and modes as one difference model, from the first input.
identification::DifferenceModel all_of(const diagnosis::Model& model) {
  using diagnosis::product;
  std::vector<double> numerator = model.body.numerators.front();
  std::vector<double> denominator = model.body.denominator;
  for (const ModeOf& mode : modes_of(model)) {
    // c_0 (1 - q^-1) + c_1 over the mode.
    const double c0 = mode.factors.at(0);
    const std::vector<double> of_mode = product({c0 + mode.factors.at(1), -c0}, denominator);
    numerator = product(numerator, mode.denominator);
    denominator = product(denominator, mode.denominator);
    for (std::size_t i = 0; i < of_mode.size(); ++i) numerator[i] += of_mode[i];
  }
  return {model.rate_hz, numerator, denominator};
}

// The points at which a response is met.
class Grid {
 public:
  explicit Grid(const ControlOptions& options) : options_(options) {}
  [[nodiscard]] double frequency_hz(Eigen::Index row) const {
    return options_.upper_hz * static_cast<double>(row) / (kPoints - 1.0);
  }
  [[nodiscard]] bool in_band(Eigen::Index row) const {
    return frequency_hz(row) >= options_.low_hz && frequency_hz(row) <= options_.high_hz;
  }
  [[nodiscard]] double turn(Eigen::Index row) const {
    return kTwoPi * frequency_hz(row) / kControlRateHz;
  }

 private:
  const ControlOptions& options_;
};

// Weighted least squares on real and imaginary parts, columns scaled; the solution by powers of
// D = 1 - q^-1.
std::vector<double> nearest_differences(const std::vector<double>& denominator,
                                        const std::vector<Complex>& target, bool late,
                                        const Grid& grid) {
  const std::size_t order = denominator.size() - 1;
  const auto columns = static_cast<Eigen::Index>(late ? order : order + 1);
  Eigen::MatrixXd matrix(2 * kPoints, columns);
  Eigen::VectorXd right(2 * kPoints);
  for (Eigen::Index row = 0; row < kPoints; ++row) {
    const double weight = grid.in_band(row) ? 1.0 : kOuterWeight;
    const double w = grid.turn(row);
    const Complex delay = std::polar(1.0, -w);
    Complex column = weight / polynomial_at(denominator, w) * (late ? delay : 1.0);
    for (Eigen::Index i = 0; i < columns; ++i) {
      matrix(2 * row, i) = column.real();
      matrix(2 * row + 1, i) = column.imag();
      column *= 1.0 - delay;
    }
    right[2 * row] = weight * target[static_cast<std::size_t>(row)].real();
    right[2 * row + 1] = weight * target[static_cast<std::size_t>(row)].imag();
  }
  const Eigen::RowVectorXd norms = matrix.colwise().norm();
  matrix.array().rowwise() /= norms.array();
  const Eigen::VectorXd x = signal::least_squares(matrix, right);
  std::vector<double> differences(static_cast<std::size_t>(columns));
  for (Eigen::Index i = 0; i < columns; ++i) {
    differences[static_cast<std::size_t>(i)] = x[i] / norms[i];
  }
  return differences;
}

std::vector<double> impulse_response(const std::vector<double>& c, const std::vector<double>& a,
                                     std::size_t samples) {
  std::vector<double> h(samples, 0.0);
  for (std::size_t n = 0; n < samples; ++n) {
    if (n < c.size()) h[n] = c[n];
    for (std::size_t j = 1; j < a.size() && j <= n; ++j) h[n] -= a[j] * h[n - j];
  }
  return h;
}

}  // namespace

Complex polynomial_at(const std::vector<double>& c, double turn_rad) {
  return signal::polynomial_at(c, std::polar(1.0, -turn_rad));
}

std::vector<std::vector<double>> possible_denominators(const diagnosis::Model& model) {
  const std::vector<double> late = delay_poles(input_delay_s(model));
  const auto with_delay = [&](std::vector<double> denominator) {
    const bool fits = denominator.size() + late.size() - 2 <= ControlModelFilter::kMaxOrder;
    return fits ? diagnosis::product(denominator, late) : denominator;
  };
  const auto with_modes = [&](std::vector<double> denominator) {
    for (const ModeOf& mode : modes_of(model)) {
      denominator = diagnosis::product(denominator, carried_poles(mode.denominator, model.rate_hz));
    }
    return with_delay(std::move(denominator));
  };
  std::vector<std::vector<double>> all{
      with_modes(carried_poles(model.body.denominator, model.rate_hz))};
  if (const auto quick = without_slow_poles(model.body.denominator, model.rate_hz)) {
    all.push_back(with_modes(carried_poles(*quick, model.rate_hz)));
  }
  if (model.body.order() == 0) all.push_back(with_modes({1.0, -kPoleOfStatic}));
  const auto add_fitted = [&](const identification::DifferenceModel& to_fit, const auto& extended) {
    try {
      all.push_back(extended(identification::to_control_rate(to_fit).model.denominator));
    } catch (const ConfigError&) {  // no fit: one possibility less
    }
  };
  add_fitted({model.rate_hz, model.body.numerators.front(), model.body.denominator}, with_modes);
  add_fitted(all_of(model), with_delay);
  return all;
}

Complex body_response(const diagnosis::Model& model, std::size_t k, double frequency_hz) {
  const double w = kTwoPi * frequency_hz / model.rate_hz;
  return polynomial_at(model.body.numerators[k], w) / polynomial_at(model.body.denominator, w);
}

Complex mode_response(const diagnosis::Model& model, std::size_t k, double frequency_hz) {
  const double w = kTwoPi * frequency_hz / model.rate_hz;
  Complex sum = 0.0;
  for (const ModeOf& mode : modes_of(model)) {
    const Complex difference = 1.0 - std::polar(1.0, -w);
    sum += (mode.factors.at(2 * k) * difference + mode.factors.at(2 * k + 1)) /
           polynomial_at(mode.denominator, w);
  }
  return sum;
}

bool has_modes(const diagnosis::Model& model) { return !modes_of(model).empty(); }

double input_delay_s(const diagnosis::Model& model) {
  double delay_s = 0.0;
  for (const Effect& effect : model.effects) {
    const diagnosis::EffectKind& kind = diagnosis::effect_kind(effect.kind);
    if (std::holds_alternative<diagnosis::control::InputDelay>(kind.body_role(effect))) {
      delay_s += diagnosis::delay_in_part(effect, 0.0);
    }
  }
  return delay_s;
}

NumeratorFit fit_numerator(const std::vector<double>& denominator, const Response& wanted,
                           bool late, const ControlOptions& options) {
  const Grid grid(options);
  std::vector<Complex> target(kPoints);
  for (Eigen::Index row = 0; row < kPoints; ++row) {
    target[static_cast<std::size_t>(row)] = wanted(grid.frequency_hz(row));
  }
  NumeratorFit fit;
  fit.numerator = diagnosis::difference_basis(nearest_differences(denominator, target, late, grid));
  if (late) fit.numerator.insert(fit.numerator.begin(), 0.0);
  double largest = 0.0;
  double error = 0.0;
  for (Eigen::Index row = 0; row < kPoints; ++row) {
    if (!grid.in_band(row)) continue;
    const double w = grid.turn(row);
    const Complex got = polynomial_at(fit.numerator, w) / polynomial_at(denominator, w);
    error = std::max(error, std::abs(got - target[static_cast<std::size_t>(row)]));
    largest = std::max(largest, std::abs(target[static_cast<std::size_t>(row)]));
  }
  if (largest > 0.0) fit.error = error / largest;
  return fit;
}

NumeratorFit held_numerator(const std::vector<double>& denominator, const std::vector<double>& c,
                            const std::vector<double>& a, std::size_t ticks, bool late) {
  constexpr std::size_t kSamples = 400;
  const std::size_t order = denominator.size() - 1;
  const auto wanted = impulse_response(c, a, kSamples);
  const auto columns = static_cast<Eigen::Index>(late ? order : order + 1);
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(kSamples), columns);
  for (Eigen::Index i = 0; i < columns; ++i) {
    // D^i, or q^-1 D^i.
    std::vector<double> basis(static_cast<std::size_t>(i) + 1, 0.0);
    basis.back() = 1.0;
    basis = diagnosis::difference_basis(basis);
    if (late) basis.insert(basis.begin(), 0.0);
    const auto fast = impulse_response(basis, denominator, ticks * (kSamples - 1) + 1);
    matrix(0, i) = fast[0];
    for (std::size_t n = 1; n < kSamples; ++n) {
      double sum = 0.0;
      for (std::size_t k = 0; k < ticks; ++k) sum += fast[ticks * n - k];
      matrix(static_cast<Eigen::Index>(n), i) = sum;
    }
  }
  const Eigen::Map<const Eigen::VectorXd> right(wanted.data(), static_cast<Eigen::Index>(kSamples));
  const Eigen::RowVectorXd norms = matrix.colwise().norm();
  matrix.array().rowwise() /= norms.array();
  const Eigen::VectorXd x = signal::least_squares(matrix, right);
  NumeratorFit fit;
  if (right.norm() > 0.0) fit.error = (matrix * x - right).norm() / right.norm();
  std::vector<double> differences(static_cast<std::size_t>(columns));
  for (Eigen::Index i = 0; i < columns; ++i) {
    differences[static_cast<std::size_t>(i)] = x[i] / norms[i];
  }
  fit.numerator = diagnosis::difference_basis(differences);
  if (late) fit.numerator.insert(fit.numerator.begin(), 0.0);
  return fit;
}

}  // namespace stillhand::close_the_loop
