// SPDX-License-Identifier: Apache-2.0
// Messages as they come from the bus or out of a recording: the first byte selects a topic's type,
// the rest is the message.  Two readers: that of recordings, by definition, and the generated type
// on Fast CDR, as every process calls it.
#include <array>
#include <map>
#include <span>
#include <string>

#include "idl/cdr.hpp"
#include "idl/clock.h"
#include "idl/control_loop.h"
#include "idl/idl_text.hpp"
#include "idl/model.h"
#include "idl/recording.h"
#include "idl/session.h"
#include "tests/fuzz/read_types.hpp"

namespace {

using namespace stillhand;
using namespace stillhand_msgs;

struct TopicType {
  const char* name;
  void (*read)(std::span<const std::byte> bytes);
};

template <typename Message>
void read(std::span<const std::byte> bytes) {
  Message message;
  from_cdr(bytes, message);
}

// New ones at the end: seeds.cpp counts on the places.
constexpr std::array kTypes{TopicType{"MotorCommand", read<MotorCommand>},
                            TopicType{"Sensed", read<Sensed>},
                            TopicType{"TrialControl", read<TrialControl>},
                            TopicType{"FeedthroughModel", read<FeedthroughModel>},
                            TopicType{"AugmentedModel", read<AugmentedModel>},
                            TopicType{"ServiceStatus", read<ServiceStatus>},
                            TopicType{"Event", read<Event>},
                            TopicType{"HostStatus", read<HostStatus>},
                            TopicType{"RecorderCommand", read<RecorderCommand>},
                            TopicType{"ClockOffset", read<ClockOffset>},
                            TopicType{"PlatformCommand", read<PlatformCommand>},
                            TopicType{"RawSample", read<RawSample>},
                            TopicType{"RigTruth", read<RigTruth>},
                            TopicType{"TrackingSample", read<TrackingSample>},
                            TopicType{"OperatorForce", read<OperatorForce>},
                            TopicType{"Pointer", read<Pointer>},
                            TopicType{"RecorderStatus", read<RecorderStatus>},
                            TopicType{"ReplayCommand", read<ReplayCommand>},
                            TopicType{"ReplayStatus", read<ReplayStatus>},
                            TopicType{"SessionSources", read<SessionSources>},
                            TopicType{"TrialAssignment", read<TrialAssignment>},
                            TopicType{"SessionCommand", read<SessionCommand>},
                            TopicType{"ClockQuestion", read<ClockQuestion>},
                            TopicType{"ClockAnswer", read<ClockAnswer>},
                            TopicType{"Prompt", read<Prompt>},
                            TopicType{"Answer", read<Answer>}};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const TopicType& type = kTypes[bytes[0] % kTypes.size()];
  const auto message = std::as_bytes(std::span(bytes + 1, size - 1));
  const std::string name = std::string("stillhand_msgs::") + type.name;
  static std::map<std::string, recording::IdlSchema> schemas;
  const auto [schema, is_new] = schemas.try_emplace(name);
  if (is_new) schema->second = recording::parse_idl(topics::idl_of(name), "catalogue");
  fuzz::read_message(schema->second, *schema->second.find(name), message);
  type.read(message);
  return 0;
}
