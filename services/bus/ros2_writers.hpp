// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace stillhand::runtime {

/// Writes messages on a domain as a node of ROS 2 does.  A participant of its own, that reads
/// nothing.  Every topic has the prefix `rt/` of ROS 2, so none is a topic of a session.  QoS:
/// reliable, volatile, keep last 10, ROS 2's default: both reliable and best-effort readers match.
/// write() waits for no reader: a reader that is slow or dead misses all but the newest ten.  One
/// thread.
class Ros2Writers {
 public:
  /// @param addresses  own addresses on which readers are reached: no others, not those of the
  ///                   profiles of Stillhand
  /// @throws ConfigError for an address that no interface has; BusError when DDS refuses.
  Ros2Writers(std::uint32_t domain, const std::string& name,
              const std::vector<std::string>& addresses);
  ~Ros2Writers();

  /// @param topic  its name in ROS 2, such as "/rig_1/imu"
  /// @param type   DDS type name  @param hash  of the type (REP-2011)
  /// @returns its number  @throws BusError
  std::size_t add(const std::string& topic, const std::string& type, const std::string& hash);
  /// CDR with its encapsulation header.  @returns false when DDS did not take it.
  bool write(std::size_t writer, std::span<const std::byte> bytes);
  /// Readers matched with this writer now.
  [[nodiscard]] std::uint32_t matched(std::size_t writer) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stillhand::runtime
