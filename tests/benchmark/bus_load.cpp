// SPDX-License-Identifier: Apache-2.0
// bus_load DOMAIN RATE SECONDS [PATTERN]: messages of one 1 kHz type on ten topics "load/0" to
// "load/9", RATE a second in all, evenly, then prints how many were sent and how big they are.
// bus_load --write FILE RATE SECONDS: the same messages as a recording instead, for a replay.
// Used by record_rate.py and by tests of record and replay.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <string>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/idl_text.hpp"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/recording/qos_texts.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/real_time.hpp"
#include "tests/support/wait.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file
using Message = stillhand_msgs::RigTruth;

constexpr std::size_t kTopics = 10;
constexpr std::int64_t kSlot_ns = 200'000;  // what is due in a slot is sent at its beginning
constexpr const char* kType = "stillhand_msgs::RigTruth";

std::size_t message_bytes() { return to_cdr(Message{}).size(); }

int write_file(const std::string& path, std::int64_t rate, std::int64_t seconds) {
  recording::FileSink file(path);
  recording::McapWriter writer(file);
  const auto schema = writer.add_schema(kType, recording::kSchemaEncoding, topics::idl_of(kType));
  std::array<recording::ChannelId, kTopics> channels{};
  for (std::size_t i = 0; i < kTopics; ++i) {
    runtime::WriterQos qos;
    qos.depth = 16;
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

int publish(std::uint32_t domain, std::int64_t rate, std::int64_t seconds,
            const std::string& pattern) {
  static std::array<std::string, kTopics> names;
  std::vector<topics::Topic> rows;
  for (std::size_t i = 0; i < kTopics; ++i) {
    names[i] = "load/" + std::to_string(i);
    rows.push_back({names[i],
                    kType,
                    pattern == "event" ? topics::Pattern::kEvent : topics::Pattern::kStream1khz,
                    0.0,
                    {},
                    {}});
  }
  runtime::Bus::Options options;
  options.service = "load";
  options.domain = domain;
  options.profiles = STILLHAND_SOURCE "/qos/profiles.xml";
  runtime::become_real_time();  // as the recorder: where both want a core, neither starves
  runtime::Bus bus(options);
  std::vector<runtime::Publisher<Message>> publishers;
  for (const topics::Topic& row : rows) publishers.push_back(bus.publisher<Message>(row));
  bus.start();
  const auto matched = [](const runtime::EndpointReport& report) { return report.matched > 0; };
  if (!support::eventually([&] { return std::ranges::all_of(bus.report(), matched); })) {
    throw std::runtime_error("no reader of every topic within 20 s");
  }
  Message message;
  const std::int64_t begin_ns = runtime::monotonic_ns();
  std::int64_t worst_ns = 0;
  for (std::int64_t n = 0; n < rate * seconds;) {
    const std::int64_t slot_ns =
        begin_ns + (n * runtime::kNsPerSecond / rate) / kSlot_ns * kSlot_ns;
    runtime::sleep_until_ns(slot_ns);
    worst_ns = std::max(worst_ns, runtime::monotonic_ns() - slot_ns);
    for (; n < rate * seconds && n * runtime::kNsPerSecond / rate < slot_ns + kSlot_ns - begin_ns;
         ++n) {
      message.tick(n / static_cast<std::int64_t>(kTopics));
      publishers[static_cast<std::size_t>(n) % kTopics].write(message);
    }
  }
  const double took_s =
      static_cast<double>(runtime::monotonic_ns() - begin_ns) / static_cast<double>(1e9);
  std::cout << "sent " << rate * seconds << " messages of " << message_bytes() << " bytes in "
            << took_s << " s, " << static_cast<double>(rate * seconds) / took_s
            << " a second, worst slot late by " << worst_ns / 1000 << " us" << std::endl;
  // The writers stay until the asking program has seen everything arrive.
  std::cin.get();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() == 4 && words[0] == "--write") {
      return write_file(words[1], std::stoll(words[2]), std::stoll(words[3]));
    }
    if (words.size() < 3) {
      std::cerr << "bus_load: want DOMAIN RATE SECONDS [PATTERN], or --write FILE RATE SECONDS\n";
      return 2;
    }
    return publish(static_cast<std::uint32_t>(std::stoul(words[0])), std::stoll(words[1]),
                   std::stoll(words[2]), words.size() > 3 ? words[3] : "");
  } catch (const std::exception& error) {
    std::cerr << "bus_load: " << error.what() << '\n';
    return 1;
  }
}
