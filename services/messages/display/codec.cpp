// SPDX-License-Identifier: Apache-2.0
#include "services/messages/display/codec.hpp"

#include <algorithm>
#include <cstddef>
#include <sstream>

#include "idl/enumerator.hpp"

namespace stillhand::display {
namespace {

// Prompts of core and bus have one order.
PromptKind kind_of(stillhand_msgs::PromptKind kind) {
  return of_bus(kind, stillhand_msgs::PROMPT_END, PromptKind::kNothing);
}
static_assert(static_cast<std::size_t>(stillhand_msgs::PROMPT_NOTHING) ==
              static_cast<std::size_t>(PromptKind::kNothing));
static_assert(static_cast<std::size_t>(stillhand_msgs::PROMPT_END) ==
              static_cast<std::size_t>(PromptKind::kEnd));

}  // namespace

TrackingInput from_idl(const stillhand_msgs::Sensed& sensed, const TakenOff& off) {
  return {sensed.tick(), sensed.theta_rad(), off.angle_rad};
}

TakenOff from_idl(const stillhand_msgs::MotorCommand& command) {
  return {command.tick(), command.taken_off_rad()};
}

stillhand_msgs::TrackingSample to_idl(const TrackingSample& sample, Tick tick, std::int64_t trial,
                                      Tick command) {
  stillhand_msgs::TrackingSample message;
  message.tick(tick);
  message.target_m(sample.target_m);
  message.cursor_m(sample.cursor_m);
  message.inside(sample.inside);
  message.trial(static_cast<std::int32_t>(trial));
  message.flags(sample.flags);
  message.command_tick(command);
  return message;
}

namespace {

constexpr Tick kFurthest = Tick{1} << 60;  // a difference of two ticks stays a number

}  // namespace

Prompt from_idl(const stillhand_msgs::Prompt& message) {
  Prompt prompt;
  prompt.number = message.number();
  prompt.kind = kind_of(message.kind());
  prompt.trial = message.trial();
  prompt.trials = message.trials();
  prompt.end_tick = std::clamp<Tick>(message.end_tick(), -1, kFurthest);
  std::istringstream text(message.text().c_str());
  for (std::string line; std::getline(text, line);) prompt.lines.push_back(line);
  prompt.lowest = message.lowest().c_str();
  prompt.highest = message.highest().c_str();
  prompt.steps = message.steps() >= 1 && message.steps() <= kMostSteps ? message.steps() : 0;
  return prompt;
}

stillhand_msgs::Answer to_idl(const Answering::Answer& answer) {
  stillhand_msgs::Answer message;
  message.prompt_number(answer.prompt);
  message.value(static_cast<std::int32_t>(answer.value));
  return message;
}

}  // namespace stillhand::display
