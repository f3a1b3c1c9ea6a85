// SPDX-License-Identifier: Apache-2.0
#include "services/messages/human_operator/codec.hpp"

namespace stillhand::human_operator {

OperatorInput from_idl(const stillhand_msgs::TrackingSample& sample, bool active,
                       double felt_m_s2) {
  return {sample.tick(), sample.target_m(), sample.cursor_m(), active, felt_m_s2};
}

stillhand_msgs::OperatorForce to_idl(const OperatorOutput& output, const OperatorInput& input,
                                     std::int64_t trial) {
  stillhand_msgs::OperatorForce message;
  message.tick(input.tick);
  message.force_n(output.force_n);
  message.active(input.active);
  message.trial(static_cast<std::int32_t>(trial));
  message.flags(output.flags);
  return message;
}

}  // namespace stillhand::human_operator
