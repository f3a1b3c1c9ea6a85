// SPDX-License-Identifier: Apache-2.0
#include "services/bus/serialized_sample.hpp"

#include <cstring>

#include "fast_dds/types.hpp"
#include "services/bus/type_tag.hpp"

namespace stillhand::runtime {

bool put(const SerializedSample& sample, ertps::SerializedPayload_t& payload) {
  if (sample.size() > payload.max_size) return false;
  std::memcpy(payload.data, sample.data(), sample.size());
  payload.length = static_cast<std::uint32_t>(sample.size());
  return true;
}

SerializedSample to_bytes(const edds::TypeSupport& real, void* message) {
  ertps::SerializedPayload_t payload(size_of(*real, message));
  if (!serialize(*real, message, payload)) return {};
  const auto bytes = bytes_of(payload);
  return {bytes.begin(), bytes.end()};
}

bool from_bytes(const edds::TypeSupport& real, std::span<const std::byte> bytes, void* message) {
  ertps::SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
  payload.length = static_cast<std::uint32_t>(bytes.size());
  std::memcpy(payload.data, bytes.data(), bytes.size());
  return deserialize(*real, payload, message);
}

bool key_of_bytes(const edds::TypeSupport& real, std::span<const std::byte> bytes,
                  ertps::InstanceHandle_t& key, bool force_md5) {
  const auto message = message_of(*real);
  return from_bytes(real, bytes, message.get()) && key_of(*real, message.get(), key, force_md5);
}

edds::TypeSupport carrier_of(const std::string& type, bool keyed) {
  const TypeTag* known = find_type(type);
  return edds::TypeSupport(known != nullptr ? new SerializedType(known->support)
                                            : new SerializedType(type, keyed));
}

}  // namespace stillhand::runtime
