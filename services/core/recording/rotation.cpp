// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/rotation.hpp"

namespace stillhand::recording {

std::string part_name(const std::string& path, std::uint32_t number) {
  if (number <= 1) return path;
  constexpr std::size_t kDigits = 4;
  std::string digits = std::to_string(number);
  if (digits.size() < kDigits) digits.insert(0, kDigits - digits.size(), '0');
  const std::size_t folder = path.find_last_of('/');
  const std::size_t first = folder == std::string::npos ? 0 : folder + 1;
  const std::size_t dot = path.find_last_of('.');
  const bool ending = dot != std::string::npos && dot > first;
  return (ending ? path.substr(0, dot) : path) + "." + digits + (ending ? path.substr(dot) : "");
}

}  // namespace stillhand::recording
