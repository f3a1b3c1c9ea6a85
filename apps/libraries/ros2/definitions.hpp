// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>

/// Message definitions of ROS 2 (common_interfaces: std_msgs, geometry_msgs, sensor_msgs,
/// diagnostic_msgs), fields and constants alone.
namespace stillhand::ros2 {

struct Definition {
  std::string name;
  /// As MCAP holds it in the encoding `ros2msg`: the type first, then each type that it uses behind
  /// a line of 80 `=`.
  std::string text;
  /// REP-2011: SHA-256 of names and types of the fields, which ROS 2 compares from Iron on.
  std::string hash;
};

namespace detail {
inline std::string used(const char* name, const char* fields) {
  return fmt::format("{:=<80}\nMSG: {}\n{}", "", name, fields);
}
inline const std::string kHeader =
    fmt::format("{}{}", used("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
                used("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"));
inline const std::string kVector3 =
    used("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
}  // namespace detail

inline const Definition kImu{
    "sensor_msgs/msg/Imu",
    fmt::format("std_msgs/Header header\n"
                "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
                "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
                "geometry_msgs/Vector3 linear_acceleration\n"
                "float64[9] linear_acceleration_covariance\n{}{}{}",
                detail::kHeader, detail::kVector3,
                detail::used("geometry_msgs/Quaternion",
                             "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n")),
    "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"};

inline const Definition kWrenchStamped{
    "geometry_msgs/msg/WrenchStamped",
    fmt::format("std_msgs/Header header\ngeometry_msgs/Wrench wrench\n{}{}{}", detail::kHeader,
                detail::used("geometry_msgs/Wrench",
                             "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n"),
                detail::kVector3),
    "RIHS01_8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77"};

inline const Definition kJointState{
    "sensor_msgs/msg/JointState",
    fmt::format("std_msgs/Header header\nstring[] name\nfloat64[] position\n"
                "float64[] velocity\nfloat64[] effort\n{}",
                detail::kHeader),
    "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"};

inline const Definition kPointStamped{
    "geometry_msgs/msg/PointStamped",
    fmt::format("std_msgs/Header header\ngeometry_msgs/Point point\n{}{}", detail::kHeader,
                detail::used("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n")),
    "RIHS01_4c0296af86e01e562e9e0405d138a01537247580076c58ea38d7923ac1045897"};

inline const Definition kDiagnosticArray{
    "diagnostic_msgs/msg/DiagnosticArray",
    fmt::format("std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n{}{}{}",
                detail::kHeader,
                detail::used("diagnostic_msgs/DiagnosticStatus",
                             "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n"
                             "byte level\nstring name\nstring message\nstring hardware_id\n"
                             "diagnostic_msgs/KeyValue[] values\n"),
                detail::used("diagnostic_msgs/KeyValue", "string key\nstring value\n")),
    "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"};

}  // namespace stillhand::ros2
