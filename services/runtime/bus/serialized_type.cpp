// SPDX-License-Identifier: Apache-2.0
#include "services/runtime/bus/serialized_type.hpp"

#include <cstring>

namespace stillhand::runtime {

using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

SerializedType::SerializedType(eprosima::fastdds::dds::TypeSupport real) : real_(std::move(real)) {
  setName(real_->getName());
  m_typeSize = real_->m_typeSize;
  m_isGetKeyDefined = real_->m_isGetKeyDefined;
}

bool SerializedType::serialize(void* data, SerializedPayload_t* payload) {
  const auto& sample = *static_cast<const SerializedSample*>(data);
  if (sample.size() > payload->max_size) return false;
  std::memcpy(payload->data, sample.data(), sample.size());
  payload->length = static_cast<std::uint32_t>(sample.size());
  return true;
}

bool SerializedType::deserialize(SerializedPayload_t* payload, void* data) {
  auto& sample = *static_cast<SerializedSample*>(data);
  const auto* bytes = reinterpret_cast<const std::byte*>(payload->data);
  sample.assign(bytes, bytes + payload->length);
  return true;
}

std::function<std::uint32_t()> SerializedType::getSerializedSizeProvider(void* data) {
  return [data] {
    return static_cast<std::uint32_t>(static_cast<const SerializedSample*>(data)->size());
  };
}

void* SerializedType::createData() { return new SerializedSample(); }
void SerializedType::deleteData(void* data) { delete static_cast<SerializedSample*>(data); }

// The key sits inside the bytes; only a writer that sends no key hash makes this necessary.
bool SerializedType::getKey(void* data, InstanceHandle_t* handle, bool force_md5) {
  void* message = real_->createData();
  const bool known = from_bytes(real_, *static_cast<const SerializedSample*>(data), message) &&
                     real_->getKey(message, handle, force_md5);
  real_->deleteData(message);
  return known;
}

SerializedSample to_bytes(eprosima::fastdds::dds::TypeSupport real, void* message) {
  SerializedPayload_t payload(real->getSerializedSizeProvider(message)());
  if (!real->serialize(message, &payload)) return {};
  const auto* bytes = reinterpret_cast<const std::byte*>(payload.data);
  return {bytes, bytes + payload.length};
}

bool from_bytes(eprosima::fastdds::dds::TypeSupport real, const SerializedSample& bytes,
                void* message) {
  SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
  payload.length = static_cast<std::uint32_t>(bytes.size());
  std::memcpy(payload.data, bytes.data(), bytes.size());
  return real->deserialize(&payload, message);
}

}  // namespace stillhand::runtime
