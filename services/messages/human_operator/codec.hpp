// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/control_loop.h"
#include "services/core/human_operator/crossover_operator.hpp"

namespace stillhand::human_operator {

OperatorInput from_idl(const stillhand_msgs::TrackingSample& sample, bool active, double felt_m_s2);
stillhand_msgs::OperatorForce to_idl(const OperatorOutput& output, const OperatorInput& input,
                                     std::int64_t trial);

}  // namespace stillhand::human_operator
