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

#define STILLHAND_MESSAGE(Name)                                                 \
  template <>                                                                   \
  const TypeTag& type_tag<stillhand_msgs::Name>() {                             \
    static const TypeTag tag{                                                   \
        edds::TypeSupport(new SharedType<stillhand_msgs::Name##PubSubType>())}; \
    return tag;                                                                 \
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
