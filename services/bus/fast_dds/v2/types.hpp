// SPDX-License-Identifier: Apache-2.0
// Fast DDS 2.
#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <memory>

#include "fast_dds/names.hpp"
#include "idl/cdr.hpp"
#include "services/bus/serialized_sample.hpp"

namespace stillhand::runtime {

// What a type does, with the names and parameters of Fast DDS 3.
inline std::uint32_t size_of(edds::TopicDataType& type, void* message) {
  return type.getSerializedSizeProvider(message)();
}
inline bool serialize(edds::TopicDataType& type, void* message,
                      ertps::SerializedPayload_t& payload) {
  return type.serialize(message, &payload);
}
inline bool deserialize(edds::TopicDataType& type, ertps::SerializedPayload_t& payload,
                        void* message) {
  return type.deserialize(&payload, message);
}
inline bool key_of(edds::TopicDataType& type, void* message, ertps::InstanceHandle_t& key,
                   bool force_md5 = false) {
  return type.getKey(message, &key, force_md5);
}
inline std::shared_ptr<void> message_of(edds::TopicDataType& type) {
  return {type.createData(), [&type](void* message) { type.deleteData(message); }};
}
inline std::string name_of(edds::TopicDataType& type) { return type.getName(); }
inline bool has_key(const edds::TopicDataType& type) { return type.m_isGetKeyDefined; }

/// A generated type that several threads may use.  The generated one serialises the key into a
/// member, and one object serves every writer and reader of the process: each thread has its own.
/// It lets through what Fast CDR throws at bytes that are no message: one such sample would end the
/// process that reads it.
template <typename Generated>
struct SharedType final : Generated {
  bool deserialize(ertps::SerializedPayload_t* payload, void* data) override {
    return from_cdr(bytes_of(*payload), *static_cast<typename Generated::type*>(data));
  }
  bool getKey(void* data, ertps::InstanceHandle_t* key, bool force_md5) override {
    thread_local Generated own;
    return own.getKey(data, key, force_md5);
  }
};

/// Stands in for a real type and keeps each sample's bytes.  Matches the other ends of the real
/// type, since name and key agree.  Of a type of which only the name is known, no key is computed:
/// a sample that comes without a hash of its key counts as the one instance; one that goes out has
/// none.
class SerializedType final : public edds::TopicDataType {
 public:
  explicit SerializedType(edds::TypeSupport real) : real_(std::move(real)) {
    setName(real_->getName());
    m_typeSize = real_->m_typeSize;
    m_isGetKeyDefined = real_->m_isGetKeyDefined;
  }
  SerializedType(const std::string& name, bool keyed) {
    constexpr std::uint32_t kFirstBytes = 256;  // Fast DDS reserves more when a sample needs it
    setName(name.c_str());
    m_typeSize = kFirstBytes;
    m_isGetKeyDefined = keyed;
  }
  bool serialize(void* data, ertps::SerializedPayload_t* payload) override {
    return put(*static_cast<const SerializedSample*>(data), *payload);
  }
  bool deserialize(ertps::SerializedPayload_t* payload, void* data) override {
    const auto bytes = bytes_of(*payload);
    static_cast<SerializedSample*>(data)->assign(bytes.begin(), bytes.end());
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto bytes = static_cast<const SerializedSample*>(data)->size();
    return [bytes] { return static_cast<std::uint32_t>(bytes); };
  }
  void* createData() override { return new SerializedSample(); }
  void deleteData(void* data) override { delete static_cast<SerializedSample*>(data); }
  bool getKey(void* data, ertps::InstanceHandle_t* key, bool force_md5) override {
    return !real_ ||
           key_of_bytes(real_, *static_cast<const SerializedSample*>(data), *key, force_md5);
  }

 private:
  edds::TypeSupport real_;
};

}  // namespace stillhand::runtime
