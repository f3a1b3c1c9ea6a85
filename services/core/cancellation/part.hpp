// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stillhand::cancellation {

/// Parts of a mitigation, in the order of stillhand_msgs::MitigationPartKind (idl/session.idl).
enum class PartKind : std::uint8_t {
  kForce,
  kSchedule,
  kImpedance,
  kLmsForce,
  kSignal,
  kPredictedSignal,
  kLmsSignal,
  kLowPass,
  kNotch,
};
inline constexpr std::size_t kPartKinds = static_cast<std::size_t>(PartKind::kNotch) + 1;

/// One part with its numbers, as a trial's assignment carries it; idl/session.idl gives the values
/// of each kind and their order.
struct Part {
  PartKind kind;
  std::vector<double> values = {};
  bool operator==(const Part&) const = default;
};

/// True where the parts need the model of a force, or that of a position.
bool needs_force(const std::vector<Part>& parts);
bool needs_position(const std::vector<Part>& parts);
/// True where a part drives the motor.
bool drives_motor(const std::vector<Part>& parts);
/// True where the motor's force follows a prediction of the feedthrough alone.
bool opposes_feedthrough(const std::vector<Part>& parts);

}  // namespace stillhand::cancellation
