// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/motion_profile.hpp"

#include <array>
#include <cstddef>

#include "services/core/contract/config_error.hpp"

namespace stillhand::motion {
namespace {

constexpr std::array<std::string_view, 5> kWords{"still", "band_noise", "multisine", "road",
                                                 "ride"};

}  // namespace

std::string_view to_string(MotionKind kind) noexcept {
  const auto index = static_cast<std::size_t>(kind);
  return index < kWords.size() ? kWords[index] : "unknown";
}

}  // namespace stillhand::motion
