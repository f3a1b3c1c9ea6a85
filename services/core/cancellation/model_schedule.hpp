// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {

/// Decides at which sample the canceller takes a model that is ready, METHOD CC-15.  A model names
/// the first tick at which it may be used, so that a replay takes it at the tick at which the
/// session took it.  A model that is ready later is taken at once and counted late; until then the
/// model before it stays in use, or no force acts.
/// Pure; one thread; nothing allocates or throws.
class ModelSchedule {
 public:
  struct Due {
    bool take = false;    ///< the model that is ready is used from this sample on
    Tick late_ticks = 0;  ///< [ticks] since the first sample at which it could have been used
  };

  /// A model is ready; it replaces one that still waits.
  /// @param number     of the model, from 0 on
  /// @param from_tick  first tick at which it may be used
  void offer(std::int32_t number, Tick from_tick) noexcept;

  /// One call a sample, before the canceller's step.
  Due step(Tick tick) noexcept;

  /// Number of the model in use; -1: none.
  [[nodiscard]] std::int32_t in_use() const noexcept { return in_use_; }
  /// First tick of the model that waits; none where no model waits.
  [[nodiscard]] std::optional<Tick> waits_for() const noexcept {
    return waiting_ ? std::optional(waiting_->from_tick) : std::nullopt;
  }

 private:
  struct Waiting {
    std::int32_t number;
    Tick from_tick;
    bool late;  ///< a sample at or behind from_tick was answered without it
  };

  std::optional<Waiting> waiting_;
  std::optional<Tick> first_tick_;  ///< since the sample clock began
  Tick last_tick_ = 0;              ///< valid where first_tick_ is
  std::int32_t in_use_ = -1;
};

}  // namespace stillhand::cancellation
