// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <vector>

namespace stillhand::runtime {

/// Stands in for a real type on the reading side and keeps each sample's bytes as they came: CDR
/// with its 4-byte encapsulation header.  Matches writers of the real type, since name and key
/// agree.
class SerializedType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  explicit SerializedType(eprosima::fastdds::dds::TypeSupport real);

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override;
  void deleteData(void* data) override;
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;

 private:
  eprosima::fastdds::dds::TypeSupport real_;
};

using SerializedSample = std::vector<std::byte>;

/// One message of the real type as bytes; allocates.
SerializedSample to_bytes(eprosima::fastdds::dds::TypeSupport real, void* message);
/// Bytes into a message of the real type.  @return false when they are not one.
bool from_bytes(eprosima::fastdds::dds::TypeSupport real, const SerializedSample& bytes,
                void* message);

}  // namespace stillhand::runtime
