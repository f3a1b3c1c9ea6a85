// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/ros2_bag.hpp"

#include "apps/libraries/ros2/converter.hpp"
#include "apps/recordings/pending_file.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "version.hpp"

namespace stillhand::recordings {
namespace {

class Bag {
 public:
  Bag(OpenRecording& recording, recording::ByteSink& sink)
      : recording_(recording), writer_(sink, options()) {}

  Ros2Bag write() {
    std::uint64_t messages = 0;
    check(recording_.reader.for_each_message({}, [&](const recording::MessageView& message) {
      ++messages;
      if (message.channel.metadata.contains("replayed")) return true;
      const auto found = ros2::converted(message.channel.topic, message.bytes, message.log_time_ns);
      if (!found) ++bag_.unread;
      for (const ros2::Message& each : found.value_or(std::vector<ros2::Message>{})) {
        put(each, message);
      }
      return writer_.status().ok();
    }));
    if (bag_.topics.empty()) {
      throw ConfigError(recording_.path, "no topic that a bag of ROS 2 would hold",
                        "the recording of a session, with stillhand/sensed");
    }
    check(writer_.close());
    recording_.report_loss(messages);
    return bag_;
  }

 private:
  static recording::McapWriterOptions options() {
    recording::McapWriterOptions options;
    options.library = std::string("stillhand ") + kVersion;
    options.profile = "ros2";
    options.first_channel = 1;  // the Python package rosbags passes over a channel 0
    return options;
  }

  void put(const ros2::Message& message, const recording::MessageView& source) {
    auto channel = channels_.find(message.topic);
    if (channel == channels_.end()) {
      const ros2::Definition& type = *message.type;
      auto schema = schemas_.find(type.name);
      if (schema == schemas_.end()) {
        schema =
            schemas_.emplace(type.name, writer_.add_schema(type.name, "ros2msg", type.text)).first;
      }
      const auto id =
          writer_.add_channel(message.topic, schema->second, "cdr", {{"offered_qos_profiles", ""}});
      channel = channels_.emplace(message.topic, id).first;
    }
    check(writer_.write(channel->second, static_cast<std::uint32_t>(++bag_.topics[message.topic]),
                        source.log_time_ns, source.publish_time_ns, message.cdr));
  }

  OpenRecording& recording_;
  recording::McapWriter writer_;
  std::map<std::string, recording::SchemaId> schemas_;
  std::map<std::string, recording::ChannelId> channels_;
  Ros2Bag bag_;
};

}  // namespace

Ros2Bag write_ros2_bag(const std::string& recording, const std::filesystem::path& out,
                       const Stopped& stopped) {
  OpenRecording source(recording, stopped);
  PendingFile pending(out.string());
  recording::FileSink sink(pending.path());
  const Ros2Bag bag = Bag(source, sink).write();
  go_on_unless(stopped);
  pending.publish();
  return bag;
}

}  // namespace stillhand::recordings
