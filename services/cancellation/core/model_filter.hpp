// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "signal/difference_model.hpp"

namespace stillhand::cancellation {

/// A difference model as a running filter of fixed size, transposed direct form II of Eq. SG-12:
///
///   f[n] = c_0 a[n] + s_1,   s_i = c_i a[n] - d_i f[n] + s_{i+1},   s_{p+1} = 0
///
/// Trusts its model: Canceller::load_model() checks it first.  step() allocates nothing.
class ModelFilter {
 public:
  static constexpr std::size_t kMaxOrder = 12;

  ModelFilter() = default;
  /// @param model         order at most kMaxOrder
  /// @param settle_ticks  time for a transient from rest to fall to 1 %
  ModelFilter(const signal::DifferenceModel& model, std::int64_t settle_ticks) noexcept;

  [[nodiscard]] bool loaded() const noexcept { return loaded_; }
  [[nodiscard]] std::int64_t settle_ticks() const noexcept { return settle_ticks_; }

  double step(double accel_m_s2) noexcept {
    const double force_n = c_[0] * accel_m_s2 + s_[0];
    for (std::size_t i = 1; i <= order_; ++i) {
      s_[i - 1] = c_[i] * accel_m_s2 - d_[i] * force_n + s_[i];
    }
    return force_n;
  }
  void reset() noexcept { s_.fill(0.0); }

 private:
  std::array<double, kMaxOrder + 1> c_{};
  std::array<double, kMaxOrder + 1> d_{};
  std::array<double, kMaxOrder + 1> s_{};  ///< the last one stays 0
  std::size_t order_ = 0;
  std::int64_t settle_ticks_ = 0;
  bool loaded_ = false;
};

}  // namespace stillhand::cancellation
