// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "apps/libraries/experiment/core/plan.hpp"

namespace stillhand::experiment {

inline constexpr const char* kSealedFile = "assignment.sealed";
inline constexpr const char* kOpenedFile = "assignment.json";

/// Content of assignment.sealed: the seed of the orders and a nonce as JSON, in hexadecimal digits,
/// so that a glance does not show it.  It is no secret to a person with this program.
std::string sealed_text(std::uint64_t order_seed);
/// @throws ConfigError for a text that sealed_text() did not make
std::uint64_t order_seed_of(const std::string& sealed, const std::string& origin);

/// Content of assignment.json: each participant's labels with their conditions, and order.
/// @param only  index of the one participant whose they are; nothing: everybody's
std::string opened_text(const Design& design, const Assignment& assignment,
                        std::optional<std::size_t> only = {});

}  // namespace stillhand::experiment
