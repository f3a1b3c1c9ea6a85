// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/libraries/session/session_recording.hpp"
#include "services/core/recording/recording.hpp"

namespace stillhand::session {

/// What came late in each step of the rig, as channels, README "Channels of lateness": a table for
/// an export, and candidates of a diagnosis.  Of one rig; time is that of the sample clock.
recording::Recording lateness_channels(const SessionRecording& session);

}  // namespace stillhand::session
