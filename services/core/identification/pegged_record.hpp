// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "services/core/contract/trial.hpp"
#include "services/core/identification/record.hpp"

namespace stillhand::identification {

/// The measured part of a pegged trial.
struct PeggedTrial {
  Record record;             ///< 1 kHz, without gaps
  std::int64_t lost = 0;     ///< [ticks] interpolated in it
  std::int64_t number = -1;  ///< of the trial
};

/// Why no model can come of a trial, one line for a person; empty: one can.  With more than 1 % of
/// lost ticks the interpolation begins to colour the fit.
std::string why_unusable(const PeggedTrial& trial);

/// Collects the measured ticks of one pegged trial, METHOD Eq. ID-20.  Ticks lost between two
/// samples are interpolated on a straight line, those lost at the start repeat the first sample,
/// those lost at the end shorten the record.  A tick that does not increase is ignored. Pure; one
/// thread.  begin() reserves the room for the whole trial; take() does not allocate.
class PeggedRecord {
 public:
  /// Forgets what was collected, and collects this trial.
  /// @param trial  pegged and sound, see Trial::sound()
  void begin(const Trial& trial);
  /// One call a sample.
  /// @return true with the trial's last measured tick, or the first after it.
  bool take(Tick tick, double accel_m_s2, double force_n);
  [[nodiscard]] bool active() const noexcept { return active_; }
  /// Hands out what was collected, without a copy; begin() comes next.
  [[nodiscard]] PeggedTrial release() noexcept;

 private:
  Trial trial_;
  Record record_;
  std::int64_t lost_ = 0;
  bool active_ = false;
};

}  // namespace stillhand::identification
