// SPDX-License-Identifier: Apache-2.0
// Fast DDS 3.
#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <memory>

#include "fast_dds/names.hpp"
#include "idl/cdr.hpp"
#include "services/bus/serialized_sample.hpp"

namespace stillhand::runtime {

// What a type does; the representation is always that of Fast DDS 2.
inline constexpr auto kPlainCdr = edds::XCDR_DATA_REPRESENTATION;
inline std::uint32_t size_of(edds::TopicDataType& type, const void* message) {
  return type.calculate_serialized_size(message, kPlainCdr);
}
inline bool serialize(edds::TopicDataType& type, const void* message,
                      ertps::SerializedPayload_t& payload) {
  return type.serialize(message, payload, kPlainCdr);
}
inline bool deserialize(edds::TopicDataType& type, ertps::SerializedPayload_t& payload,
                        void* message) {
  return type.deserialize(payload, message);
}
inline bool key_of(edds::TopicDataType& type, const void* message, ertps::InstanceHandle_t& key,
                   bool force_md5 = false) {
  return type.compute_key(message, key, force_md5);
}
inline std::shared_ptr<void> message_of(edds::TopicDataType& type) {
  return {type.create_data(), [&type](void* message) { type.delete_data(message); }};
}
inline std::string name_of(edds::TopicDataType& type) { return type.get_name(); }
inline bool has_key(const edds::TopicDataType& type) { return type.is_compute_key_provided; }

/// A generated type that several threads may use.  The generated one serialises the key into a
/// member, and one object serves every writer and reader of the process: each thread has its own.
/// It takes a message that ends early for a whole one (fast_cdr::read()).
template <typename Generated>
struct SharedType final : Generated {
  bool deserialize(ertps::SerializedPayload_t& payload, void* data) override {
    return from_cdr(bytes_of(payload), *static_cast<typename Generated::type*>(data));
  }
  using Generated::compute_key;
  bool compute_key(const void* data, ertps::InstanceHandle_t& key, bool force_md5) override {
    thread_local Generated own;
    return own.compute_key(data, key, force_md5);
  }
};

/// Stands in for a real type and keeps each sample's bytes.  Matches the other ends of the real
/// type, since name and key agree.  Of a type of which only the name is known, no key is computed:
/// a sample that comes without a hash of its key counts as the one instance; one that goes out has
/// none.
class SerializedType final : public edds::TopicDataType {
 public:
  explicit SerializedType(edds::TypeSupport real) : real_(std::move(real)) {
    set_name(real_->get_name());
    max_serialized_type_size = real_->max_serialized_type_size;
    is_compute_key_provided = real_->is_compute_key_provided;
  }
  SerializedType(const std::string& name, bool keyed) {
    constexpr std::uint32_t kFirstBytes = 256;  // Fast DDS reserves more when a sample needs it
    set_name(name);
    max_serialized_type_size = kFirstBytes;
    is_compute_key_provided = keyed;
  }
  bool serialize(const void* data, ertps::SerializedPayload_t& payload,
                 edds::DataRepresentationId_t /*plain*/) override {
    return put(*static_cast<const SerializedSample*>(data), payload);
  }
  bool deserialize(ertps::SerializedPayload_t& payload, void* data) override {
    const auto bytes = bytes_of(payload);
    static_cast<SerializedSample*>(data)->assign(bytes.begin(), bytes.end());
    return true;
  }
  std::uint32_t calculate_serialized_size(const void* data,
                                          edds::DataRepresentationId_t /*plain*/) override {
    return static_cast<std::uint32_t>(static_cast<const SerializedSample*>(data)->size());
  }
  void* create_data() override { return new SerializedSample(); }
  void delete_data(void* data) override { delete static_cast<SerializedSample*>(data); }
  bool compute_key(const void* data, ertps::InstanceHandle_t& key, bool force_md5) override {
    return !real_ ||
           key_of_bytes(real_, *static_cast<const SerializedSample*>(data), key, force_md5);
  }
  bool compute_key(ertps::SerializedPayload_t& payload, ertps::InstanceHandle_t& key,
                   bool force_md5) override {
    return !real_ || key_of_bytes(real_, bytes_of(payload), key, force_md5);
  }

 private:
  edds::TypeSupport real_;
};

}  // namespace stillhand::runtime
