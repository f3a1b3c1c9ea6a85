// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/misses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "apps/libraries/session/clock_line.hpp"
#include "apps/libraries/session/core/trial_forces.hpp"
#include "idl/topics.hpp"
#include "services/core/contract/trial.hpp"

namespace stillhand::session {
namespace {

constexpr double kNs_per_s = 1e9;
constexpr auto kTick_ns = static_cast<std::int64_t>(kNs_per_s * kControlPeriod_s);

struct Sample {
  std::int64_t at_ns;  ///< on the experiment's clock
  Tick tick;
};

/// The samples of one process of the loop.
struct Stream {
  const topics::Topic* topic;
  const topics::Topic* source;    ///< whose samples it answers; nullptr: it has a clock of its own
  std::vector<Sample> samples;    ///< in time
  std::vector<Sample> used = {};  ///< when somebody used a sample, and which
  [[nodiscard]] std::string process() const { return std::string(topic->writers.front()); }
};

template <typename Message>
std::vector<Sample> samples_of(const SessionRecording& session, std::string_view process,
                               const std::vector<Message>& messages, auto tick) {
  const ClockLine clock(session.clock_offsets, process);
  std::vector<Sample> samples;
  samples.reserve(messages.size());
  for (const Message& message : messages) {
    samples.push_back({clock.on_experiments_clock(message.stamp_ns()), tick(message)});
  }
  // Who was late answers many ticks at one moment.
  std::ranges::sort(samples, {},
                    [](const Sample& each) { return std::pair(each.at_ns, each.tick); });
  return samples;
}

template <typename Message>
Stream stream_of(const SessionRecording& session, const topics::Topic& topic,
                 const topics::Topic* source, const std::vector<Message>& messages) {
  return {&topic, source,
          samples_of(session, topic.writers.front(), messages,
                     [](const Message& message) { return message.tick(); })};
}

// Each after its source.
std::vector<Stream> streams_of(const SessionRecording& session) {
  std::vector<Stream> streams{
      stream_of(session, topics::kRawSample, nullptr, session.raw_samples),
      stream_of(session, topics::kSensed, &topics::kRawSample, session.sensed),
      stream_of(session, topics::kPlatformCommand, &topics::kSensed, session.platform_commands),
      stream_of(session, topics::kMotorCommand, &topics::kSensed, session.motor_commands),
      stream_of(session, topics::kTrackingSample, &topics::kSensed, session.tracking_samples),
      stream_of(session, topics::kOperatorForce, &topics::kTrackingSample,
                session.operator_forces)};
  const auto used_by_rig = [&](auto tick) {
    return samples_of(session, "rig", session.rig_truths, tick);
  };
  streams[0].used = streams[1].samples;
  streams[1].used = streams[3].samples;
  std::ranges::copy(used_by_rig([](const auto& truth) { return truth.motor_tick(); }),
                    std::back_inserter(streams[1].used));
  streams[2].used = used_by_rig([](const auto& truth) { return truth.command_tick(); });
  streams[3].used = used_by_rig([](const auto& truth) { return truth.motor_tick(); });
  streams[4].used = streams[5].samples;
  streams[5].used = used_by_rig([](const auto& truth) { return truth.operator_tick(); });
  return streams;
}

constexpr std::size_t kRecordings = std::numeric_limits<std::size_t>::max();

struct Gap {
  const Stream* stream;
  std::int64_t from_ns, until_ns;
  std::size_t miss;  ///< whose fault it is; kRecordings: samples that the recording lacks
};

// The process wrote, and the recording lacks it.  The rig counts without a jump, however late it
// is; of the others, somebody used one of the ticks in between in time.
bool is_recordings(const Stream& stream, const Sample& before, const Sample& after) {
  const Tick jump = after.tick - before.tick - 1;
  if (jump <= 0) return false;
  if (stream.source == nullptr) return true;
  return std::ranges::any_of(stream.used, [&](const Sample& use) {
    return use.tick > before.tick && use.tick < after.tick && use.at_ns < after.at_ns - kTick_ns;
  });
}

// Of the process itself, unless its source was silent for at least half of the gap; else of who was
// silent before it.  A source that comes back writes much at once, so samples are not counted.
const Gap* inherited(const Gap& gap, const std::vector<Gap>& before) {
  const auto cause = std::ranges::find_if(before, [&](const Gap& each) {
    const std::int64_t both_ns =
        std::min(each.until_ns, gap.until_ns) - std::max(each.from_ns, gap.from_ns);
    return each.stream->topic == gap.stream->source && 2 * both_ns >= gap.until_ns - gap.from_ns;
  });
  return cause == before.end() ? nullptr : &*cause;
}

// Motor force for each newton of the prediction; 0: it is not the prediction's.
double share_of(std::span<const double> motor_n, std::span<const double> predicted_n) {
  double product = 0.0, square = 0.0;
  for (std::size_t n = 0; n < motor_n.size(); ++n) {
    product -= motor_n[n] * predicted_n[n];
    square += predicted_n[n] * predicted_n[n];
  }
  if (square <= 0.0 || product <= 0.0) return 0.0;
  const double share = product / square;
  double left = 0.0, whole = 0.0;
  for (std::size_t n = 0; n < motor_n.size(); ++n) {
    left += std::pow(motor_n[n] + share * predicted_n[n], 2);
    whole += motor_n[n] * motor_n[n];
  }
  // More than a tenth of it is something else: another part of a mitigation.
  return left < 0.01 * whole ? share : 0.0;
}

/// Motor forces of the rig, and what the prediction asked for at the same ticks.
struct Forces {
  std::vector<std::int64_t> at_ns;
  std::vector<double> motor_n, predicted_n;
};

Forces forces_of(const SessionRecording& session) {
  const ClockLine clock(session.clock_offsets, "rig");
  Forces forces;
  auto command = session.motor_commands.begin();
  double predicted_n = 0.0;
  for (const auto& truth : session.rig_truths) {
    while (command != session.motor_commands.end() && command->tick() <= truth.motor_tick()) {
      predicted_n = command->predicted_force_n();
      ++command;
    }
    forces.at_ns.push_back(clock.on_experiments_clock(truth.stamp_ns()));
    forces.motor_n.push_back(truth.motor_force_n());
    forces.predicted_n.push_back(predicted_n);
  }
  return forces;
}

// What the force did from a silence on, until `end_ns`.
void judge_force(const Forces& forces, std::int64_t until_ns, std::int64_t end_ns, Miss& miss) {
  constexpr std::size_t kSecond = 1000;  // ticks
  constexpr std::size_t kWindow = 100;
  constexpr double kNoForce_n = 1e-3;
  // A force that is on its way to zero reaches it within the ramp.
  constexpr std::int64_t kRamp_ns = 50 * kTick_ns;
  const auto place = [&](std::int64_t at_ns) {
    return static_cast<std::size_t>(std::ranges::lower_bound(forces.at_ns, at_ns) -
                                    forces.at_ns.begin());
  };
  const std::size_t from = place(miss.from_ns), end = place(end_ns);
  const std::span motor(forces.motor_n), predicted(forces.predicted_n);
  const std::size_t first = from - std::min(from, kSecond);
  miss.force_before_n = rms(motor.subspan(first, from - first));
  if (miss.force_before_n < kNoForce_n) return;
  const double share_before =
      share_of(motor.subspan(first, from - first), predicted.subspan(first, from - first));
  std::size_t zero = from;
  while (zero < end && motor[zero] != 0.0 && forces.at_ns[zero] <= until_ns + kRamp_ns) ++zero;
  std::size_t back = zero;
  while (back < end && motor[back] == 0.0) ++back;
  if (back > zero) {
    miss.zero_s =
        static_cast<double>(forces.at_ns[back - 1] - forces.at_ns[zero] + kTick_ns) / kNs_per_s;
  }
  if (share_before == 0.0) return;
  miss.back_s = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t n = back; n + kWindow <= end; n += kWindow / 10) {
    // The force is the prediction's again when its share is: within 3 %, as both fluctuate.
    if (rms(motor.subspan(n, kWindow)) < 0.97 * share_before * rms(predicted.subspan(n, kWindow))) {
      continue;
    }
    miss.back_s = static_cast<double>(forces.at_ns[n] - miss.from_ns) / kNs_per_s;
    return;
  }
}

Trial trial_of(const stillhand_msgs::TrialControl& control) {
  const Trial trial{
      control.trial(),
      control.phase() == stillhand_msgs::PHASE_IDLE ? TrialPhase::kIdle : TrialPhase::kTracking,
      control.start_tick(), control.duration_ticks(), control.ramp_ticks()};
  return trial.sound() ? trial : Trial{};
}

// When it was, and what the force did until the end of the trial.
void judge(const SessionRecording& session, const Forces& forces, Miss& miss) {
  const ClockLine rig(session.clock_offsets, "rig");
  miss.from_s =
      static_cast<double>(miss.from_ns + session.log_less_stamp_ns - session.first_log_ns) /
      kNs_per_s;
  const auto next = std::ranges::find_if(session.rig_truths, [&](const auto& truth) {
    return rig.on_experiments_clock(truth.stamp_ns()) >= miss.from_ns;
  });
  if (next == session.rig_truths.end()) return;
  std::int64_t end_ns = forces.at_ns.back();
  for (const auto& control : session.trial_controls) {
    const Trial trial = trial_of(control);
    if (!trial.covers(next->tick())) continue;
    miss.trial = trial.number;
    miss.trial_s = static_cast<double>(next->tick() - trial.start_tick) * kControlPeriod_s;
    miss.pegged = control.phase() == stillhand_msgs::PHASE_PEGGED;
    const Tick left = trial.start_tick + trial.duration_ticks - next->tick();
    if (left <= 0) return;  // the force ramps down in any case
    end_ns = miss.from_ns + left * kTick_ns;
  }
  const auto until_ns = miss.from_ns + static_cast<std::int64_t>(kNs_per_s * miss.late_s);
  judge_force(forces, until_ns, end_ns, miss);
}

// The gaps of one process, after those of its source.
void add_gaps(const Stream& stream, std::int64_t least_ns, std::vector<Gap>& gaps,
              std::vector<Miss>& misses) {
  for (std::size_t n = 1; n < stream.samples.size(); ++n) {
    const Sample& before = stream.samples[n - 1];
    const Sample& after = stream.samples[n];
    const std::int64_t late_ns = after.at_ns - before.at_ns - kTick_ns / 2;
    if (late_ns < least_ns) continue;
    Gap gap{&stream, before.at_ns + kTick_ns / 2, after.at_ns, misses.size()};
    if (const Gap* cause = inherited(gap, gaps); cause != nullptr) {
      gap.miss = cause->miss;
      if (gap.miss != kRecordings) {
        std::vector<std::string>& waited = misses[gap.miss].waited;
        if (std::ranges::find(waited, stream.process()) == waited.end()) {
          waited.push_back(stream.process());
        }
      }
    } else if (is_recordings(stream, before, after)) {
      gap.miss = kRecordings;
    } else {
      Miss& miss = misses.emplace_back();
      miss.process = stream.process();
      miss.topic = stream.topic->name;
      miss.from_ns = gap.from_ns;
      miss.late_s = static_cast<double>(late_ns) / kNs_per_s;
    }
    gaps.push_back(gap);
  }
}

// The process itself says it, within a second, with the length from one tick to the next.
std::string why_in(const SessionRecording& session,
                   const std::vector<const stillhand_msgs::Event*>& stalls, const Miss& miss) {
  // A sample is stamped after its beat, on a busy machine by some of it.
  const double same_s = std::max(0.003, 0.2 * miss.late_s);
  const ClockLine clock(session.clock_offsets, miss.process);
  const double until_s = static_cast<double>(miss.from_ns) / kNs_per_s + miss.late_s;
  for (const stillhand_msgs::Event* event : stalls) {
    if (event->source() != miss.process) continue;
    const double said_s =
        static_cast<double>(clock.on_experiments_clock(event->stamp_ns())) / kNs_per_s;
    const bool after = said_s > until_s - same_s && said_s < until_s + 1.0;
    if (after && std::abs(1e-6 * event->by_us() - miss.late_s) < same_s) {
      return event->text().c_str();
    }
  }
  return {};
}

}  // namespace

std::vector<Miss> misses_in(const SessionRecording& session, double least_s) {
  const std::vector<Stream> streams = streams_of(session);
  const auto least_ns = std::max(kTick_ns, static_cast<std::int64_t>(kNs_per_s * least_s));
  std::vector<Miss> misses;
  std::vector<Gap> gaps;
  for (const Stream& stream : streams) add_gaps(stream, least_ns, gaps, misses);
  const Forces forces = forces_of(session);
  std::vector<const stillhand_msgs::Event*> stalls;
  for (const stillhand_msgs::Event& event : session.events) {
    if (event.code() == stillhand_msgs::CODE_STALL) stalls.push_back(&event);
  }
  for (Miss& miss : misses) {
    judge(session, forces, miss);
    miss.why = why_in(session, stalls, miss);
  }
  std::ranges::stable_sort(misses, {}, &Miss::from_ns);
  return misses;
}

std::string what_happened(const Miss& miss) {
  std::string text = fmt::format("{} was late by {:.0f} ms", miss.process, 1e3 * miss.late_s);
  if (miss.zero_s > 0.0) text += fmt::format(", force 0 for {:.2f} s", miss.zero_s);
  if (miss.force_before_n > 0.0 && std::isnan(miss.back_s))
    text += ", force not whole again in this trial";
  if (miss.zero_s > 0.0 && miss.back_s > 0.0) {
    text += fmt::format(", whole again after {:.1f} s", miss.back_s);
  }
  return text;
}

}  // namespace stillhand::session
