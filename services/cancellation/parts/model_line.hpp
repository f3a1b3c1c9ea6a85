// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "services/signal/difference_model.hpp"

namespace stillhand::cancellation {

/// A difference model (Eq. SG-12) sample by sample, from rest; transposed direct form II, so that a
/// step costs 2 p multiplications.  Without a model it gives 0.
/// Pure; step() never allocates or throws.
class ModelLine {
 public:
  static constexpr std::size_t kMostOrder = 12;

  ModelLine() = default;
  /// @throws stillhand::ConfigError unless the model is well formed, stable, of an order up to
  ///         kMostOrder and made for the control rate.
  explicit ModelLine(const signal::DifferenceModel& model);

  double step(double u) noexcept;
  void reset() noexcept { state_.fill(0.0); }

 private:
  std::array<double, kMostOrder + 1> numerator_{};
  std::array<double, kMostOrder + 1> denominator_{};
  std::array<double, kMostOrder + 1> state_{};
  std::size_t order_ = 0;
};

}  // namespace stillhand::cancellation
