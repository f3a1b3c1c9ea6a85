// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/lateness_channels.hpp"

#include <array>
#include <map>

#include "apps/libraries/session/clock_line.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/time_difference.hpp"

namespace stillhand::session {
namespace {

struct Channel {
  const char* name;
  const char* unit;
};
enum Column : std::size_t {
  kAge,
  kAnswerTime,
  kStepTime,
  kOffset,
  kLost,
  kRepeated,
  kLater,
  kClosed
};
constexpr std::array<Channel, 8> kChannels{{{"answer_age", "s"},
                                            {"answer_time", "s"},
                                            {"step_time", "s"},
                                            {"clock_offset", "s"},
                                            {"answer_lost", "-"},
                                            {"answer_repeated", "-"},
                                            {"answer_later", "-"},
                                            {"interlock_closed", "-"}}};

double seconds(std::int64_t from_ns, std::int64_t to_ns) {
  return 1e-9 * static_cast<double>(difference_ns(to_ns, from_ns));
}

/// What the samples of a tick say; each time holds the one before where its message is lost.
class Steps {
 public:
  explicit Steps(const SessionRecording& session)
      : rig_(session.clock_offsets, "rig"), canceller_(session.clock_offsets, "cancellation") {
    for (const auto& raw : session.raw_samples) acquired_ns_[raw.tick()] = raw.stamp_ns();
    for (const auto& command : session.motor_commands) commands_[command.tick()] = &command;
  }

  std::array<double, kChannels.size()> step(const stillhand_msgs::RigTruth& truth) {
    const auto command = commands_.find(truth.tick());
    const bool answered = command != commands_.end();
    const auto acquired = acquired_ns_.find(truth.tick());
    if (acquired != acquired_ns_.end()) {
      now_[kStepTime] = seconds(acquired->second, truth.stamp_ns());
    }
    if (answered) {
      const std::int64_t sent_ns = command->second->stamp_ns();
      const std::int64_t there_ns = canceller_.on_experiments_clock(sent_ns);
      const std::int64_t begun_ns = rig_.on_experiments_clock(command->second->acquired_ns());
      now_[kAnswerTime] = seconds(begun_ns, there_ns);
      now_[kOffset] = seconds(there_ns, sent_ns);
    }
    // The rig uses none that is too old: it is then the age of the last that it used.
    const bool used = truth.motor_tick() >= 0;
    const bool repeated = used && truth.motor_tick() == used_;
    if (used) used_ = truth.motor_tick();
    const Tick age = used_ < 0 ? 0 : truth.tick() - used_;
    now_[kAge] = static_cast<double>(age) * kControlPeriod_s;
    now_[kLost] = answered ? 0.0 : 1.0;
    now_[kRepeated] = repeated ? 1.0 : 0.0;
    now_[kLater] = answered && age > 0 ? 1.0 : 0.0;
    now_[kClosed] = truth.motor_permitted() ? 1.0 : 0.0;
    return now_;
  }

 private:
  ClockLine rig_, canceller_;
  std::map<Tick, std::int64_t> acquired_ns_;
  std::map<Tick, const stillhand_msgs::MotorCommand*> commands_;
  std::array<double, kChannels.size()> now_{};
  Tick used_ = -1;
};

}  // namespace

recording::Recording lateness_channels(const SessionRecording& session) {
  recording::Recording rows;
  for (const Channel& channel : kChannels) rows.columns.push_back({channel.name, channel.unit, {}});
  Steps steps(session);
  Tick before = -1;
  const auto& truths = session.rig_truths;
  for (std::size_t row = 0; row < truths.size(); ++row) {
    const auto& truth = truths[row];
    if (truth.tick() <= before) continue;  // delivered twice
    // Ahead of what comes after it: a damaged number, which would hide the rest.
    if (row + 1 < truths.size() && truth.tick() > truths[row + 1].tick() &&
        truths[row + 1].tick() > before) {
      continue;
    }
    before = truth.tick();
    rows.time_s.push_back(static_cast<double>(before) * kControlPeriod_s);
    const auto values = steps.step(truth);
    for (std::size_t i = 0; i < values.size(); ++i) rows.columns[i].values.push_back(values[i]);
  }
  return rows;
}

}  // namespace stillhand::session
