// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/bus/bus.hpp"
#include "tests/support/own_domain.hpp"

namespace stillhand::support {

/// The shipped profiles on this test program's own domain.
inline runtime::Bus::Options bus_options(const std::string& service) {
  runtime::Bus::Options options;
  options.service = service;
  options.domain = own_domain();
  options.profiles = STILLHAND_SOURCE "/qos/profiles.xml";
  return options;
}

}  // namespace stillhand::support
