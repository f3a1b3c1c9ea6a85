// SPDX-License-Identifier: Apache-2.0
#include "motion/ride_file.hpp"

#include "contract/config_error.hpp"
#include "contract/tick.hpp"
#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/topics.hpp"
#include "recording/core/mcap_reader.hpp"
#include "recording/file_io.hpp"

namespace stillhand::motion {
namespace {

Ride from_csv(const std::string& path) {
  const recording::Recording file = recording::read_csv(path);
  const recording::Column* accel = file.find("a_y");
  if (accel == nullptr) throw ConfigError(path, "no column a_y", "a_y [m/s^2]");
  if (!file.gaps.empty()) {
    const recording::Gap& gap = file.gaps.front();
    throw ConfigError(path + ", row " + std::to_string(gap.after_row + 1),
                      "a gap of " + std::to_string(gap.missing_rows) + " rows after it",
                      "a ride without missing rows");
  }
  return {file.rate_hz, accel->values};
}

Ride from_mcap(const std::string& path) {
  recording::FileSource file(path);
  recording::McapReader reader(file);
  if (!reader.status().ok()) throw ConfigError(path, reader.status().text, "an MCAP recording");
  Ride ride{kControlRateHz, {}};
  std::int64_t last_tick = -1;
  std::int64_t gap_after = -1;
  recording::MessageFilter filter;
  filter.topics = {std::string(topics::kSensed.name)};
  const recording::Status status =
      reader.for_each_message(filter, [&](const recording::MessageView& view) {
        stillhand_msgs::Sensed message;
        if (!from_cdr(view.bytes, message)) return true;
        if (last_tick >= 0 && message.tick() != last_tick + 1) gap_after = last_tick;
        last_tick = message.tick();
        ride.accel_m_s2.push_back(message.accel_y_m_s2());
        return gap_after < 0;
      });
  if (!status.ok()) throw ConfigError(path, status.text, "an undamaged recording");
  if (ride.accel_m_s2.empty()) {
    throw ConfigError(path, "no messages of " + std::string(topics::kSensed.name),
                      "a recording of a session");
  }
  if (gap_after >= 0) {
    throw ConfigError(path, "ticks missing after tick " + std::to_string(gap_after),
                      "a ride without gaps");
  }
  return ride;
}

}  // namespace

Ride read_ride(const std::string& path) {
  return path.ends_with(".mcap") ? from_mcap(path) : from_csv(path);
}

}  // namespace stillhand::motion
