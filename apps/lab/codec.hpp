// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "apps/lab/core/seen.hpp"
#include "apps/lab/core/stage.hpp"
#include "apps/libraries/session/marks.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "idl/model.h"
#include "idl/session.h"
#include "services/bus/source.hpp"

/// The conductor's core to bus messages and back.  Pure.
namespace stillhand::lab {

ProcessSeen from_idl(const stillhand_msgs::ServiceStatus& status);
EventSeen from_idl(const stillhand_msgs::Event& event);
Command from_idl(const stillhand_msgs::SessionCommand& command,
                 const runtime::ParticipantId& sender);
ModelSeen from_idl(const stillhand_msgs::FeedthroughModel& model);
AnswerSeen from_idl(const stillhand_msgs::Answer& answer);
/// @param now  newest tick, from which the prompt's wait counts; -1: none yet
stillhand_msgs::Prompt to_idl(const Prompt& prompt, std::uint64_t number, Tick now);
session::Mark mark_of(const EventSeen& event);

stillhand_msgs::SessionState to_idl(SessionState state);
/// @param reference_seed  of the target of the trial that runs
stillhand_msgs::TrialControl to_idl(const Announcement& announcement, std::uint64_t reference_seed);
/// The part of a planned trial that is blinded.
stillhand_msgs::TrialAssignment assignment_of(const session::PlannedTrial& planned);

}  // namespace stillhand::lab
