// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "services/bus/writer_qos.hpp"

namespace stillhand::runtime {

/// A writer that was found on the bus.
struct FoundWriter {
  std::string topic;
  std::string type;         ///< DDS type name
  std::string participant;  ///< its name; "" until DDS announces it
  std::string id;           ///< GUID as text
  std::string profile;      ///< QoS profile of a topic of the catalogue, or ""
  std::string user_data;    ///< USER_DATA if it is a text, for example ROS 2's hash of the type
  /// Definition of the type, from idl/ or from discovery; "": not known.  As long as the Tap.
  std::string_view idl;
  WriterQos qos;
  bool replayed = false;    ///< it carries the replay's mark
  bool type_known = false;  ///< idl/ defines its type
  bool wanted = true;       ///< its topic was asked for
  bool present = true;      ///< it has not left yet
};

/// One sample as it came.
struct TappedSample {
  std::size_t writer;                ///< its writer's number, in the order of finding
  std::int64_t sequence;             ///< RTPS sequence number of that writer
  std::int64_t source_ns;            ///< [ns] system clock of the writer's host, as DDS stamped it
  std::int64_t logged_ns;            ///< [ns] log_ns() of received_ns
  std::int64_t received_ns;          ///< [ns] CLOCK_MONOTONIC
  std::span<const std::byte> bytes;  ///< CDR with encapsulation header, valid during the call
};

}  // namespace stillhand::runtime
