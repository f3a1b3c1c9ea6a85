// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "idl/control_loopPubSubTypes.h"
#include "idl/modelPubSubTypes.h"
#include "idl/sessionPubSubTypes.h"
#include "runtime/bus.hpp"
#include "runtime/type_tag.hpp"

namespace stillhand::runtime {

#define STILLHAND_MESSAGE(Name)                                                       \
  template <>                                                                         \
  const TypeTag& type_tag<stillhand_msgs::Name>() {                                   \
    static const TypeTag tag{                                                         \
        eprosima::fastdds::dds::TypeSupport(new stillhand_msgs::Name##PubSubType())}; \
    return tag;                                                                       \
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
STILLHAND_MESSAGE(Event)
STILLHAND_MESSAGE(ServiceStatus)

#undef STILLHAND_MESSAGE

const TypeTag* find_type(std::string_view type_name) {
  using namespace stillhand_msgs;  // NOLINT(google-build-using-namespace): the list below
  const std::array tags{
      &type_tag<PlatformCommand>(), &type_tag<RawSample>(),        &type_tag<RigTruth>(),
      &type_tag<Sensed>(),          &type_tag<MotorCommand>(),     &type_tag<TrackingSample>(),
      &type_tag<OperatorForce>(),   &type_tag<Pointer>(),          &type_tag<TrialControl>(),
      &type_tag<TrialAssignment>(), &type_tag<FeedthroughModel>(), &type_tag<Event>(),
      &type_tag<ServiceStatus>()};
  for (const TypeTag* tag : tags) {
    if (tag->support.get_type_name() == type_name) return tag;
  }
  return nullptr;
}

}  // namespace stillhand::runtime
