// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/codec.hpp"

#include <cstddef>

#include "idl/enumerator.hpp"

namespace stillhand::lab {
namespace {

EventKind kind_of(stillhand_msgs::EventKind kind) {
  switch (kind) {
    case stillhand_msgs::EVENT_INTERLOCK_OPENED:
      return EventKind::kInterlockOpened;
    case stillhand_msgs::EVENT_FORCE_ZERO:
      return EventKind::kForceZero;
    case stillhand_msgs::EVENT_MODEL_REFUSED:
      return EventKind::kModelRefused;
    case stillhand_msgs::EVENT_MODEL_LOADED:
      return EventKind::kModelLoaded;
    case stillhand_msgs::EVENT_NOTE:
      return EventKind::kNote;
    default:
      return EventKind::kOther;
  }
}

// Actions and prompts of session and bus have one order.
Action action_of(stillhand_msgs::SessionAction action) {
  return of_bus(action, stillhand_msgs::SESSION_ABORT, Action::kUnknown);
}
static_assert(static_cast<std::size_t>(stillhand_msgs::SESSION_START) ==
              static_cast<std::size_t>(Action::kStart));
static_assert(static_cast<std::size_t>(stillhand_msgs::SESSION_ABORT) ==
              static_cast<std::size_t>(Action::kAbort));
static_assert(static_cast<std::size_t>(stillhand_msgs::PROMPT_NOTHING) ==
              static_cast<std::size_t>(PromptKind::kNothing));
static_assert(static_cast<std::size_t>(stillhand_msgs::PROMPT_END) ==
              static_cast<std::size_t>(PromptKind::kEnd));

}  // namespace

ProcessSeen from_idl(const stillhand_msgs::ServiceStatus& status) {
  ProcessSeen seen;
  seen.matched = status.state() != stillhand_msgs::SERVICE_STARTING;
  seen.missing = status.missing().c_str();
  seen.tick = status.tick();
  seen.armed_trial = status.armed_trial();
  for (const stillhand_msgs::TopicStatus& topic : status.topics()) {
    if (topic.written()) continue;
    seen.misses.deadline += static_cast<std::int64_t>(topic.deadline_misses());
    seen.misses.cycle += static_cast<std::int64_t>(topic.cycle_misses());
    seen.misses.lost_ticks += static_cast<std::int64_t>(topic.lost_ticks());
  }
  return seen;
}

EventSeen from_idl(const stillhand_msgs::Event& event) {
  const session::Mark mark = session::mark_of(event);
  return {kind_of(event.kind()),  mark.what,       mark.source,  mark.topic, mark.peer, mark.text,
          session::line_of(mark), mark.first_tick, mark.worst_us};
}

session::Mark mark_of(const EventSeen& event) {
  return {event.what, event.source, event.topic, event.peer,
          event.text, event.tick,   1,           event.by_us};
}

Command from_idl(const stillhand_msgs::SessionCommand& command,
                 const runtime::ParticipantId& sender) {
  return {action_of(command.action()), command.request(), command.asker().c_str(),
          command.text().c_str(), runtime::text_of(sender)};
}

ModelSeen from_idl(const stillhand_msgs::FeedthroughModel& model) {
  return {model.trial(), model.usable(), model.text().c_str()};
}

AnswerSeen from_idl(const stillhand_msgs::Answer& answer) {
  return {answer.prompt_number(), answer.value()};
}

stillhand_msgs::Prompt to_idl(const Prompt& prompt, std::uint64_t number, Tick now) {
  stillhand_msgs::Prompt message;
  message.number(number);
  message.kind(static_cast<stillhand_msgs::PromptKind>(prompt.kind));
  message.participant(prompt.participant);
  message.block(static_cast<std::int32_t>(prompt.block));
  message.blocks(static_cast<std::int32_t>(prompt.blocks));
  message.trial(static_cast<std::int32_t>(prompt.trial));
  message.trials(static_cast<std::int32_t>(prompt.trials));
  message.end_tick(prompt.wait_s && now >= 0 ? now + ticks_in(*prompt.wait_s) : -1);
  message.text(prompt.text);
  message.lowest(prompt.lowest);
  message.highest(prompt.highest);
  message.steps(static_cast<std::int32_t>(prompt.steps));
  return message;
}

stillhand_msgs::SessionState to_idl(SessionState state) {
  switch (state) {
    case SessionState::kRunning:
      return stillhand_msgs::SESSION_RUNNING;
    case SessionState::kPaused:
      return stillhand_msgs::SESSION_PAUSED;
    case SessionState::kEnding:
      return stillhand_msgs::SESSION_ENDING;
  }
  return stillhand_msgs::SESSION_ENDING;
}

stillhand_msgs::TrialControl to_idl(const Announcement& announcement,
                                    std::uint64_t reference_seed) {
  stillhand_msgs::TrialControl message;
  message.session(to_idl(announcement.session));
  message.trial(-1);
  message.phase(stillhand_msgs::PHASE_IDLE);
  if (announcement.trial) {
    const Trial& trial = *announcement.trial;
    message.trial(static_cast<std::int32_t>(trial.number));
    message.phase(trial.phase == TrialPhase::kPegged ? stillhand_msgs::PHASE_PEGGED
                  : trial.phase == TrialPhase::kFree ? stillhand_msgs::PHASE_FREE
                                                     : stillhand_msgs::PHASE_TRACKING);
    message.start_tick(trial.start_tick);
    message.duration_ticks(trial.duration_ticks);
    message.ramp_ticks(trial.ramp_ticks);
    message.reference_seed(reference_seed);
  }
  return message;
}

stillhand_msgs::TrialAssignment assignment_of(const session::PlannedTrial& planned) {
  stillhand_msgs::TrialAssignment message;
  message.trial(static_cast<std::int32_t>(planned.trial.number));
  // A motion is one number on the bus and in the core.
  message.motion(planned.moving ? static_cast<stillhand_msgs::MotionKind>(planned.motion)
                                : stillhand_msgs::MOTION_STILL);
  message.band_low_hz(planned.band_low_hz);
  message.band_high_hz(planned.band_high_hz);
  message.band_order(planned.band_order);
  message.rms_m_s2(planned.rms_m_s2);
  message.peak_m_s2(planned.peak_m_s2);
  message.motion_seed(planned.motion_seed);
  message.cancellation(planned.cancellation);
  for (const cancellation::Part& part : planned.parts) {
    stillhand_msgs::MitigationPart& to = message.parts().emplace_back();
    // A kind is one number on the bus and in the core.
    to.kind(static_cast<stillhand_msgs::MitigationPartKind>(part.kind));
    to.values(part.values);
  }
  if (!planned.parts.empty()) message.mitigation(session::name_of(planned.label));
  return message;
}

}  // namespace stillhand::lab
