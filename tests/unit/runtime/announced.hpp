// SPDX-License-Identifier: Apache-2.0
// Participants and writers as DDS announces them, made by hand: no bus is needed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/bus/announced.hpp"
#include "services/bus/replay_mark.hpp"

namespace stillhand::runtime::announced {

inline ertps::GuidPrefix_t prefix_of(std::uint8_t number) {
  ertps::GuidPrefix_t prefix;
  prefix.value[0] = number;
  prefix.value[11] = 0xa0;
  return prefix;
}

/// Writer number `writer` of a participant.
inline ertps::GUID_t guid_of(std::uint8_t participant, std::uint8_t writer = 1) {
  return {prefix_of(participant), std::uint32_t{writer} << 8 | 0x02};
}

inline ertps::InstanceHandle_t handle_of(std::uint8_t participant, std::uint8_t writer = 1) {
  return ertps::InstanceHandle_t(guid_of(participant, writer));
}

inline AnnouncedParticipant participant(std::uint8_t number, const std::string& name,
                                        bool marked = false) {
  return {prefix_of(number), name, marked ? replay_mark() : std::vector<std::uint8_t>{}};
}

inline AnnouncedWriter writer(std::uint8_t participant, std::uint8_t number,
                              const std::string& topic, const std::string& type,
                              const std::vector<std::uint8_t>& user_data = {}) {
  AnnouncedWriter writer{guid_of(participant, number), topic, type, {}};
  writer.qos.m_userData.data_vec(user_data);
  return writer;
}

/// What is announced when it leaves.
template <typename Announced>
Announced gone(Announced announced) {
  announced.here = false;
  return announced;
}

}  // namespace stillhand::runtime::announced
