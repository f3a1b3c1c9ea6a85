// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/model_stages.hpp"

#include <algorithm>

namespace stillhand::lab {

Actions ModelWait::step(Seen& seen, std::int64_t now_ns) {
  constexpr std::int64_t kLimit_ns = 60'000'000'000;
  if (limit_ns_ < 0) limit_ns_ = now_ns + kLimit_ns;
  const bool came = seen.model && seen.model->trial == trial_;
  const Wait wait = trouble_.wait(came, seen, limit_ns_, now_ns);
  if (wait == Wait::kGoesOn) return {};
  finish();
  if (wait != Wait::kOver) {
    failure_ = trouble_.why_stopped(seen, "identification gave no model within 60 s");
  } else if (!seen.model->usable) {
    failure_ = "no usable model, a longer --identify-seconds helps: " + seen.model->text;
  }
  return {};
}

Actions ModelUse::step(Seen& seen, std::int64_t now_ns) {
  constexpr std::int64_t kLimit_ns = 5'000'000'000;
  if (limit_ns_ < 0) {
    limit_ns_ = now_ns + kLimit_ns;
    seen.events.clear();
    Actions actions;
    actions.give_model_from = seen.newest_tick() + kModelNotice_ticks;
    return actions;
  }
  const auto answer = std::ranges::find_if(seen.events, [](const EventSeen& event) {
    return event.kind == EventKind::kModelRefused || event.kind == EventKind::kModelLoaded;
  });
  const Wait wait = trouble_.wait(answer != seen.events.end(), seen, limit_ns_, now_ns);
  if (wait == Wait::kGoesOn) return {};
  finish();
  if (wait != Wait::kOver) {
    failure_ = trouble_.why_stopped(seen, "the canceller did not answer within 5 s");
  } else if (answer->kind == EventKind::kModelRefused) {
    refusal_ = answer->text;
  }
  return {};
}

Actions RecordingWait::step(Seen& seen, std::int64_t now_ns) {
  constexpr std::int64_t kLimit_ns = 10'000'000'000;
  if (limit_ns_ < 0) limit_ns_ = now_ns + kLimit_ns;
  const Wait wait = trouble_.wait(seen.recorded_tick >= end_tick_, seen, limit_ns_, now_ns);
  if (wait == Wait::kGoesOn) return {};
  finish();
  if (wait != Wait::kOver) {
    failure_ = trouble_.why_stopped(seen, "the recorder's disk did not have the trial within 10 s");
  }
  return {};
}

}  // namespace stillhand::lab
