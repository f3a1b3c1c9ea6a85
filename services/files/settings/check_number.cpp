// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/check_number.hpp"

#include <fmt/format.h>

#include <charconv>

namespace stillhand::settings {

std::function<std::string(const std::string& word)> number_between(double low, double high) {
  return [low, high](const std::string& word) -> std::string {
    const char* const end = word.data() + word.size();
    double value = 0.0;
    const auto [read, error] = std::from_chars(word.data(), end, value);
    if (error == std::errc() && read == end && value >= low && value <= high) return "";
    return fmt::format("got \"{}\", want a number from {} to {}", word, low, high);
  };
}

}  // namespace stillhand::settings
