// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "idl/processes.hpp"

namespace stillhand::topics {

/// Communication pattern of a topic; selects its QoS profile in qos/profiles.xml (profile_of()).
enum class Pattern {
  kStream1khz,    ///< "stream_1khz": newest sample counts
  kStreamSlow,    ///< "stream_slow": 10 to 60 Hz, newest sample counts, liveliness
  kStateLatched,  ///< "state_latched": reliable, a late joiner gets the last sample
  kEvent,         ///< "event": reliable, every sample counts
  kExchange,      ///< "exchange": best effort, a late sample has no use
  kCommand,       ///< "command": reliable, a late joiner gets no earlier request
};

constexpr std::string_view profile_of(Pattern pattern) {
  switch (pattern) {
    case Pattern::kStream1khz:
      return "stream_1khz";
    case Pattern::kStreamSlow:
      return "stream_slow";
    case Pattern::kStateLatched:
      return "state_latched";
    case Pattern::kEvent:
      return "event";
    case Pattern::kExchange:
      return "exchange";
    case Pattern::kCommand:
      return "command";
  }
  return "";
}

/// Identity of a listener on a secured bus that is outside of a session (deploy/security).
inline constexpr std::string_view kTap = "tap";

/// The client that may send requests to a session from outside; no process waits for it.
inline constexpr std::string_view kDashboard = "dashboard";

/// Start of the recorder's note with its file name, if the process ends with the session.
inline constexpr std::string_view kRecordingNote = "records ";

/// One row of the catalogue.
struct Topic {
  std::string_view name;  ///< DDS topic name
  std::string_view type;  ///< DDS type name
  Pattern pattern;
  double rate_hz;  ///< [Hz] nominal, 0: irregular
  std::span<const std::string_view> writers;
  std::span<const std::string_view> readers;
  /// The reader to which DDS reports a missed deadline of this topic, and the end of its writer.
  /// The commands to motor and platform have one; empty: none.
  std::string_view supervisor = {};
};

/// Offers DEADLINE and LIVELINESS.  Each sample restarts two timers of Fast DDS at each end, and
/// wakes a thread for them (qos/README.md, "Deadline").
inline constexpr std::string_view kControlLoop = "control_loop";

/// QoS profile of a topic's writer.
constexpr std::string_view profile_of(const Topic& topic) {
  return topic.supervisor.empty() ? profile_of(topic.pattern) : kControlLoop;
}

/// QoS profile of a reader.
constexpr std::string_view profile_of(const Topic& topic, std::string_view reader) {
  return topic.supervisor.empty() || topic.supervisor != reader ? profile_of(topic.pattern)
                                                                : kControlLoop;
}

namespace who {
inline constexpr std::string_view kMotion[]{"motion"};
inline constexpr std::string_view kRig[]{"rig"};
inline constexpr std::string_view kSensing[]{"sensing"};
inline constexpr std::string_view kCancellation[]{"cancellation"};
inline constexpr std::string_view kDisplay[]{"display"};
inline constexpr std::string_view kOperator[]{"human_operator"};
inline constexpr std::string_view kIdentification[]{"identification"};
inline constexpr std::string_view kExperiment[]{"experiment"};
inline constexpr std::string_view kRecorder[]{"recorder"};
inline constexpr std::string_view kSensedReaders[]{"motion",         "cancellation",   "display",
                                                   "human_operator", "identification", "recorder"};
inline constexpr std::string_view kRigAndRecorder[]{"rig", "recorder"};
inline constexpr std::string_view kMotorCommandReaders[]{"rig", "display", "identification",
                                                         "recorder"};
inline constexpr std::string_view kSensingAndRecorder[]{"sensing", "recorder"};
inline constexpr std::string_view kOperatorAndRecorder[]{"human_operator", "recorder"};
inline constexpr std::string_view kAssignmentReaders[]{"motion", "cancellation", "recorder"};
inline constexpr std::string_view kModelReaders[]{"cancellation", "experiment", "recorder"};
inline constexpr std::string_view kAugmentedModelReaders[]{"cancellation", "recorder"};
// A person at the page, at the tracking screen, or with a stop key on the experiment's machine.
inline constexpr std::string_view kCommandWriters[]{kDashboard, "display", "experiment"};
inline constexpr std::string_view kCommandReaders[]{"rig", "experiment", "recorder"};
inline constexpr std::string_view kEventReaders[]{"experiment", "recorder"};
inline constexpr std::string_view kPromptReaders[]{"display", "recorder"};
inline constexpr std::string_view kStatusReaders[]{"rig", "cancellation", "display", "recorder",
                                                   "experiment"};
}  // namespace who

inline constexpr Topic kPlatformCommand{"stillhand/platform_command",
                                        "stillhand_msgs::PlatformCommand",
                                        Pattern::kStream1khz,
                                        1000.0,
                                        who::kMotion,
                                        who::kRigAndRecorder,
                                        "rig"};
inline constexpr Topic kRawSample{
    "stillhand/raw_sample",  "stillhand_msgs::RawSample", Pattern::kStream1khz, 1000.0, who::kRig,
    who::kSensingAndRecorder};
inline constexpr Topic kRigTruth{
    "stillhand/rig_truth", "stillhand_msgs::RigTruth", Pattern::kStream1khz, 1000.0, who::kRig,
    who::kRecorder};
inline constexpr Topic kSensed{"stillhand/sensed",   "stillhand_msgs::Sensed",
                               Pattern::kStream1khz, 1000.0,
                               who::kSensing,        who::kSensedReaders};
inline constexpr Topic kMotorCommand{"stillhand/motor_command",
                                     "stillhand_msgs::MotorCommand",
                                     Pattern::kStream1khz,
                                     1000.0,
                                     who::kCancellation,
                                     who::kMotorCommandReaders,
                                     "rig"};
inline constexpr Topic kTrackingSample{"stillhand/tracking_sample",
                                       "stillhand_msgs::TrackingSample",
                                       Pattern::kStream1khz,
                                       1000.0,
                                       who::kDisplay,
                                       who::kOperatorAndRecorder};
inline constexpr Topic kOperatorForce{"stillhand/operator_force",
                                      "stillhand_msgs::OperatorForce",
                                      Pattern::kStream1khz,
                                      1000.0,
                                      who::kOperator,
                                      who::kRigAndRecorder};
inline constexpr Topic kPointer{"stillhand/pointer",  "stillhand_msgs::Pointer",
                                Pattern::kStreamSlow, 60.0,
                                who::kDisplay,        who::kOperatorAndRecorder};
inline constexpr Topic kTrialControl{"stillhand/trial_control", "stillhand_msgs::TrialControl",
                                     Pattern::kStateLatched,    0.0,
                                     who::kExperiment,          kLaunched};
inline constexpr Topic kTrialAssignment{"stillhand/trial_assignment",
                                        "stillhand_msgs::TrialAssignment",
                                        Pattern::kStateLatched,
                                        0.0,
                                        who::kExperiment,
                                        who::kAssignmentReaders};
inline constexpr Topic kSessionSources{"stillhand/session_sources",
                                       "stillhand_msgs::SessionSources",
                                       Pattern::kStateLatched,
                                       0.0,
                                       who::kExperiment,
                                       kLaunched};
inline constexpr Topic kFeedthroughModel{
    "stillhand/feedthrough_model", "stillhand_msgs::FeedthroughModel",
    Pattern::kStateLatched,        0.0,
    who::kIdentification,          who::kModelReaders};
// The control model; the topic keeps its first name, by which recordings refer to it.
inline constexpr Topic kAugmentedModel{"stillhand/augmented_model",
                                       "stillhand_msgs::AugmentedModel",
                                       Pattern::kStateLatched,
                                       0.0,
                                       who::kExperiment,
                                       who::kAugmentedModelReaders};
inline constexpr Topic kEvent{"stillhand/event", "stillhand_msgs::Event", Pattern::kEvent, 0.0,
                              kServices,         who::kEventReaders};
inline constexpr Topic kServiceStatus{"stillhand/service_status",
                                      "stillhand_msgs::ServiceStatus",
                                      Pattern::kStreamSlow,
                                      10.0,
                                      kServices,
                                      who::kStatusReaders};

inline constexpr Topic kClockQuestion{"stillhand/clock_question", "stillhand_msgs::ClockQuestion",
                                      Pattern::kExchange,         4.0,
                                      who::kExperiment,           kLaunched};
inline constexpr Topic kClockAnswer{
    "stillhand/clock_answer", "stillhand_msgs::ClockAnswer", Pattern::kExchange, 4.0, kLaunched,
    who::kEventReaders};
inline constexpr Topic kClockOffset{"stillhand/clock_offset", "stillhand_msgs::ClockOffset",
                                    Pattern::kExchange,       1.0,
                                    who::kExperiment,         kLaunched};

inline constexpr Topic kHostStatus{
    "stillhand/host_status", "stillhand_msgs::HostStatus", Pattern::kExchange, 1.0, kServices,
    who::kRecorder};
inline constexpr Topic kSessionCommand{
    "stillhand/session_command", "stillhand_msgs::SessionCommand",
    Pattern::kCommand,           0.0,
    who::kCommandWriters,        who::kCommandReaders};

inline constexpr Topic kPrompt{"stillhand/prompt",     "stillhand_msgs::Prompt",
                               Pattern::kStateLatched, 0.0,
                               who::kExperiment,       who::kPromptReaders};
inline constexpr Topic kAnswer{"stillhand/answer", "stillhand_msgs::Answer", Pattern::kEvent, 0.0,
                               who::kDisplay,      who::kEventReaders};

/// The whole catalogue; idl/README.md holds the same rows (tests/interface compares them).
inline constexpr std::array<const Topic*, 22> kCatalogue{
    &kPlatformCommand,  &kRawSample,      &kRigTruth,   &kSensed,         &kMotorCommand,
    &kTrackingSample,   &kOperatorForce,  &kPointer,    &kTrialControl,   &kTrialAssignment,
    &kFeedthroughModel, &kAugmentedModel, &kEvent,      &kServiceStatus,  &kClockQuestion,
    &kClockAnswer,      &kClockOffset,    &kHostStatus, &kSessionCommand, &kSessionSources,
    &kPrompt,           &kAnswer};

/// Remote control of `stillhand record` and `stillhand replay`, outside of every session; no
/// process waits for these topics.
inline constexpr Topic kRecorderCommand{"stillhand/recorder_command",
                                        "stillhand_msgs::RecorderCommand",
                                        Pattern::kCommand,
                                        0.0,
                                        {},
                                        {}};
inline constexpr Topic kRecorderStatus{"stillhand/recorder_status",
                                       "stillhand_msgs::RecorderStatus",
                                       Pattern::kStreamSlow,
                                       10.0,
                                       {},
                                       {}};
inline constexpr Topic kReplayCommand{
    "stillhand/replay_command", "stillhand_msgs::ReplayCommand", Pattern::kEvent, 0.0, {}, {}};
inline constexpr Topic kReplayStatus{
    "stillhand/replay_status", "stillhand_msgs::ReplayStatus", Pattern::kStreamSlow, 10.0, {}, {}};

/// The second table of idl/README.md.
inline constexpr std::array<const Topic*, 4> kRemoteControl{&kRecorderCommand, &kRecorderStatus,
                                                            &kReplayCommand, &kReplayStatus};

/// Row of either table by topic name, or nullptr.
constexpr const Topic* find(std::string_view name) {
  for (const Topic* topic : kRemoteControl) {
    if (topic->name == name) return topic;
  }
  for (const Topic* topic : kCatalogue) {
    if (topic->name == name) return topic;
  }
  return nullptr;
}

}  // namespace stillhand::topics
