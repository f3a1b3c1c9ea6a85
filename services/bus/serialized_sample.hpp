// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <span>
#include <vector>

#include "fast_dds/names.hpp"

namespace stillhand::runtime {

/// A sample as it came: CDR with its 4-byte encapsulation header.
using SerializedSample = std::vector<std::byte>;

inline std::span<const std::byte> bytes_of(const ertps::SerializedPayload_t& payload) {
  return std::as_bytes(std::span(payload.data, payload.length));
}
/// @returns false when there is no room
bool put(const SerializedSample& sample, ertps::SerializedPayload_t& payload);

/// One message of the real type as bytes; allocates.
SerializedSample to_bytes(const edds::TypeSupport& real, void* message);
/// Bytes into a message of the real type.  @return false when they are not one.
bool from_bytes(const edds::TypeSupport& real, std::span<const std::byte> bytes, void* message);
/// The key sits inside the bytes; only a writer that sends no key hash makes this necessary.
bool key_of_bytes(const edds::TypeSupport& real, std::span<const std::byte> bytes,
                  ertps::InstanceHandle_t& key, bool force_md5);

/// Carries the bytes of a type, whether idl/ defines it or only its name is known.
edds::TypeSupport carrier_of(const std::string& type, bool keyed);

}  // namespace stillhand::runtime
