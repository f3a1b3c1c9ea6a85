// SPDX-License-Identifier: Apache-2.0
// Messages as they come from the bus or out of a recording: the first byte selects a topic's type,
// the rest is the message.  Two readers: that of recordings, by definition, and the generated type
// on Fast CDR, as every process calls it.
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include <string>

#include "idl/clock.h"
#include "idl/control_loop.h"
#include "idl/idl_text.hpp"
#include "idl/model.h"
#include "idl/recording.h"
#include "idl/session.h"
#include "services/recording/core/messages/message_columns.hpp"
#include "services/recording/core/messages/omgidl.hpp"

namespace {

using namespace stillhand;

void read_by_definition(const std::string& name, std::span<const std::byte> message) {
  const auto schema = recording::parse_idl(topics::idl_of("stillhand_msgs::" + name), "catalogue");
  recording::MessageColumns columns(schema, *schema.find("stillhand_msgs::" + name));
  columns.learn(message);
  columns.settle();
  std::vector<recording::Cell> row;
  columns.read(message, row);
}

template <typename Message>
void read(const char* name, std::vector<char>& bytes) {
  read_by_definition(name, std::as_bytes(std::span(bytes)));
  try {
    eprosima::fastcdr::FastBuffer buffer(bytes.data(), bytes.size());
    eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN,
                               eprosima::fastcdr::Cdr::DDS_CDR);
    cdr.read_encapsulation();
    Message message;
    message.deserialize(cdr);
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace stillhand_msgs;
  if (size == 0) return 0;
  std::vector<char> message(bytes + 1, bytes + size);
  switch (bytes[0] % 10) {
    case 0:
      read<MotorCommand>("MotorCommand", message);
      break;
    case 1:
      read<Sensed>("Sensed", message);
      break;
    case 2:
      read<TrialControl>("TrialControl", message);
      break;
    case 3:
      read<FeedthroughModel>("FeedthroughModel", message);
      break;
    case 4:
      read<AugmentedModel>("AugmentedModel", message);
      break;
    case 5:
      read<ServiceStatus>("ServiceStatus", message);
      break;
    case 6:
      read<Event>("Event", message);
      break;
    case 7:
      read<HostStatus>("HostStatus", message);
      break;
    case 8:
      read<RecorderCommand>("RecorderCommand", message);
      break;
    default:
      read<ClockOffset>("ClockOffset", message);
      break;
  }
  return 0;
}
