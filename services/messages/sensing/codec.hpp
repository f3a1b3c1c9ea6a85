// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/control_loop.h"
#include "services/core/sensing/conditioner.hpp"

namespace stillhand::sensing {

DeviceSample from_idl(const stillhand_msgs::RawSample& message);
/// @param raw  the raw sample; its tick and acquisition stamp are copied
stillhand_msgs::Sensed to_idl(const Sensed& sensed, const stillhand_msgs::RawSample& raw);

}  // namespace stillhand::sensing
