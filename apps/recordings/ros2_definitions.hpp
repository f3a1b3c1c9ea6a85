// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>

/// Message definitions of ROS 2 (common_interfaces: std_msgs, geometry_msgs, sensor_msgs,
/// diagnostic_msgs), fields and constants alone, as MCAP holds them in the encoding `ros2msg`: the
/// type first, then each type that it uses behind a line of 80 `=`.
namespace stillhand::recordings {

struct Ros2Definition {
  std::string name;
  std::string text;
};

namespace ros2 {
inline std::string used(const char* name, const char* fields) {
  return fmt::format("{:=<80}\nMSG: {}\n{}", "", name, fields);
}
inline const std::string kHeader =
    fmt::format("{}{}", used("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
                used("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"));
inline const std::string kVector3 =
    used("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
}  // namespace ros2

inline const Ros2Definition kImu{
    "sensor_msgs/msg/Imu",
    fmt::format("std_msgs/Header header\n"
                "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
                "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
                "geometry_msgs/Vector3 linear_acceleration\n"
                "float64[9] linear_acceleration_covariance\n{}{}{}",
                ros2::kHeader, ros2::kVector3,
                ros2::used("geometry_msgs/Quaternion",
                           "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"))};

inline const Ros2Definition kWrenchStamped{
    "geometry_msgs/msg/WrenchStamped",
    fmt::format("std_msgs/Header header\ngeometry_msgs/Wrench wrench\n{}{}{}", ros2::kHeader,
                ros2::used("geometry_msgs/Wrench",
                           "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n"),
                ros2::kVector3)};

inline const Ros2Definition kJointState{
    "sensor_msgs/msg/JointState",
    fmt::format("std_msgs/Header header\nstring[] name\nfloat64[] position\n"
                "float64[] velocity\nfloat64[] effort\n{}",
                ros2::kHeader)};

inline const Ros2Definition kPointStamped{
    "geometry_msgs/msg/PointStamped",
    fmt::format("std_msgs/Header header\ngeometry_msgs/Point point\n{}{}", ros2::kHeader,
                ros2::used("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"))};

inline const Ros2Definition kDiagnosticArray{
    "diagnostic_msgs/msg/DiagnosticArray",
    fmt::format("std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n{}{}{}",
                ros2::kHeader,
                ros2::used("diagnostic_msgs/DiagnosticStatus",
                           "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n"
                           "byte level\nstring name\nstring message\nstring hardware_id\n"
                           "diagnostic_msgs/KeyValue[] values\n"),
                ros2::used("diagnostic_msgs/KeyValue", "string key\nstring value\n"))};

}  // namespace stillhand::recordings
