// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/ros2/converter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/session.h"
#include "idl/topics.hpp"

namespace stillhand::ros2 {
namespace {

using fast_cdr::PlainCdr;

constexpr std::uint64_t kNsPerSecond = 1'000'000'000;

/// diagnostic_msgs/msg/DiagnosticStatus.
enum class Level : std::uint8_t { kOk, kWarn, kError };
using Values = std::vector<std::pair<std::string, std::string>>;

struct Vector3 {
  double x = 0.0, y = 0.0, z = 0.0;
};

void put(PlainCdr& cdr, const Vector3& vector) { cdr << vector.x << vector.y << vector.z; }

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

/// The messages of ROS 2 that one message becomes.
class Conversion {
 public:
  explicit Conversion(std::uint64_t time_ns) : time_ns_(time_ns) {}

  void take(const stillhand_msgs::MotorCommand& command) {
    put_wrench(command.rig(), "motor", command.force_n());
  }
  void take(const stillhand_msgs::PlatformCommand& command) {
    put_joint(command.rig(), "platform", -command.position_m(), -command.velocity_m_s());
  }
  void take(const stillhand_msgs::TrackingSample& sample) {
    put_point(sample.rig(), "target", sample.target_m());
    put_point(sample.rig(), "cursor", sample.cursor_m());
  }
  void take(const stillhand_msgs::Sensed& sensed) {
    add(under(sensed.rig(), "imu"), kImu, [&](PlainCdr& cdr) {
      header(cdr, "platform");
      // Roll, positive with the right side down, is a rotation about x: (sin, 0, 0, cos) of half.
      cdr << std::sin(0.5 * sensed.roll_rad()) << 0.0 << 0.0 << std::cos(0.5 * sensed.roll_rad());
      put_covariance(cdr, true);
      put(cdr, Vector3{});
      put_covariance(cdr, false);
      put(cdr, {sensed.accel_x_m_s2(), -sensed.accel_y_m_s2(), sensed.accel_z_m_s2()});
      put_covariance(cdr, true);
    });
    put_wrench(sensed.rig(), "hand", sensed.force_n());
    // The stick turns about x too: with its top to the right, theta is positive.
    put_joint(sensed.rig(), "stick", sensed.theta_rad(), sensed.omega_rad_s());
  }

  void take(const stillhand_msgs::ServiceStatus& status) {
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

  void take(const stillhand_msgs::Event& event) {
    const bool note =
        event.kind() == stillhand_msgs::EVENT_NOTE || event.kind() == stillhand_msgs::EVENT_COMMAND;
    put_diagnostics(note ? Level::kOk : Level::kWarn,
                    under(event.rig(), fmt::format("{}/event", event.source().c_str())),
                    event.text().c_str(),
                    {{"topic", event.topic().c_str()}, {"peer", event.peer().c_str()}});
  }

  std::vector<Message> messages;

 private:
  void add(std::string topic, const Definition& type, const std::function<void(PlainCdr&)>& fill) {
    messages.push_back({std::move(topic), &type, cdr_of(fill)});
  }
  static std::string under(std::uint32_t rig, const std::string& name) {
    return fmt::format("/rig_{}/{}", rig, name);
  }
  void header(PlainCdr& cdr, const std::string& frame) const {
    cdr << static_cast<std::int32_t>(time_ns_ / kNsPerSecond)
        << static_cast<std::uint32_t>(time_ns_ % kNsPerSecond) << frame;
  }

  void put_wrench(std::uint32_t rig, const std::string& of, double right_n) {
    add(under(rig, of + "/wrench"), kWrenchStamped, [&](PlainCdr& cdr) {
      header(cdr, "stick");
      put(cdr, {0.0, -right_n, 0.0});
      put(cdr, Vector3{});
    });
  }

  void put_joint(std::uint32_t rig, const std::string& name, double position, double velocity) {
    add(under(rig, name + "/joint_states"), kJointState, [&](PlainCdr& cdr) {
      header(cdr, "");
      cdr << std::vector<std::string>{name} << std::vector<double>{position}
          << std::vector<double>{velocity} << std::vector<double>{};
    });
  }

  void put_point(std::uint32_t rig, const std::string& name, double right_m) {
    add(under(rig, name), kPointStamped, [&](PlainCdr& cdr) {
      header(cdr, "screen");
      put(cdr, {0.0, -right_m, 0.0});
    });
  }

  void put_diagnostics(Level level, const std::string& name, const std::string& message,
                       const Values& values) {
    add("/diagnostics", kDiagnosticArray, [&](PlainCdr& cdr) {
      header(cdr, "");
      cdr << std::uint32_t{1} << static_cast<std::uint8_t>(level) << name << message
          << std::string() << static_cast<std::uint32_t>(values.size());
      for (const auto& [key, value] : values) cdr << key << value;
    });
  }

  std::uint64_t time_ns_;
};

template <typename Message>
bool convert(std::span<const std::byte> bytes, Conversion& into) {
  Message message;
  if (!from_cdr(bytes, message)) return false;
  into.take(message);
  return true;
}

using Convert = bool (*)(std::span<const std::byte>, Conversion&);
const std::map<std::string_view, Convert>& conversions() {
  static const std::map<std::string_view, Convert> all{
      {topics::kSensed.name, convert<stillhand_msgs::Sensed>},
      {topics::kMotorCommand.name, convert<stillhand_msgs::MotorCommand>},
      {topics::kPlatformCommand.name, convert<stillhand_msgs::PlatformCommand>},
      {topics::kTrackingSample.name, convert<stillhand_msgs::TrackingSample>},
      {topics::kServiceStatus.name, convert<stillhand_msgs::ServiceStatus>},
      {topics::kEvent.name, convert<stillhand_msgs::Event>}};
  return all;
}

}  // namespace

const std::vector<std::string_view>& sources() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const auto& [name, convert] : conversions()) all.push_back(name);
    return all;
  }();
  return names;
}

std::optional<std::vector<Message>> converted(std::string_view topic,
                                              std::span<const std::byte> bytes,
                                              std::uint64_t time_ns) {
  Conversion conversion(time_ns);
  const auto found = conversions().find(topic);
  if (found != conversions().end() && !found->second(bytes, conversion)) return std::nullopt;
  return std::move(conversion.messages);
}

std::string dds_type(const Definition& type) {
  const auto package = type.name.find('/');
  const auto name = type.name.rfind('/');
  return type.name.substr(0, package) + "::msg::dds_::" + type.name.substr(name + 1) + "_";
}

}  // namespace stillhand::ros2
