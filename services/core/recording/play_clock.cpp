// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/play_clock.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace stillhand::recording {
namespace {

// 63 bits of nanoseconds times 100,000 need 80.
__extension__ using Wide = __int128;

constexpr std::array<std::int64_t, 10> kSteps{100,  200,    500,    1000,   2000,
                                              5000, 10'000, 20'000, 50'000, 100'000};

std::int64_t scaled_down(std::int64_t ns, std::int64_t by, std::int64_t over) {
  const Wide product = static_cast<Wide>(ns) * by;
  const Wide quotient = product / over;
  return static_cast<std::int64_t>(product % over < 0 ? quotient - 1 : quotient);
}

}  // namespace

std::optional<PlayRate> PlayRate::parse(std::string_view text) noexcept {
  const std::size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  const std::string_view rest =
      point == std::string_view::npos ? std::string_view{} : text.substr(point + 1);
  constexpr std::size_t kDecimals = 3;
  const auto digits = [](std::string_view part) {
    return std::ranges::all_of(part, [](char c) { return c >= '0' && c <= '9'; });
  };
  if (!digits(whole) || !digits(rest) || rest.size() > kDecimals || whole.size() > kDecimals ||
      whole.size() + rest.size() == 0) {
    return std::nullopt;
  }
  std::string joined = std::string(whole) + std::string(rest);
  joined.append(kDecimals - rest.size(), '0');
  std::int64_t per_mille = 0;
  std::from_chars(joined.data(), joined.data() + joined.size(), per_mille);
  if (per_mille < kSlowest || per_mille > kFastest) return std::nullopt;
  return PlayRate{per_mille};
}

std::string PlayRate::text() const {
  constexpr std::int64_t kMille = 1000;
  std::string text = std::to_string(per_mille / kMille);
  if (per_mille % kMille == 0) return text;
  std::string decimals = std::to_string(kMille + per_mille % kMille).substr(1);
  while (decimals.back() == '0') decimals.pop_back();
  return text + "." + decimals;
}

PlayRate PlayRate::faster() const noexcept {
  const auto next = std::ranges::upper_bound(kSteps, per_mille);
  return {next == kSteps.end() ? kFastest : *next};
}

PlayRate PlayRate::slower() const noexcept {
  const auto next = std::ranges::lower_bound(kSteps, per_mille);
  return {next == kSteps.begin() ? kSlowest : *(next - 1)};
}

std::int64_t PlayClock::recorded_at(std::int64_t now_ns) const noexcept {
  if (paused_) return recorded0_ns_;
  return recorded0_ns_ + scaled_down(now_ns - now0_ns_, rate_.per_mille, 1000);
}

std::optional<std::int64_t> PlayClock::due(std::int64_t recorded_ns) const noexcept {
  if (paused_) return std::nullopt;
  // -floor(-x) is the ceiling.
  return now0_ns_ - scaled_down(recorded0_ns_ - recorded_ns, 1000, rate_.per_mille);
}

void PlayClock::pause(std::int64_t now_ns) noexcept {
  recorded0_ns_ = recorded_at(now_ns);
  now0_ns_ = now_ns;
  paused_ = true;
}

void PlayClock::resume(std::int64_t now_ns) noexcept {
  if (!paused_) return;
  now0_ns_ = now_ns;
  paused_ = false;
}

void PlayClock::seek(std::int64_t now_ns, std::int64_t recorded_ns) noexcept {
  now0_ns_ = now_ns;
  recorded0_ns_ = recorded_ns;
}

void PlayClock::set_rate(std::int64_t now_ns, PlayRate rate) noexcept {
  recorded0_ns_ = recorded_at(now_ns);
  now0_ns_ = now_ns;
  rate_ = rate;
}

}  // namespace stillhand::recording
