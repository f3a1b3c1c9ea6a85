// SPDX-License-Identifier: Apache-2.0
#include "apps/ros2_bridge/ros2_bridge_command.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

#include "apps/libraries/ros2/converter.hpp"
#include "apps/ros2_bridge/ros2_bridge.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/domain.hpp"
#include "services/system/process/shipped.hpp"

namespace stillhand::ros2_bridge {
namespace {

int run(const BridgeOptions& options) {
  for (const std::string& pattern : options.topics) {
    const recording::TopicFilter filter{{pattern}, {}};
    if (std::ranges::any_of(ros2::sources(), [&](auto topic) { return filter.wants(topic); })) {
      continue;
    }
    throw ConfigError("--topics", pattern,
                      fmt::format("one of {}, or a pattern", fmt::join(ros2::sources(), ", ")));
  }
  runtime::Stop stop;
  return run_bridge(options, stop);
}

}  // namespace

void add_ros2_bridge_command(command_line::Command& cli, int& status) {
  auto options = std::make_shared<BridgeOptions>();
  options->profiles = runtime::shipped("qos/profiles.xml");
  command_line::Command verb = cli.add_subcommand(
      "ros2-bridge",
      "Publishes a running session for ROS 2: sensor_msgs/Imu, geometry_msgs/WrenchStamped,\n"
      "sensor_msgs/JointState and so on, the topics of `export --ros2bag`. It only listens to\n"
      "the session: none waits for it, and nothing from ROS 2 comes in. It needs no ROS 2, and\n"
      "ends with Ctrl-C. Nodes with ROS 2's default settings are reached once --ros-address names\n"
      "the address of this machine's network; without it, nodes on the loopback alone.\n"
      "Example: stillhand ros2-bridge --topics stillhand/sensed, then `ros2 topic echo "
      "/rig_1/imu`");
  verb.add_option("--topics", options->topics,
                  "pattern of topics of the session to publish (* any run "
                  "of characters, ? one); may be repeated")
      .repeatable();
  verb.add_flag("--replay", options->replay,
                "publish what `stillhand replay` plays, in the place of a session");
  verb.add_option("--domain", options->domain, "DDS domain of the session")
      .check(settings::number_between(0.0, runtime::kMaxDomain));
  verb.add_option("--ros-domain", options->ros_domain,
                  "domain of ROS 2; without it, that of ROS_DOMAIN_ID")
      .envname("ROS_DOMAIN_ID")
      .check(settings::number_between(0.0, runtime::kMaxDomain));
  verb.add_option("--ros-address", options->addresses,
                  "address of this machine on which ROS 2 is reached, "
                  "besides 127.0.0.1; may be repeated")
      .repeatable();
  verb.add_option("--profiles", options->profiles, "QoS profiles of the session");
  verb.add_option("--security", options->security,
                  "folder of certificates for a secured domain; what ROS 2 gets is not secured");
  verb.callback([options, &status] { status = run(*options); });
}

}  // namespace stillhand::ros2_bridge
