// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/recording/messages/omgidl_cursor.hpp"
#include "services/core/recording/messages/omgidl_names.hpp"

namespace stillhand::recording {

/// Reads a whole number at the cursor: sums and products of literals, constants and brackets.
/// @throws stillhand::ConfigError where there is none, beyond 32 bits, or with more than 64 nested
///         brackets, which would exhaust the stack
std::int64_t whole_number(IdlCursor& in, const IdlNames& names);

}  // namespace stillhand::recording
