// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "tests/support/memory_bytes.hpp"

namespace stillhand::tests {

/// A session's recording in memory, message by message, 1 ms apart.
class SessionFile {
 public:
  /// @param schemas  definition of a type by its name; empty: one that describes no message
  explicit SessionFile(std::size_t chunk_bytes = std::size_t{256} << 10,
                       recording::Compression compression = recording::Compression::kZstd,
                       std::function<std::string_view(std::string_view)> schemas = {})
      : writer_(sink_, {chunk_bytes, compression, "stillhand-test"}),
        schemas_(std::move(schemas)) {}

  template <typename Message>
  void add(const topics::Topic& topic, const Message& message) {
    auto [channel, fresh] = channels_.try_emplace(std::string(topic.name) + writer_guid_, 0);
    if (fresh) {
      const std::string text(schemas_ ? schemas_(topic.type) : "struct S {};");
      const auto schema = writer_.add_schema(std::string(topic.type), "omgidl", text);
      recording::TextMap texts;
      if (!writer_guid_.empty()) texts["writer"] = writer_guid_;
      channel->second = writer_.add_channel(std::string(topic.name), schema, "cdr", texts);
    }
    time_ns_ += 1'000'000;
    ok_ = ok_ && writer_.write(channel->second, 0, time_ns_, time_ns_, to_cdr(message)).ok();
  }

  /// The DDS writer of what is added from now on, as the recorder notes it; empty: none.
  void written_by(const std::string& guid) { writer_guid_ = guid; }

  /// A metadata record.
  void metadata(const std::string& name, const recording::TextMap& texts) {
    ok_ = ok_ && writer_.add_metadata(name, texts).ok();
  }

  /// A trial begins; number -1: none runs any more.
  void control(std::int32_t number, stillhand_msgs::Phase phase = stillhand_msgs::PHASE_IDLE,
               std::int64_t start_tick = 0, std::int64_t duration_ticks = 0) {
    stillhand_msgs::TrialControl message;
    message.session(stillhand_msgs::SESSION_RUNNING);
    message.trial(number);
    message.phase(phase);
    message.start_tick(start_tick);
    message.duration_ticks(duration_ticks);
    add(topics::kTrialControl, message);
  }

  /// The blinded part of it.
  void assignment(std::int32_t number, stillhand_msgs::MotionKind motion, bool cancellation) {
    stillhand_msgs::TrialAssignment message;
    message.trial(number);
    message.motion(motion);
    message.cancellation(cancellation);
    add(topics::kTrialAssignment, message);
  }

  /// Every field another function of the tick: n/1000 times 1, 2, ... in the order of the message.
  void sensed(std::int64_t tick, std::uint32_t flags = 0, std::uint32_t rig = 0) {
    const double t = static_cast<double>(tick) / 1000.0;
    stillhand_msgs::Sensed message;
    message.rig(rig);
    message.tick(tick);
    message.accel_x_m_s2(t);
    message.accel_y_m_s2(2.0 * t);
    message.accel_z_m_s2(3.0 * t);
    message.roll_rad(4.0 * t);
    message.force_n(5.0 * t);
    message.theta_rad(6.0 * t);
    message.omega_rad_s(7.0 * t);
    message.flags(flags);
    add(topics::kSensed, message);
  }

  void tracking(std::int64_t tick) {
    const double t = static_cast<double>(tick) / 1000.0;
    stillhand_msgs::TrackingSample message;
    message.tick(tick);
    message.target_m(8.0 * t);
    message.cursor_m(9.0 * t);
    add(topics::kTrackingSample, message);
  }

  /// Ends the file.  @return its bytes, or nothing when writing failed
  std::vector<std::byte> close() {
    ok_ = ok_ && writer_.close().ok();
    return ok_ ? sink_.bytes() : std::vector<std::byte>{};
  }

 private:
  recording::MemorySink sink_;
  recording::McapWriter writer_;
  std::function<std::string_view(std::string_view)> schemas_;
  std::map<std::string, recording::ChannelId> channels_;
  std::string writer_guid_;
  std::uint64_t time_ns_ = 0;
  bool ok_ = true;
};

}  // namespace stillhand::tests
