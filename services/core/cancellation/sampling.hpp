// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "services/core/cancellation/control_model_filter.hpp"
#include "services/core/contract/config_field.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {

inline constexpr std::int64_t kMostLatency_samples = 5;

/// How the canceller samples what it predicts from, METHOD Eq. CC-16.  The default, `now`, runs the
/// model on every tick; `paper` is the chain of the paper's data, run on line.
struct SamplingConfig {
  std::int64_t low_pass_order = 0;
  double low_pass_hz = 10.0;
  std::int64_t model_ticks = 1;
  std::int64_t latency_samples = 0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("low_pass_order", self.low_pass_order, Range{0.0, 8.0},
          "[-] order of a Butterworth low-pass on the acceleration; 0: none; paper III-A: 5");
    visit("low_pass_hz", self.low_pass_hz, Range{1.0, 400.0},
          "[Hz] its cutoff; paper III-A: 10 Hz");
    visit("model_ticks", self.model_ticks, Range{1.0, 20.0},
          "[ticks] from one sample of the model to the next; 20: the paper's 50 Hz");
    visit("latency_samples", self.latency_samples,
          Range{0.0, static_cast<double>(kMostLatency_samples)},
          "[samples of the model] from an acceleration to the force that answers it");
  }

  [[nodiscard]] double model_rate_hz() const noexcept {
    return kControlRateHz / static_cast<double>(model_ticks);
  }
};

/// "now" or "paper": order 5 at 10 Hz, 50 Hz, one sample.  The paper names filter and rate for its
/// data and is silent about what ran on line; one sample is what a computer needs that reads,
/// computes and writes in one cycle.
/// @throws stillhand::ConfigError for another name.
SamplingConfig sampling_named(std::string_view name);

/// A model's force between its samples: held, and late by a whole number of samples.  Pure.
class HeldForce {
 public:
  using Force = ControlModelFilter::Force;

  /// Takes the force of a sample.  @param latency_samples  0 to kMostLatency_samples
  void push(const Force& force, std::int64_t latency_samples) noexcept;
  /// The force that acts.
  [[nodiscard]] const Force& force() const noexcept { return acting_; }

 private:
  std::array<Force, static_cast<std::size_t>(kMostLatency_samples)> waiting_{};
  std::size_t next_ = 0;
  Force acting_{};
};

}  // namespace stillhand::cancellation
