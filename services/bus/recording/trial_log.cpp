// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/trial_log.hpp"

#include "idl/cdr.hpp"
#include "idl/session.h"
#include "idl/topics.hpp"

namespace stillhand::recording {

using runtime::FoundWriter;
using runtime::TappedSample;

void TrialLog::take(const FoundWriter& writer, const TappedSample& sample) {
  if (writer.topic != topics::kTrialControl.name || writer.type != topics::kTrialControl.type) {
    return;
  }
  stillhand_msgs::TrialControl control;
  if (!from_cdr(sample.bytes, control) || control.trial() < 0) return;
  const std::lock_guard lock(mutex_);
  newest_ = control.trial();
  const std::string trial = "trial " + std::to_string(control.trial());
  texts_[trial + " phase"] = control.phase() == stillhand_msgs::PHASE_PEGGED     ? "pegged"
                             : control.phase() == stillhand_msgs::PHASE_TRACKING ? "tracking"
                             : control.phase() == stillhand_msgs::PHASE_FREE     ? "free"
                                                                                 : "idle";
  texts_[trial + " start_tick"] = std::to_string(control.start_tick());
  texts_[trial + " duration_ticks"] = std::to_string(control.duration_ticks());
  texts_[trial + " reference_seed"] = std::to_string(control.reference_seed());
}

std::int64_t TrialLog::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

TextMap TrialLog::texts() const {
  const std::lock_guard lock(mutex_);
  return texts_;
}

}  // namespace stillhand::recording
