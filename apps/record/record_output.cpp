// SPDX-License-Identifier: Apache-2.0
#include "apps/record/record_output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <map>

#include "apps/libraries/report/command_line.hpp"
#include "idl/topics.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::record {
namespace {

constexpr double kBytesPerMib = 1048576.0;

struct Totals {
  std::uint64_t received = 0, lost = 0;
};

Totals print_topics(const std::map<std::string, recording::TopicTally>& topics) {
  Totals totals;
  fmt::print("{:<32} {:>12} {:>10} {:>10} {:>12}\n", "topic", "received", "lost", "(not sent)",
             "written");
  for (const auto& [topic, tally] : topics) {
    fmt::print("{:<32} {:>12} {:>10} {:>10} {:>12}{}\n", topic, tally.received, tally.lost,
               tally.not_sent, tally.written,
               tally.type_known ? ""
               : topics::find(topic) != nullptr
                   ? "  another type than the catalogue's: not recorded"
                   : "  type not known: recorded as bytes");
    totals.received += tally.received;
    totals.lost += tally.lost;
  }
  return totals;
}

}  // namespace

void warn(const std::string& line) {
  const bool red = isatty(STDERR_FILENO) == 1;
  fmt::print(stderr, "{}{}{}\n", red ? "\033[31m" : "", line, red ? "\033[0m" : "");
}

void RequiredTopics::step(const std::set<std::string>& heard, std::int64_t trial) {
  missing_.clear();
  for (const std::string& topic : required_) {
    if (!heard.contains(topic)) missing_ += (missing_.empty() ? "" : ", ") + topic;
  }
  const bool announced = trial >= 0 && trial != trial_;
  if (!missing_.empty() && (announced || missing_ != printed_)) {
    warn(announced ? fmt::format("trial {} begins without {}", trial, missing_)
                   : "no message yet on required topics: " + missing_);
  }
  if (missing_.empty() && !printed_.empty()) {
    fmt::print(stderr, "messages arrive on every required topic\n");
  }
  printed_ = missing_;
  trial_ = trial;
}

void print_progress(const recording::TapeStatus& tape, std::uint64_t lost,
                    std::int64_t elapsed_ns) {
  if (isatty(STDERR_FILENO) != 1) return;
  fmt::print(stderr, "\r\033[K{} s  {} messages  {:.1f} MiB  {} lost{}",
             elapsed_ns / runtime::kNsPerSecond, tape.written,
             static_cast<double>(tape.bytes) / kBytesPerMib, lost, tape.paused ? "  paused" : "");
}

bool print_end(const recording::BusRecording& recorded, const runtime::Tap& tap,
               const recording::Status& closed, std::uint32_t domain) {
  if (isatty(STDERR_FILENO) == 1) fmt::print(stderr, "\r\033[K");
  const Totals totals = print_topics(recorded.tally().topics(tap.writers()));
  const recording::TapeStatus end = recorded.tape().status();
  fmt::print("{} messages in {} file{}, the last {}\n", end.written, end.parts,
             end.parts == 1 ? "" : "s", end.file);
  if (end.passed_over > 0) {
    fmt::print("{} messages passed over: paused, or outside the event window\n", end.passed_over);
  }
  std::fflush(stdout);
  const std::vector<std::string> trouble = tap.trouble();
  for (const std::string& line : trouble) warn(line);
  if (totals.lost > 0) warn(fmt::format("{} messages were lost on the bus", totals.lost));
  if (end.dropped > 0) {
    warn(fmt::format("{} messages were received but not written", end.dropped));
  }
  if (tap.unattributed() > 0) {
    warn(fmt::format("{} messages came from writers that discovery did not announce",
                     tap.unattributed()));
  }
  if (totals.received == 0) warn(fmt::format("no message was received on domain {}", domain));
  if (!closed.ok()) warn(closed.text);
  report::say_next("stillhand info " + report::quoted_for_shell(end.file));
  return closed.ok() && trouble.empty() && totals.lost == 0 && end.dropped == 0 &&
         tap.unattributed() == 0 && totals.received > 0;
}

}  // namespace stillhand::record
