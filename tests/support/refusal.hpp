// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::support {

/// @return the message with which the call refuses what it was given; "accepted": it does not
template <typename Error = ConfigError>
std::string refusal(const auto& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace stillhand::support
