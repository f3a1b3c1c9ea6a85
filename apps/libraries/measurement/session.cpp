// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <optional>

#include "apps/libraries/measurement/session_trials.hpp"
#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/flag.hpp"
#include "services/core/recording/mcap/mcap_loss.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/messages/recording/named_writers.hpp"

namespace stillhand::measurement {
namespace {

// Least share of the sensed ticks that a further topic must have.  With fewer, most ticks would be
// missing rows.
constexpr double kLeastShare = 0.9;

// Samples of one topic in a trial, in tick order, columns first.
template <std::size_t columns>
struct Stream {
  std::vector<Tick> ticks;
  std::array<std::vector<double>, columns> values;
  std::int64_t invalid = 0;  ///< samples without a valid value

  void take(Tick tick, const std::array<double, columns>& sample) {
    if (!ticks.empty() && tick <= ticks.back()) return;  // delivered twice, or late
    if (!std::ranges::all_of(sample, [](double value) { return std::isfinite(value); })) {
      ++invalid;
      return;
    }
    ticks.push_back(tick);
    for (std::size_t i = 0; i < columns; ++i) values[i].push_back(sample[i]);
  }
};

struct TrialStreams {
  Stream<7> sensed;
  Stream<3> motor;  // force, w_0, w_1
  Stream<2> tracking;
};

// A sample with such a flag holds values of an earlier one.
constexpr Flags kNotMeasured = Flag::kInputInvalid | Flag::kFault;

void take_sensed(const stillhand_msgs::Sensed& m, Stream<7>& stream) {
  if ((m.flags() & kNotMeasured) != 0) {
    ++stream.invalid;
    return;
  }
  stream.take(m.tick(), {m.accel_x_m_s2(), m.accel_y_m_s2(), m.accel_z_m_s2(), m.roll_rad(),
                         m.theta_rad(), m.omega_rad_s(), m.force_n()});
}

TrialStreams read_streams(recording::McapReader& reader, const SessionTrial& chosen,
                          std::uint32_t rig) {
  TrialStreams streams;
  recording::MessageFilter filter;
  filter.topics = {std::string(topics::kSensed.name), std::string(topics::kMotorCommand.name)};
  const bool tracking = chosen.trial.phase == TrialPhase::kTracking;
  if (tracking) filter.topics.emplace_back(topics::kTrackingSample.name);
  const recording::Status status =
      recording::for_each_session_message(reader, filter, [&](const recording::MessageView& view) {
        if (view.channel.topic == topics::kSensed.name) {
          stillhand_msgs::Sensed m;
          if (from_cdr(view.bytes, m) && m.rig() == rig && chosen.holds(m.tick())) {
            take_sensed(m, streams.sensed);
          }
          return true;
        }
        if (view.channel.topic == topics::kMotorCommand.name) {
          stillhand_msgs::MotorCommand m;
          if (from_cdr(view.bytes, m) && m.rig() == rig && chosen.holds(m.tick())) {
            streams.motor.take(m.tick(), {m.force_n(), m.gain_weight(), m.phase_weight()});
          }
          return true;
        }
        stillhand_msgs::TrackingSample m;
        if (from_cdr(view.bytes, m) && m.rig() == rig && chosen.holds(m.tick())) {
          streams.tracking.take(m.tick(), {m.target_m(), m.cursor_m()});
        }
        return true;
      });
  // A failure here also occurred in the first pass, and is in the notes.
  (void)status;
  return streams;
}

std::vector<Tick> in_both(const std::vector<Tick>& a, const std::vector<Tick>& b) {
  std::vector<Tick> both;
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  return both;
}

// Keeps the samples at these ticks; the stream has all of them.
template <std::size_t columns>
void keep(Stream<columns>& stream, const std::vector<Tick>& ticks) {
  std::size_t from = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    while (stream.ticks[from] != ticks[i]) ++from;
    for (auto& values : stream.values) values[i] = values[from];
  }
  for (auto& values : stream.values) values.resize(ticks.size());
  stream.ticks = ticks;
}

recording::Recording table_of(TrialStreams streams, bool with_motor, bool with_tracking) {
  // Names and units of the CSV format (services/processes/recording/README.md).
  constexpr std::array<std::array<const char*, 2>, 7> kSensed{{{"a_x", "m/s^2"},
                                                               {"a_y", "m/s^2"},
                                                               {"a_z", "m/s^2"},
                                                               {"roll", "rad"},
                                                               {"theta", "rad"},
                                                               {"omega", "rad/s"},
                                                               {"f", "N"}}};
  constexpr std::array<std::array<const char*, 2>, 2> kTracking{{{"x_r", "m"}, {"x_p", "m"}}};
  recording::Recording rows;
  for (const Tick tick : streams.sensed.ticks) {
    rows.time_s.push_back(static_cast<double>(tick) / kControlRateHz);
  }
  for (std::size_t i = 0; i < kSensed.size(); ++i) {
    rows.columns.push_back({kSensed[i][0], kSensed[i][1], std::move(streams.sensed.values[i])});
  }
  if (with_motor) rows.columns.push_back({"f_motor", "N", std::move(streams.motor.values[0])});
  for (std::size_t i = 0; with_tracking && i < kTracking.size(); ++i) {
    rows.columns.push_back(
        {kTracking[i][0], kTracking[i][1], std::move(streams.tracking.values[i])});
  }
  return rows;
}

}  // namespace

SessionRows read_session_rows(const std::string& path, const std::string& trial, bool last) {
  recording::FileSource file(path);
  recording::McapReader reader(file);
  if (!reader.status().ok()) {
    throw ConfigError(path, reader.status().text, "an MCAP recording of a session, or CSV");
  }
  const SessionTrials trials = find_trials(reader, path);
  const SessionTrial& chosen = choose(trials, trial, path, last);
  SessionRows out;
  out.notes = notes_of(trials, chosen);
  if (chosen.trial.number >= 0 && chosen.trial.phase != TrialPhase::kPegged) {
    out.moves = chosen.name();
  }
  TrialStreams streams = read_streams(reader, chosen, trials.rig);
  const auto enough = [&](const auto& stream) {
    return !stream.ticks.empty() &&
           static_cast<double>(stream.ticks.size()) >=
               kLeastShare * static_cast<double>(streams.sensed.ticks.size());
  };
  const bool with_motor = enough(streams.motor);
  const bool with_tracking = enough(streams.tracking);
  if (streams.sensed.invalid > 0) {
    const auto invalid = streams.sensed.invalid;
    out.notes.push_back(std::to_string(invalid) + (invalid == 1 ? " sample" : " samples") +
                        " without a valid reading: treated as missing.");
  }
  if (!with_tracking && !streams.tracking.ticks.empty()) {
    out.notes.push_back("x_r and x_p left out: most of their samples are missing.");
  }
  std::vector<Tick> ticks = streams.sensed.ticks;
  if (with_motor) ticks = in_both(ticks, streams.motor.ticks);
  if (with_tracking) ticks = in_both(ticks, streams.tracking.ticks);
  keep(streams.sensed, ticks);
  if (with_motor) {
    keep(streams.motor, ticks);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      out.weights.push_back({streams.motor.values[1][i], streams.motor.values[2][i]});
    }
  }
  if (with_tracking) keep(streams.tracking, ticks);
  out.rows = table_of(std::move(streams), with_motor, with_tracking);
  out.rows.source = path;
  if (out.rows.row_count() < 2) {
    throw ConfigError(path + ", trial " + chosen.name(),
                      std::to_string(out.rows.row_count()) + " samples", "a recorded trial");
  }
  recording::estimate_timing(out.rows);
  out.loss = recording::loss_line(path, reader, std::nullopt, file.being_written());
  // A damaged file gives one finding for each lost chunk.
  constexpr std::size_t kMostDamage = 3;
  const auto& damage = reader.damage();
  for (std::size_t i = 0; i < std::min(damage.size(), kMostDamage); ++i) {
    out.notes.push_back("Damaged file: " + damage[i].text + ".");
  }
  if (damage.size() > kMostDamage) {
    out.notes.push_back("Damaged file: " + std::to_string(damage.size() - kMostDamage) +
                        " more findings.");
  }
  return out;
}

}  // namespace stillhand::measurement
