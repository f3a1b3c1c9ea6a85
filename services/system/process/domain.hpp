// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand::runtime {

/// UDP ports of a DDS domain, RTPS 2.2, 9.6.1.1, with the default parameters: a block for each.
inline constexpr std::uint32_t kDomainPorts = 250;
/// Above it ports run out.
inline constexpr std::uint32_t kMaxDomain = 232;

/// The first of them: where participants that seek each other by multicast listen.
constexpr std::uint32_t first_port_of(std::uint32_t domain) { return 7400 + kDomainPorts * domain; }

}  // namespace stillhand::runtime
