// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace stillhand::tests {

/// A CDR message written value by value: little endian, each value aligned to its size from the end
/// of the encapsulation (OMG DDS-XTypes 1.3, 7.4.3).
class CdrBytes {
 public:
  template <typename Value>
  CdrBytes& put(Value value) {
    while ((bytes_.size() - kEncapsulation) % sizeof(Value) != 0) bytes_.push_back(std::byte{0});
    const auto* raw = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), raw, raw + sizeof(Value));
    return *this;
  }
  CdrBytes& text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size() + 1));
    for (const char c : value) bytes_.push_back(static_cast<std::byte>(c));
    bytes_.push_back(std::byte{0});
    return *this;
  }
  [[nodiscard]] const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  static constexpr std::size_t kEncapsulation = 4;
  std::vector<std::byte> bytes_{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
};

/// The definition of sensor_msgs/msg/Imu as a ROS 2 recording holds it, comments shortened.
inline const char* imu_definition() {
  return "# This is a message to hold data from an IMU (Inertial Measurement Unit)\n"
         "std_msgs/Header header\n"
         "\n"
         "geometry_msgs/Quaternion orientation\n"
         "float64[9] orientation_covariance # Row major about x, y, z axes\n"
         "geometry_msgs/Vector3 angular_velocity\n"
         "float64[9] angular_velocity_covariance\n"
         "geometry_msgs/Vector3 linear_acceleration\n"
         "float64[9] linear_acceleration_covariance\n"
         "\n"
         "================================================================================\n"
         "MSG: geometry_msgs/Quaternion\n"
         "float64 x 0\n"
         "float64 y 0\n"
         "float64 z 0\n"
         "float64 w 1\n"
         "================================================================================\n"
         "MSG: geometry_msgs/Vector3\n"
         "float64 x\n"
         "float64 y\n"
         "float64 z\n"
         "================================================================================\n"
         "MSG: std_msgs/Header\n"
         "builtin_interfaces/Time stamp\n"
         "string frame_id\n"
         "================================================================================\n"
         "MSG: builtin_interfaces/Time\n"
         "int32 sec\n"
         "uint32 nanosec\n";
}

}  // namespace stillhand::tests
