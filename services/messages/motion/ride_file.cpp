// SPDX-License-Identifier: Apache-2.0
#include "services/messages/motion/ride_file.hpp"

#include <cmath>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::motion {
namespace {

// A straight line across eleven periods misses a sine of 6 Hz, the platform's bandwidth, by
// (2 pi 6 0.011)^2/8 = 2 % of its amplitude at most.
constexpr std::int64_t kBridged_ticks = 10;

// The rate of rows, each within half a period of its place on an even grid.
double even_rate_hz(const std::string& path, const std::vector<double>& time_s) {
  const double period_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    const double place_s = time_s.front() + static_cast<double>(i) * period_s;
    if (std::abs(time_s[i] - place_s) > 0.5 * period_s) {
      throw ConfigError(path + ", row " + std::to_string(i + 1), "times that are not evenly spaced",
                        "a row every " + std::to_string(period_s) + " s, as on average");
    }
  }
  return 1.0 / period_s;
}

RideRecord from_csv(const std::string& path) {
  const recording::Recording file = recording::read_csv(path);
  const recording::Column* accel = file.find("a_y");
  if (accel == nullptr) throw ConfigError(path, "no column a_y", "a_y [m/s^2]");
  if (!file.gaps.empty()) {
    const recording::Gap& gap = file.gaps.front();
    throw ConfigError(path + ", row " + std::to_string(gap.after_row + 1),
                      "a gap of " + std::to_string(gap.missing_rows) + " rows after it",
                      "a ride without missing rows");
  }
  return {even_rate_hz(path, file.time_s), accel->values, path};
}

// Puts a session's sample after the ones before; false when it cannot follow them.
bool append(RideRecord& ride, std::int64_t lost_ticks, double accel_m_s2) {
  if (lost_ticks < 0 || lost_ticks > kBridged_ticks) return false;
  const double last = ride.accel_m_s2.empty() ? accel_m_s2 : ride.accel_m_s2.back();
  for (std::int64_t i = 1; i <= lost_ticks; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(lost_ticks + 1);
    ride.accel_m_s2.push_back(last + share * (accel_m_s2 - last));
  }
  ride.accel_m_s2.push_back(accel_m_s2);
  return true;
}

RideRecord from_mcap(const std::string& path) {
  recording::FileSource file(path);
  recording::McapReader reader(file);
  if (!reader.status().ok()) throw ConfigError(path, reader.status().text, "an MCAP recording");
  RideRecord ride{kControlRateHz, {}, path};
  std::int64_t last_tick = -1;
  std::int64_t gap_after = -1;
  recording::MessageFilter filter;
  filter.topics = {std::string(topics::kSensed.name)};
  const recording::Status status =
      reader.for_each_message(filter, [&](const recording::MessageView& view) {
        stillhand_msgs::Sensed message;
        if (!from_cdr(view.bytes, message)) return true;
        const std::int64_t lost = last_tick < 0 ? 0 : message.tick() - last_tick - 1;
        if (!append(ride, lost, message.accel_y_m_s2())) {
          gap_after = last_tick;
          return false;
        }
        last_tick = message.tick();
        return true;
      });
  if (!status.ok()) throw ConfigError(path, status.text, "an undamaged recording");
  if (ride.accel_m_s2.empty()) {
    throw ConfigError(path, "no messages of " + std::string(topics::kSensed.name),
                      "a recording of a session");
  }
  if (gap_after >= 0) {
    throw ConfigError(
        path, "ticks missing after tick " + std::to_string(gap_after),
        "a recording that lost at most " + std::to_string(kBridged_ticks) + " ticks in a row");
  }
  return ride;
}

}  // namespace

RideRecord read_ride(const std::string& path) {
  return path.ends_with(".mcap") ? from_mcap(path) : from_csv(path);
}

}  // namespace stillhand::motion
