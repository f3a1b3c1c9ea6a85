// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/session_recording.hpp"

#include <fmt/format.h>

#include <functional>

#include "idl/cdr.hpp"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/parts_note.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/messages/recording/named_writers.hpp"

namespace stillhand::session {
namespace {

using Store = std::function<bool(std::span<const std::byte>)>;

template <typename Message>
Store into(std::vector<Message>& list) {
  return [&list](std::span<const std::byte> bytes) {
    Message message;
    if (!from_cdr(bytes, message)) return false;
    list.push_back(std::move(message));
    return true;
  };
}

// Checks the type and counts the message; nothing reads it.
template <typename Message>
Store counted() {
  return [](std::span<const std::byte> bytes) {
    Message message;
    return from_cdr(bytes, message);
  };
}

template <typename Message>
std::int64_t gaps_in(const std::vector<Message>& stream) {
  std::int64_t lost = 0;
  for (std::size_t i = 1; i < stream.size(); ++i) {
    lost += std::max<std::int64_t>(stream[i].tick() - stream[i - 1].tick() - 1, 0);
  }
  return lost;
}

}  // namespace

SessionRecording read_session(const std::string& path) {
  recording::FileSource file(path);
  recording::McapReader reader(file);
  if (!reader.status().ok()) {
    throw ConfigError(path, reader.status().text, "an MCAP recording of a session");
  }
  SessionRecording session;
  const std::map<std::string_view, Store> stores{
      {topics::kPlatformCommand.name, into(session.platform_commands)},
      {topics::kRawSample.name, into(session.raw_samples)},
      {topics::kRigTruth.name, into(session.rig_truths)},
      {topics::kSensed.name, into(session.sensed)},
      {topics::kMotorCommand.name, into(session.motor_commands)},
      {topics::kTrackingSample.name, into(session.tracking_samples)},
      {topics::kOperatorForce.name, into(session.operator_forces)},
      {topics::kPointer.name, into(session.pointers)},
      {topics::kTrialControl.name, into(session.trial_controls)},
      {topics::kTrialAssignment.name, into(session.trial_assignments)},
      {topics::kFeedthroughModel.name, into(session.models)},
      {topics::kAugmentedModel.name, into(session.control_models)},
      {topics::kEvent.name, into(session.events)},
      {topics::kServiceStatus.name, into(session.statuses)},
      {topics::kClockQuestion.name, counted<stillhand_msgs::ClockQuestion>()},
      {topics::kClockAnswer.name, counted<stillhand_msgs::ClockAnswer>()},
      {topics::kClockOffset.name, into(session.clock_offsets)},
      {topics::kHostStatus.name, counted<stillhand_msgs::HostStatus>()},
      {topics::kSessionCommand.name, counted<stillhand_msgs::SessionCommand>()},
      {topics::kSessionSources.name, counted<stillhand_msgs::SessionSources>()},
      {topics::kPrompt.name, counted<stillhand_msgs::Prompt>()},
      {topics::kAnswer.name, counted<stillhand_msgs::Answer>()}};
  const recording::Status status =
      recording::for_each_session_message(reader, {}, [&](const recording::MessageView& message) {
        const auto logged_ns = static_cast<std::int64_t>(message.log_time_ns);
        if (session.first_log_ns == 0) session.first_log_ns = logged_ns;
        session.first_log_ns = std::min(session.first_log_ns, logged_ns);
        const std::size_t samples = session.raw_samples.size();
        const auto store = stores.find(message.channel.topic);
        if (store == stores.end()) return true;
        if (store->second(message.bytes)) {
          ++session.messages[message.channel.topic];
          if (session.raw_samples.size() > samples) {
            const std::int64_t less_ns = logged_ns - session.raw_samples.back().stamp_ns();
            session.log_less_stamp_ns =
                samples == 0 ? less_ns : std::min(session.log_less_stamp_ns, less_ns);
          }
        } else {
          session.damage.push_back(
              fmt::format("a message of {} is not of its type", message.channel.topic));
        }
        return true;
      });
  if (!status.ok()) session.damage.push_back(status.text);
  for (const recording::Damage& damage : reader.damage()) session.damage.push_back(damage.text);
  const auto count = [&](const topics::Topic& topic, std::int64_t lost) {
    session.lost_ticks[std::string(topic.name)] = lost;
  };
  count(topics::kPlatformCommand, gaps_in(session.platform_commands));
  count(topics::kRawSample, gaps_in(session.raw_samples));
  count(topics::kRigTruth, gaps_in(session.rig_truths));
  count(topics::kSensed, gaps_in(session.sensed));
  count(topics::kMotorCommand, gaps_in(session.motor_commands));
  count(topics::kTrackingSample, gaps_in(session.tracking_samples));
  count(topics::kOperatorForce, gaps_in(session.operator_forces));
  return session;
}

std::string rig_parts_in(const SessionRecording& recording) {
  for (const auto& event : recording.events) {
    const std::string text = event.text().c_str();
    if (device_rig::is_parts_note(event.source().c_str(), text)) return text;
  }
  return {};
}

}  // namespace stillhand::session
