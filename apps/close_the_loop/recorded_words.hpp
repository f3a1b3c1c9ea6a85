// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/close_the_loop/recorded/recorded_loop.hpp"

namespace stillhand::close_the_loop {

/// "1.2 [1.1, 1.3]"
std::string level_text(const Level& level);
/// "12.3 % [10.1, 14.2]", of the force.
std::string cut_text(const Remaining& remaining);

/// One effect, as a clause.
std::string finding_text(const Finding& finding, const std::string& unit);
/// Why no effect counts; empty: one does.
std::string conclusion_text(const RecordedLoop& loop);
/// What the effects together explain of the unseen records, by the predictions.
std::string unseen_size_text(const RecordedLoop& loop);
/// The share of the force that the motor takes away, or the prediction where no motor was run.
std::string cuts_text(const RecordedLoop& loop);
/// What became of the augmented model, METHOD Eq. CL-9; empty: it is the linear one.
std::string kept_text(const RecordedLoop& loop);
/// Why no motor ran, or ran with one model alone; empty: both ran.
std::string motor_text(const RecordedLoop& loop);
/// Why the motor leaves more with the augmented model than its prediction does; empty: it does not.
std::string parted_text(const RecordedLoop& loop);

}  // namespace stillhand::close_the_loop
