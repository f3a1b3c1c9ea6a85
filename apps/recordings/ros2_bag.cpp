// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/ros2_bag.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "apps/recordings/pending_file.hpp"
#include "apps/recordings/ros2_definitions.hpp"
#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "version.hpp"

namespace stillhand::recordings {
namespace {

using fast_cdr::PlainCdr;
using recording::MessageView;

constexpr std::uint64_t kNsPerSecond = 1'000'000'000;

/// diagnostic_msgs/msg/DiagnosticStatus.
enum class Level : std::uint8_t { kOk, kWarn, kError };
using Values = std::vector<std::pair<std::string, std::string>>;

struct Vector3 {
  double x = 0.0, y = 0.0, z = 0.0;
};

void put(PlainCdr& cdr, const Vector3& vector) { cdr << vector.x << vector.y << vector.z; }

void put_header(PlainCdr& cdr, std::uint64_t time_ns, const std::string& frame) {
  cdr << static_cast<std::int32_t>(time_ns / kNsPerSecond)
      << static_cast<std::uint32_t>(time_ns % kNsPerSecond) << frame;
}

// sensor_msgs/Imu: the first element of a covariance is -1 for what is not measured, and a
// covariance of zeros is one that is not known.
void put_covariance(PlainCdr& cdr, bool measured) {
  cdr << (measured ? 0.0 : -1.0);
  for (int i = 1; i < 9; ++i) cdr << 0.0;
}

// Twice, as to_cdr() does: the second time into zeros, so that padding is zero.
std::vector<std::byte> cdr_of(const std::function<void(PlainCdr&)>& fill) {
  const auto written = [&fill](eprosima::fastcdr::FastBuffer& buffer) {
    PlainCdr cdr(buffer);
    cdr.serialize_encapsulation();
    fill(cdr);
    return cdr.length();
  };
  eprosima::fastcdr::FastBuffer grown;
  std::vector<std::byte> bytes(written(grown));
  eprosima::fastcdr::FastBuffer exact(reinterpret_cast<char*>(bytes.data()), bytes.size());
  written(exact);
  return bytes;
}

std::string text_of(double value) { return fmt::format("{:g}", value); }
template <typename Number>
std::string text_of(Number value) {
  return fmt::format("{}", value);
}

class Bag {
 public:
  Bag(OpenRecording& recording, recording::ByteSink& sink)
      : recording_(recording), writer_(sink, options()) {
    on<stillhand_msgs::Sensed>(topics::kSensed, [this](const auto& m) { put_sensed(m); });
    on<stillhand_msgs::MotorCommand>(topics::kMotorCommand, [this](const auto& m) {
      put_wrench(m.rig(), "motor", m.force_n());
    });
    on<stillhand_msgs::PlatformCommand>(topics::kPlatformCommand, [this](const auto& m) {
      put_joint(m.rig(), "platform", -m.position_m(), -m.velocity_m_s());
    });
    on<stillhand_msgs::TrackingSample>(topics::kTrackingSample, [this](const auto& m) {
      put_point(m.rig(), "target", m.target_m());
      put_point(m.rig(), "cursor", m.cursor_m());
    });
    on<stillhand_msgs::ServiceStatus>(topics::kServiceStatus,
                                      [this](const auto& m) { put_status(m); });
    on<stillhand_msgs::Event>(topics::kEvent, [this](const auto& m) { put_event(m); });
  }

  Ros2Bag write() {
    std::uint64_t messages = 0;
    check(recording_.reader.for_each_message({}, [&](const MessageView& message) {
      ++messages;
      const auto found = handlers_.find(message.channel.topic);
      if (found == handlers_.end() || message.channel.metadata.contains("replayed")) return true;
      now_ = &message;
      if (!found->second(message.bytes)) ++bag_.unread;
      return writer_.status().ok();
    }));
    if (bag_.topics.empty()) {
      throw ConfigError(recording_.path, "no topic that a bag of ROS 2 would hold",
                        "the recording of a session, with stillhand/sensed");
    }
    check(writer_.close());
    recording_.report_loss(messages);
    return bag_;
  }

 private:
  static recording::McapWriterOptions options() {
    recording::McapWriterOptions options;
    options.library = std::string("stillhand ") + kVersion;
    options.profile = "ros2";
    return options;
  }

  template <typename Message, typename Put>
  void on(const topics::Topic& topic, Put put) {
    handlers_[std::string(topic.name)] = [put](std::span<const std::byte> bytes) {
      Message message;
      if (!from_cdr(bytes, message)) return false;
      put(message);
      return true;
    };
  }

  void put(const std::string& topic, const Ros2Definition& type,
           const std::function<void(PlainCdr&)>& fill) {
    auto channel = channels_.find(topic);
    if (channel == channels_.end()) {
      auto schema = schemas_.find(type.name);
      if (schema == schemas_.end()) {
        schema =
            schemas_.emplace(type.name, writer_.add_schema(type.name, "ros2msg", type.text)).first;
      }
      const auto id =
          writer_.add_channel(topic, schema->second, "cdr", {{"offered_qos_profiles", ""}});
      channel = channels_.emplace(topic, id).first;
    }
    const auto bytes = cdr_of(fill);
    check(writer_.write(channel->second, static_cast<std::uint32_t>(++bag_.topics[topic]),
                        now_->log_time_ns, now_->publish_time_ns, bytes));
  }

  static std::string under(std::uint32_t rig, const std::string& name) {
    return fmt::format("/rig_{}/{}", rig, name);
  }
  void header(PlainCdr& cdr, const std::string& frame) const {
    put_header(cdr, now_->log_time_ns, frame);
  }

  void put_sensed(const stillhand_msgs::Sensed& sensed) {
    put(under(sensed.rig(), "imu"), kImu, [&](PlainCdr& cdr) {
      header(cdr, "platform");
      // Roll, positive with the right side down, is a rotation about x: (sin, 0, 0, cos) of half.
      cdr << std::sin(0.5 * sensed.roll_rad()) << 0.0 << 0.0 << std::cos(0.5 * sensed.roll_rad());
      put_covariance(cdr, true);
      recordings::put(cdr, Vector3{});
      put_covariance(cdr, false);
      recordings::put(cdr, {sensed.accel_x_m_s2(), -sensed.accel_y_m_s2(), sensed.accel_z_m_s2()});
      put_covariance(cdr, true);
    });
    put_wrench(sensed.rig(), "hand", sensed.force_n());
    // The stick turns about x too: with its top to the right, theta is positive.
    put_joint(sensed.rig(), "stick", sensed.theta_rad(), sensed.omega_rad_s());
  }

  void put_wrench(std::uint32_t rig, const std::string& of, double right_n) {
    put(under(rig, of + "/wrench"), kWrenchStamped, [&](PlainCdr& cdr) {
      header(cdr, "stick");
      recordings::put(cdr, {0.0, -right_n, 0.0});
      recordings::put(cdr, Vector3{});
    });
  }

  void put_joint(std::uint32_t rig, const std::string& name, double position, double velocity) {
    put(under(rig, name + "/joint_states"), kJointState, [&](PlainCdr& cdr) {
      header(cdr, "");
      cdr << std::vector<std::string>{name} << std::vector<double>{position}
          << std::vector<double>{velocity} << std::vector<double>{};
    });
  }

  void put_point(std::uint32_t rig, const std::string& name, double right_m) {
    put(under(rig, name), kPointStamped, [&](PlainCdr& cdr) {
      header(cdr, "screen");
      recordings::put(cdr, {0.0, -right_m, 0.0});
    });
  }

  void put_diagnostics(Level level, const std::string& name, const std::string& message,
                       const Values& values) {
    put("/diagnostics", kDiagnosticArray, [&](PlainCdr& cdr) {
      header(cdr, "");
      cdr << std::uint32_t{1} << static_cast<std::uint8_t>(level) << name << message
          << std::string() << static_cast<std::uint32_t>(values.size());
      for (const auto& [key, value] : values) cdr << key << value;
    });
  }

  void put_status(const stillhand_msgs::ServiceStatus& status) {
    std::uint64_t lost = 0, misses = 0, late = 0;
    Values values{{"tick", text_of(status.tick())}, {"missing", status.missing().c_str()}};
    for (const auto& topic : status.topics()) {
      lost += topic.lost_ticks();
      misses += topic.deadline_misses();
      late += topic.cycle_misses();
      if (!topic.written() && topic.samples() > 0) {
        values.emplace_back(fmt::format("{} latency p99 [us]", topic.topic().c_str()),
                            text_of(topic.latency_p99_us()));
      }
    }
    values.emplace_back("lost ticks", text_of(lost));
    values.emplace_back("deadline misses", text_of(misses));
    values.emplace_back("late cycles", text_of(late));
    const bool fault = status.state() == stillhand_msgs::SERVICE_FAULT;
    const bool whole = lost + misses == 0 && status.missing().size() == 0;
    put_diagnostics(fault   ? Level::kError
                    : whole ? Level::kOk
                            : Level::kWarn,
                    under(status.rig(), status.service().c_str()), fault ? "fault" : "runs",
                    values);
  }

  void put_event(const stillhand_msgs::Event& event) {
    const bool note =
        event.kind() == stillhand_msgs::EVENT_NOTE || event.kind() == stillhand_msgs::EVENT_COMMAND;
    put_diagnostics(note ? Level::kOk : Level::kWarn,
                    under(event.rig(), fmt::format("{}/event", event.source().c_str())),
                    event.text().c_str(),
                    {{"topic", event.topic().c_str()}, {"peer", event.peer().c_str()}});
  }

  OpenRecording& recording_;
  recording::McapWriter writer_;
  std::map<std::string, std::function<bool(std::span<const std::byte>)>> handlers_;
  std::map<std::string, recording::SchemaId> schemas_;
  std::map<std::string, recording::ChannelId> channels_;
  const MessageView* now_ = nullptr;
  Ros2Bag bag_;
};

}  // namespace

Ros2Bag write_ros2_bag(const std::string& recording, const std::filesystem::path& out,
                       const Stopped& stopped) {
  OpenRecording source(recording, stopped);
  PendingFile pending(out.string());
  recording::FileSink sink(pending.path());
  const Ros2Bag bag = Bag(source, sink).write();
  go_on_unless(stopped);
  pending.publish();
  return bag;
}

}  // namespace stillhand::recordings
