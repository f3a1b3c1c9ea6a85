// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "fast_dds/types.hpp"
#include "idl/clockPubSubTypes.h"
#include "idl/control_loopPubSubTypes.h"
#include "idl/modelPubSubTypes.h"
#include "idl/recordingPubSubTypes.h"
#include "idl/sessionPubSubTypes.h"
#include "services/bus/bus.hpp"
#include "services/bus/type_tag.hpp"

namespace stillhand::runtime {

/// Every type of the catalogue and of the remote control.
#define STILLHAND_MESSAGES(TYPE) \
  TYPE(PlatformCommand)          \
  TYPE(RawSample)                \
  TYPE(RigTruth)                 \
  TYPE(Sensed)                   \
  TYPE(MotorCommand)             \
  TYPE(TrackingSample)           \
  TYPE(OperatorForce)            \
  TYPE(Pointer)                  \
  TYPE(TrialControl)             \
  TYPE(TrialAssignment)          \
  TYPE(FeedthroughModel)         \
  TYPE(AugmentedModel)           \
  TYPE(Event)                    \
  TYPE(ServiceStatus)            \
  TYPE(HostStatus)               \
  TYPE(SessionCommand)           \
  TYPE(SessionSources)           \
  TYPE(Prompt)                   \
  TYPE(Answer)                   \
  TYPE(ClockQuestion)            \
  TYPE(ClockAnswer)              \
  TYPE(ClockOffset)              \
  TYPE(RecorderCommand)          \
  TYPE(RecorderStatus)           \
  TYPE(ReplayCommand)            \
  TYPE(ReplayStatus)

#define STILLHAND_TYPE_TAG(Name)                                                \
  template <>                                                                   \
  const TypeTag& type_tag<stillhand_msgs::Name>() {                             \
    static const TypeTag tag{                                                   \
        edds::TypeSupport(new SharedType<stillhand_msgs::Name##PubSubType>())}; \
    return tag;                                                                 \
  }
STILLHAND_MESSAGES(STILLHAND_TYPE_TAG)
#undef STILLHAND_TYPE_TAG

const TypeTag* find_type(std::string_view type_name) {
#define STILLHAND_POINTER(Name) &type_tag<stillhand_msgs::Name>(),
  const std::array tags{STILLHAND_MESSAGES(STILLHAND_POINTER)};
#undef STILLHAND_POINTER
  for (const TypeTag* tag : tags) {
    if (tag->support.get_type_name() == type_name) return tag;
  }
  return nullptr;
}

}  // namespace stillhand::runtime
