// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/mcap_loss.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace stillhand::recording {
namespace {

// Findings that only show that the file was not closed; nothing is lost.
bool is_harmless(const Damage& damage) {
  return damage.kind == DamageKind::kNoFooter && damage.lost_bytes == 0;
}

}  // namespace

std::string byte_count(std::uint64_t bytes) {
  constexpr std::array<const char*, 6> kUnits{"kB", "MB", "GB", "TB", "PB", "EB"};
  constexpr double kRoundsTo1000 = 999.5;  // three digits would show it as 1e+03
  if (bytes < 1000) return std::to_string(bytes) + (bytes == 1 ? " byte" : " bytes");
  double value = static_cast<double>(bytes) / 1000.0;
  std::size_t unit = 0;
  for (; value >= kRoundsTo1000 && unit + 1 < kUnits.size(); ++unit) value /= 1000.0;
  return fmt::format("{:.3g} {}", value, kUnits[unit]);
}

std::string loss_line(const std::string& path, const std::vector<Damage>& damage,
                      std::optional<std::uint64_t> messages, bool being_written) {
  const std::string read =
      messages ? std::to_string(*messages) + " messages read" : std::string("the rest is read");
  if (being_written) return path + ": still being written; " + read;
  if (damage.empty()) return {};
  if (std::ranges::all_of(damage, is_harmless)) {
    return path + ": was not closed, as after a crash; nothing in it is lost, " + read;
  }
  const bool cut = std::ranges::all_of(damage, [](const Damage& each) {
    return is_harmless(each) || each.kind == DamageKind::kCutOff;
  });
  const std::string lost = byte_count(lost_bytes(damage)) + " lost";
  if (cut) return path + ": cut off, as after a crash; " + lost + " at its end, " + read;
  const auto worst = std::ranges::max_element(damage, {}, &Damage::lost_bytes);
  const auto findings =
      std::ranges::count_if(damage, [](const Damage& d) { return !is_harmless(d); });
  return path + ": damaged in " + std::to_string(findings) +
         (findings == 1 ? " place; " : " places; ") + lost + " (at byte " +
         std::to_string(worst->offset) + ": " + worst->text + "), " + read +
         "; `stillhand verify` lists all";
}

std::string clock_line(const std::string& path, const McapReader& reader) {
  if (reader.clock_steps().empty()) return {};
  std::string line = path + ": the clock of its recorder was set by ";
  for (const ClockStep& step : reader.clock_steps()) {
    const auto after_ns = static_cast<std::int64_t>(step.at_ns - reader.statistics().start_time_ns);
    line += fmt::format("{:+.3f} s at {:.3f} s, ", 1e-9 * static_cast<double>(step.by_ns),
                        1e-9 * static_cast<double>(after_ns));
  }
  return line + "its times are read as if it had not been; `stillhand recover` writes them so";
}

}  // namespace stillhand::recording
