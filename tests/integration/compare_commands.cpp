// SPDX-License-Identifier: Apache-2.0
// compare_commands LIVE.mcap REPLAYED.mcap: the motor commands of a session, and what the
// cancellation answered when that session was replayed to it, tick by tick, every byte but the
// writer's stamp.  Prints one JSON object.  Used by replay_test.py.
#include <cstring>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "services/core/contract/flag.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/core/recording/mcap/sample_clock.hpp"
#include "services/files/recording/file_io.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file
using Bytes = std::vector<std::byte>;

std::map<Tick, Bytes> commands_of(const char* path) {
  recording::FileSource file(path);
  recording::McapReader reader(file);
  std::map<Tick, Bytes> commands;
  const auto status = reader.for_each_message(
      {{"stillhand/motor_command"}, 0, UINT64_MAX}, [&](const recording::MessageView& message) {
        commands[recording::sample_head(message.bytes).tick] = {message.bytes.begin(),
                                                                message.bytes.end()};
        return true;
      });
  if (!status.ok() || !reader.damage().empty()) throw std::runtime_error("damaged");
  return commands;
}

void clear_stamp(Bytes& bytes) {
  constexpr std::size_t kStampAt = 20;  // recording/sample_clock.hpp
  if (bytes.size() >= kStampAt + 8) std::memset(bytes.data() + kStampAt, 0, 8);
}

bool has_gap(const Bytes& bytes) {
  stillhand_msgs::MotorCommand command;
  return from_cdr(bytes, command) && (command.flags() & kInputGap) != 0;
}

std::int32_t model_of(const Bytes& bytes) {
  stillhand_msgs::MotorCommand command;
  return from_cdr(bytes, command) ? command.model() : -1;
}

double force_of(const Bytes& bytes) {
  stillhand_msgs::MotorCommand command;
  return from_cdr(bytes, command) ? command.force_n() : 0.0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "compare_commands: want LIVE.mcap REPLAYED.mcap\n";
    return 2;
  }
  try {
    std::map<Tick, Bytes> live = commands_of(argv[1]);
    std::map<Tick, Bytes> replayed = commands_of(argv[2]);
    long compared = 0;
    long different = 0;
    long missing = 0;
    double greatest_force_n = 0;
    Tick first_difference = -1;
    // Of either: behind these the two saw different inputs.
    Tick first_gap = -1;
    Tick first_other_model = -1;
    for (auto& [tick, bytes] : live) {
      const auto other = replayed.find(tick);
      if (other == replayed.end()) {
        ++missing;
        continue;
      }
      if (first_gap < 0 && (has_gap(bytes) || has_gap(other->second))) first_gap = tick;
      if (first_other_model < 0 && model_of(bytes) != model_of(other->second)) {
        first_other_model = tick;
      }
      greatest_force_n = std::max(greatest_force_n, std::abs(force_of(bytes)));
      clear_stamp(bytes);
      clear_stamp(other->second);
      ++compared;
      if (bytes != other->second) {
        if (different++ == 0) first_difference = tick;
      }
    }
    std::cout << nlohmann::json{{"live", live.size()},
                                {"replayed", replayed.size()},
                                {"compared", compared},
                                {"missing", missing},
                                {"different", different},
                                {"first_difference_tick", first_difference},
                                {"first_gap_tick", first_gap},
                                {"first_other_model_tick", first_other_model},
                                {"greatest_force_n", greatest_force_n}}
              << '\n';
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "compare_commands: " << error.what() << '\n';
    return 1;
  }
}
