// SPDX-License-Identifier: Apache-2.0
// write_load FILE RATE SECONDS: a recording of ten topics "load/0" to "load/9" of one 1 kHz type,
// RATE messages a second in all, evenly, for tests of replay and export.
#include <array>
#include <iostream>
#include <stdexcept>
#include <string>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/idl_text.hpp"
#include "services/bus/recording/qos_texts.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/clock.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file
using Message = stillhand_msgs::RigTruth;

constexpr std::size_t kTopics = 10;
constexpr const char* kType = "stillhand_msgs::RigTruth";

int write_file(const std::string& path, std::int64_t rate, std::int64_t seconds) {
  recording::FileSink file(path);
  recording::McapWriter writer(file);
  const auto schema = writer.add_schema(kType, recording::kSchemaEncoding, topics::idl_of(kType));
  std::array<recording::ChannelId, kTopics> channels{};
  for (std::size_t i = 0; i < kTopics; ++i) {
    const runtime::WriterQos qos{.depth = 16};
    channels[i] = writer.add_channel("load/" + std::to_string(i), schema,
                                     recording::kMessageEncoding, recording::qos_texts(qos));
  }
  Message message;
  message.rig(1);
  for (std::int64_t n = 0; n < rate * seconds; ++n) {
    message.tick(n / static_cast<std::int64_t>(kTopics));
    const auto at_ns = static_cast<std::uint64_t>(n * runtime::kNsPerSecond / rate);
    const recording::Status status =
        writer.write(channels[static_cast<std::size_t>(n) % kTopics], static_cast<std::uint32_t>(n),
                     at_ns, at_ns, to_cdr(message));
    if (!status.ok()) throw std::runtime_error(status.text);
  }
  if (const auto status = writer.close(); !status.ok()) throw std::runtime_error(status.text);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 4) {
      std::cerr << "write_load: want FILE RATE SECONDS\n";
      return 2;
    }
    return write_file(argv[1], std::stoll(argv[2]), std::stoll(argv[3]));
  } catch (const std::exception& error) {
    std::cerr << "write_load: " << error.what() << '\n';
    return 1;
  }
}
