// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "services/core/cancellation/control_model.hpp"
#include "services/core/cancellation/hysteresis_element.hpp"
#include "services/core/cancellation/value_table.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {

/// A control model as a running filter of fixed size, METHOD Eq. CC-6 to CC-9 and CC-19,
/// transposed direct form II of services/core/signal Eq. SG-12 with further inputs:
///
///   z = n_0 v_1 + t_1,   t_i = n_i v_1 + m_i phi(z) - d_i z + t_{i+1}
///   y = sum_k c_k0 v_k + e_0 phi(z) + s_1,
///   s_i = sum_k c_ki v_k + e_i phi(z) - d_i y + s_{i+1}
///
/// phi takes a value at every tick that is a multiple of LoopPath::ticks, and holds it between.
/// The body starts from rest, lags where their channels are at the first step, and elements with
/// memory from w = 0 there.  It trusts its model: prepare() checks it first.  Pure; step()
/// allocates nothing.
class ControlModelFilter {
 public:
  static constexpr std::size_t kMaxOrder = 12;
  static constexpr std::size_t kMostInputs = 4;
  static constexpr std::size_t kMostPaths = 6;
  static constexpr std::size_t kMostWaves = 6;
  static constexpr std::size_t kMostHysteresis = kMostPaths + 1;  ///< and the spring's

  ControlModelFilter() = default;
  /// @param model         within the sizes above
  /// @param settle_ticks  time for a transient from rest to fall to 1 %
  ControlModelFilter(const ControlModel& model, std::int64_t settle_ticks) noexcept;

  [[nodiscard]] bool loaded() const noexcept { return loaded_; }
  [[nodiscard]] std::int64_t settle_ticks() const noexcept { return settle_ticks_; }

  struct Force {
    double feedthrough_n = 0.0;  ///< of the body and the paths from the platform
    double beside_n =
        0.0;  ///< of paths from the stick and of waves; the arm has no influence on it
  };
  /// f^ at this tick.
  Force step(const ChannelSample& sample, Tick tick) noexcept;
  void reset() noexcept;

 private:
  using Taps = std::array<double, kMaxOrder + 1>;
  struct Input {
    std::size_t channel;
    ValueTable map;
    Taps c;
  };
  struct Path {
    std::size_t channel;
    double blend;  ///< of the lag, 1: none
    HysteresisElement memory;
    ValueTable map;
    double gain;
    bool of_stick;
  };
  struct Turning {
    std::size_t channel;  ///< kChannels: time
    double turn;          ///< [rad a unit]
    double sine_n, cosine_n;
  };

  double body(const ChannelSample& sample, Tick tick) noexcept;

  std::array<Input, kMostInputs> inputs_{};
  std::array<Path, kMostPaths> paths_{};
  std::array<Turning, kMostWaves> waves_{};
  std::size_t inputs_used_ = 0;
  std::size_t paths_used_ = 0;
  std::size_t waves_used_ = 0;
  std::size_t order_ = 0;
  Taps d_{};
  Taps e_{};
  Taps n_{};
  Taps m_{};
  HysteresisElement spring_memory_;
  ValueTable phi_;
  ValueTable output_;
  Tick phi_ticks_ = 1;
  double held_phi_ = 0.0;
  bool loop_ = false;
  bool of_output_ = false;
  Taps s_{};  ///< the last one stays 0
  Taps t_{};  ///< the last one stays 0
  std::array<double, kMostPaths> lagged_{};
  bool at_rest_ = true;  ///< nothing was stepped yet
  std::int64_t settle_ticks_ = 0;
  bool loaded_ = false;
};

}  // namespace stillhand::cancellation
