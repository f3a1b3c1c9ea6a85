// SPDX-License-Identifier: Apache-2.0
// compare_messages A.mcap B.mcap: a recording and that of its replay, topic by topic: every byte of
// every message with its encapsulation, in the order of the file.  Prints one JSON object.
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file

struct Topic {
  std::vector<std::vector<std::byte>> messages;
  std::uint64_t newest_ns = 0;
  bool in_order = true;
};

std::map<std::string, Topic> topics_of(const char* path) {
  recording::FileSource file(path);
  recording::McapReader reader(file);
  std::map<std::string, Topic> topics;
  const auto status =
      reader.for_each_message({{}, 0, UINT64_MAX}, [&](const recording::MessageView& message) {
        Topic& topic = topics[message.channel.topic];
        topic.in_order = topic.in_order && message.log_time_ns >= topic.newest_ns;
        topic.newest_ns = message.log_time_ns;
        topic.messages.emplace_back(message.bytes.begin(), message.bytes.end());
        return true;
      });
  if (!status.ok() || !reader.damage().empty()) throw std::runtime_error("damaged");
  return topics;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto recorded = topics_of(argv[1]);
  auto replayed = topics_of(argv[2]);
  nlohmann::json result;
  for (const auto& [name, topic] : recorded) {
    const Topic& again = replayed[name];
    result[name] = {{"messages", topic.messages.size()},
                    {"equal", topic.messages == again.messages},
                    {"in_order", topic.in_order && again.in_order},
                    {"encapsulation", std::to_integer<int>(topic.messages.front().at(1))}};
  }
  std::cout << result.dump() << "\n";
  return 0;
}
