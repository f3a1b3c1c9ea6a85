// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/bus/bus.hpp"

namespace stillhand::runtime {

/// Which CLOCK_MONOTONIC this process reads: "<boot id> <time namespace>".  Two processes with the
/// same one compare their stamps as they are.
std::string clock_identity();

/// Answers each question of the clock, and passes the resulting offsets to the bus.  Endpoints are
/// made here, so before Bus::start().
void answer_clock_questions(Bus& bus);

}  // namespace stillhand::runtime
