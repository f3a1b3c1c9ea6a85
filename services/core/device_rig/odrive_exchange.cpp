// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/odrive_exchange.hpp"

#include <array>
#include <cmath>

namespace stillhand::device_rig::odrive {
namespace {

constexpr std::uint64_t kMostState = 99;
constexpr std::size_t kAxes = 2;

/// The questions of an axis; text alone, so that no tick puts names together.
struct Questions {
  std::string_view feedback, state, error;
  std::array<std::string_view, 4> extra;  ///< in the order of Extra
};
constexpr std::array<Questions, kAxes> kQuestions{
    {{"f 0",
      "r axis0.current_state",
      "r axis0.error",
      {"r axis0.motor.error", "r axis0.encoder.error", "r axis0.controller.error",
       "r axis0.motor.current_control.Iq_measured"}},
     {"f 1",
      "r axis1.current_state",
      "r axis1.error",
      {"r axis1.motor.error", "r axis1.encoder.error", "r axis1.controller.error",
       "r axis1.motor.current_control.Iq_measured"}}}};

}  // namespace

Extra extra_of(std::uint64_t number) noexcept { return static_cast<Extra>(number % 4); }

void put_questions(Lines& lines, std::size_t axis, std::uint64_t number) noexcept {
  const Questions& questions = kQuestions[axis == 0 ? 0 : 1];
  // The drive has one property that does nothing; it carries the number there and back.
  lines.add("w test_property ", number);
  lines.add(questions.feedback);
  lines.add(questions.state);
  lines.add("r system_stats.uptime");
  lines.add(questions.error);
  lines.add(questions.extra[static_cast<std::size_t>(extra_of(number))]);
  lines.add("r test_property");
}

std::uint64_t AnswerReader::ask() noexcept {
  if (asked_ == kLast) asked_ = answered_ = kFirst - 1;
  return ++asked_;
}

AnswerReader::Verdict AnswerReader::take(std::string_view line) noexcept {
  const auto text = read_line(line);
  if (!text) {
    place_ = 0;
    return Verdict::kDamaged;
  }
  if (const std::size_t blank = text->find(' '); blank != std::string_view::npos) {
    return begin(text->substr(0, blank), text->substr(blank + 1));
  }
  if (place_ == 0 || !put(*text)) {
    place_ = 0;
    return Verdict::kDamaged;
  }
  if (++place_ < kMostAnswers) return Verdict::kMore;
  place_ = 0;
  answers_ = coming_;
  answered_ = answers_.number;
  return Verdict::kWhole;
}

AnswerReader::Verdict AnswerReader::begin(std::string_view position,
                                          std::string_view velocity) noexcept {
  const auto turns = real_of(position);
  const auto turns_s = real_of(velocity);
  const bool early = place_ != 0;  // the one before is not whole
  place_ = 0;
  if (!turns || !turns_s || !std::isfinite(*turns)) return Verdict::kDamaged;
  coming_.position_turns = *turns;
  coming_.velocity_turns_s = *turns_s;
  place_ = 1;
  return early ? Verdict::kDamaged : Verdict::kMore;
}

bool AnswerReader::put(std::string_view text) noexcept {
  const auto whole = whole_of(text);
  switch (place_) {
    case 1:
      coming_.state = whole.value_or(0);
      return whole && *whole <= kMostState;
    case 2:
      coming_.uptime_ms = whole.value_or(0);
      return whole.has_value();
    case 3:
      coming_.axis_error = whole.value_or(0);
      return whole.has_value();
    case 4: {
      const auto real = real_of(text);
      coming_.extra = real.value_or(0.0);
      with_point_ = !whole;
      return real.has_value();
    }
    default:
      coming_.number = whole.value_or(0);
      // An error word has no decimals, and a current always has.
      return whole && *whole > answered_ && *whole <= asked_ &&
             with_point_ == (extra_of(*whole) == Extra::kCurrent);
  }
}

}  // namespace stillhand::device_rig::odrive
