// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/deploy/profiles.hpp"

namespace stillhand::deploy {

enum class State : std::uint8_t { kGood, kWrong, kNotChecked };

/// What one check found.
struct Finding {
  std::string check;  ///< one word
  State state;
  std::string what;  ///< what the check found
  std::string mend;  ///< how to repair it; empty if nothing is wrong
};

/// The checks of a machine.  Each is a function of its arguments, which machine.hpp reads.  An
/// argument that could not be read gives kNotChecked.

/// @param own  IPv4 addresses of this machine's interfaces
Finding check_address(const Host& host, const std::vector<std::string>& own);

/// State of the kernel's clock discipline (adjtimex).
struct ClockState {
  bool unsynchronised;   ///< STA_UNSYNC
  double worst_error_s;  ///< [s] maxerror
};
Finding check_clock(const std::optional<ClockState>& clock);

/// Limits of a process of this user.
struct Rights {
  std::uint64_t real_time_priority;  ///< RLIMIT_RTPRIO, soft: the limit that the kernel applies
  std::uint64_t locked_memory;       ///< RLIMIT_MEMLOCK, soft [bytes]; ~0: no limit
  bool all;                          ///< CAP_SYS_NICE and CAP_IPC_LOCK, such as root's
};
Finding check_real_time(const Rights& rights);
Finding check_memory_lock(const Rights& rights);

/// @param rmem_max, wmem_max  text of /proc/sys/net/core/...
Finding check_buffers(std::string_view rmem_max, std::string_view wmem_max, const Buffers& wanted);

/// A UDP socket on one of the domain's ports.
struct TakenPort {
  std::uint32_t port;
  std::uint64_t inode;
  std::string program;  ///< name of the program that holds it; empty: unknown
};
/// Sockets of /proc/net/udp and udp6 that receive IPv4, with a local port from `first` to `last`.
std::vector<TakenPort> taken_ports(std::string_view proc_net_udp, std::uint32_t first,
                                   std::uint32_t last);
/// Wrong if a program other than stillhand's holds one of these ports.
Finding check_ports(const std::vector<TakenPort>& taken);

/// @param range, reserved  text of /proc/sys/net/ipv4/ip_local_port_range, ip_local_reserved_ports
Finding check_ephemeral_ports(std::string_view range, std::string_view reserved,
                              std::uint32_t first, std::uint32_t last);

/// @param governors  text of each /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor
Finding check_governor(const std::vector<std::string>& governors);

/// The serial port of a drive.
struct SerialPortState {
  std::string path;                ///< of devices.yaml
  std::string key = "drive.port";  ///< there
  bool exists = false;
  bool open_to_us = false;  ///< may be read and written
  std::string group = {};   ///< that owns it
  std::string latency_timer =
      {};  ///< text of the USB serial driver's latency_timer; empty: has none
};
Finding check_serial_port(const SerialPortState& port);
/// A USB serial chip may collect bytes for 16 ms; at 1 kHz it has to hand them on after 1 ms.
Finding check_latency_timer(const SerialPortState& port);

/// @param flags  text of /sys/class/net/NAME/flags; empty: there is no such interface
Finding check_can_interface(const std::string& name, std::string_view flags);
/// Never wrong: only the process that reads it can say whether it answers.
/// @param device  name of the device, @param key  where devices.yaml has its context
Finding check_iio(const std::string& uri, const std::string& device, const std::string& key);

/// @param refused   message of runtime::check_identity() for each service whose keys it refuses
/// @param expiring  runtime::expiry_warning() of the others
Finding check_keys(const std::vector<std::string>& refused,
                   const std::vector<std::string>& expiring);

/// Wrong if several machines have no keys.
Finding check_security(const Inventory& inventory);
/// @param authority_keys  private keys of an authority in folders that services read
Finding check_authority(const std::vector<std::string>& authority_keys);

/// Never wrong: a ping needs rights, and a closed port proves nothing.  Gives the commands to type.
Finding reachability_commands(const Inventory& inventory, const Host& host);

}  // namespace stillhand::deploy
