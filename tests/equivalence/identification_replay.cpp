// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "services/bus/trial_codec.hpp"
#include "services/core/identification/pegged_record.hpp"
#include "services/messages/identification/codec.hpp"
#include "tests/equivalence/core_replays.hpp"
#include "tests/equivalence/recorded_trial.hpp"

namespace stillhand::equivalence {
namespace {

namespace msgs = stillhand_msgs;

/// Ticks in [first, end) of the sensed topic that did not reach the identification, from its own
/// events.  Gaps within a tenth of a second share one event, which names the first of them alone.
std::set<Tick> lost_by_identification(const SessionRecording& session, Tick first, Tick end) {
  constexpr Tick kSharing_ticks = 1000;  // ten times that, for a process that was held up
  std::set<Tick> lost;
  for (const msgs::Event& event : session.events) {
    if (event.kind() != msgs::EVENT_TICKS_LOST ||
        std::string(event.source().c_str()) != "identification") {
      continue;
    }
    const Tick begin = event.tick() - static_cast<Tick>(event.by_us() / 1000.0);  // a tick is 1 ms
    const bool shared = event.text().size() > 0;
    if (shared && event.tick() + kSharing_ticks > first && begin < end) {
      throw NotRecorded("which ticks reached the identification about tick " +
                        std::to_string(event.tick()) + " is not in the recording");
    }
    for (Tick tick = std::max(begin, first); tick < std::min(event.tick(), end); ++tick) {
      lost.insert(tick);
    }
  }
  return lost;
}

}  // namespace

Replay replay_identification(const SessionRecording& session, const SessionSettings& settings) {
  const auto config = settings.of<identification::Config>("identification");
  const ByTick sensed("sensed", session.sensed);
  Replay result;
  result.core = "identification";
  result.recorded = std::ssize(session.models);
  try {
    for (const msgs::FeedthroughModel& model : session.models) {
      const Trial trial = runtime::from_idl(of_trial(session.trial_controls, model.trial()));
      const Tick end = trial.start_tick + trial.duration_ticks;
      if (result.compared == 0) result.first_tick = trial.start_tick;
      const std::set<Tick> lost = lost_by_identification(session, trial.start_tick, end);
      const bool free = trial.phase == TrialPhase::kFree;
      identification::PeggedRecord pegged;
      pegged.begin(trial);
      for (Tick tick = trial.start_tick; pegged.active(); ++tick) {
        if (lost.count(tick) != 0) {
          ++result.unseen;
          continue;
        }
        const msgs::Sensed& sample = sensed.at(tick);
        pegged.take(tick, sample.accel_y_m_s2(),
                    free ? identification::displacement_m(sample.theta_rad()) : sample.force_n());
      }
      const identification::PeggedTrial collected = pegged.release();
      auto answer =
          identification::to_idl(free ? identification::identify_position(collected, config)
                                      : identification::identify(collected, config),
                                 model.model(), static_cast<std::int32_t>(model.trial()));
      answer.to_position(free);
      // When the fit was done is the machine's doing, as the stamp is.
      answer.from_tick(model.from_tick());
      compare(answer, model, trial.start_tick, result);
    }
  } catch (const NotRecorded& reason) {
    result.ended = reason.what();
  }
  return result;
}

}  // namespace stillhand::equivalence
