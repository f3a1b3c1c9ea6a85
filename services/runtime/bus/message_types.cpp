// SPDX-License-Identifier: Apache-2.0
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>
#include <fastrtps/utils/md5.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <span>

#include "idl/cdr.hpp"
#include "idl/clockPubSubTypes.h"
#include "idl/control_loopPubSubTypes.h"
#include "idl/modelPubSubTypes.h"
#include "idl/recordingPubSubTypes.h"
#include "idl/sessionPubSubTypes.h"
#include "services/runtime/bus/bus.hpp"
#include "services/runtime/bus/type_tag.hpp"

namespace stillhand::runtime {

namespace {

/// What the generated types do that a process of several threads cannot stand.
template <typename Generated>
struct Guarded final : Generated {
  // They let through what Fast CDR throws at bytes that are no message: one such sample would end
  // the process that reads it.
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    try {
      if (Generated::deserialize(payload, data)) return true;
    } catch (const eprosima::fastcdr::exception::Exception&) {
    }
    // A replay of an earlier version's recording.
    using Message = typename Generated::type;
    if (!kEarlierForm<Message>.fits(payload->length)) return false;
    return from_cdr(std::as_bytes(std::span(payload->data, payload->length)),
                    *static_cast<Message*>(data));
  }

  // They serialise the key into a member, while one object serves every writer and reader of the
  // process: two threads at once would both get a mixture.  The same on the stack.
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override {
    using Message = typename Generated::type;
    constexpr std::size_t kHashBytes = 16;  // RTPS 2.2, 9.6.3.3
    std::array<char, 256> bytes{};
    if (!this->m_isGetKeyDefined || Message::getKeyMaxCdrSerializedSize() > bytes.size()) {
      return false;
    }
    eprosima::fastcdr::FastBuffer buffer(bytes.data(), bytes.size());
    eprosima::fastcdr::Cdr key(buffer, eprosima::fastcdr::Cdr::BIG_ENDIANNESS);
    static_cast<const Message*>(data)->serializeKey(key);
    if (!force_md5 && Message::getKeyMaxCdrSerializedSize() <= kHashBytes) {
      std::copy_n(bytes.begin(), kHashBytes, &handle->value[0]);
      return true;
    }
    MD5 hash;
    hash.update(bytes.data(), static_cast<unsigned int>(key.getSerializedDataLength()));
    hash.finalize();
    std::copy_n(std::begin(hash.digest), kHashBytes, &handle->value[0]);
    return true;
  }
};

}  // namespace

#define STILLHAND_MESSAGE(Name)                                                                \
  template <>                                                                                  \
  const TypeTag& type_tag<stillhand_msgs::Name>() {                                            \
    static const TypeTag tag{                                                                  \
        eprosima::fastdds::dds::TypeSupport(new Guarded<stillhand_msgs::Name##PubSubType>())}; \
    return tag;                                                                                \
  }

STILLHAND_MESSAGE(PlatformCommand)
STILLHAND_MESSAGE(RawSample)
STILLHAND_MESSAGE(RigTruth)
STILLHAND_MESSAGE(Sensed)
STILLHAND_MESSAGE(MotorCommand)
STILLHAND_MESSAGE(TrackingSample)
STILLHAND_MESSAGE(OperatorForce)
STILLHAND_MESSAGE(Pointer)
STILLHAND_MESSAGE(TrialControl)
STILLHAND_MESSAGE(TrialAssignment)
STILLHAND_MESSAGE(FeedthroughModel)
STILLHAND_MESSAGE(AugmentedModel)
STILLHAND_MESSAGE(Event)
STILLHAND_MESSAGE(ServiceStatus)
STILLHAND_MESSAGE(HostStatus)
STILLHAND_MESSAGE(SessionCommand)
STILLHAND_MESSAGE(SessionSources)
STILLHAND_MESSAGE(Prompt)
STILLHAND_MESSAGE(Answer)
STILLHAND_MESSAGE(ClockQuestion)
STILLHAND_MESSAGE(ClockAnswer)
STILLHAND_MESSAGE(ClockOffset)
STILLHAND_MESSAGE(RecorderCommand)
STILLHAND_MESSAGE(RecorderStatus)
STILLHAND_MESSAGE(ReplayCommand)
STILLHAND_MESSAGE(ReplayStatus)

#undef STILLHAND_MESSAGE

const TypeTag* find_type(std::string_view type_name) {
  using namespace stillhand_msgs;  // NOLINT(google-build-using-namespace): the list below
  const std::array tags{&type_tag<PlatformCommand>(),
                        &type_tag<RawSample>(),
                        &type_tag<RigTruth>(),
                        &type_tag<Sensed>(),
                        &type_tag<MotorCommand>(),
                        &type_tag<TrackingSample>(),
                        &type_tag<OperatorForce>(),
                        &type_tag<Pointer>(),
                        &type_tag<TrialControl>(),
                        &type_tag<TrialAssignment>(),
                        &type_tag<FeedthroughModel>(),
                        &type_tag<AugmentedModel>(),
                        &type_tag<Event>(),
                        &type_tag<ServiceStatus>(),
                        &type_tag<ClockQuestion>(),
                        &type_tag<ClockAnswer>(),
                        &type_tag<ClockOffset>(),
                        &type_tag<RecorderCommand>(),
                        &type_tag<RecorderStatus>(),
                        &type_tag<ReplayCommand>(),
                        &type_tag<ReplayStatus>(),
                        &type_tag<HostStatus>(),
                        &type_tag<SessionCommand>(),
                        &type_tag<SessionSources>(),
                        &type_tag<Prompt>(),
                        &type_tag<Answer>()};
  for (const TypeTag* tag : tags) {
    if (tag->support.get_type_name() == type_name) return tag;
  }
  return nullptr;
}

}  // namespace stillhand::runtime
