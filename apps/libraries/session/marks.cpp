// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/marks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace stillhand::session {
namespace {

constexpr const char* kModelChanged = "model no longer holds";

// In the order of idl/session.idl.
constexpr std::array kEvents{"deadline missed",
                             "cycle missed",
                             "ticks lost",
                             "liveliness lost",
                             "liveliness recovered",
                             "interlock opened",
                             "motor force zero after interlock opened",
                             "model refused",
                             "model loaded",
                             "incompatible QoS",
                             "note",
                             "clock stepped",
                             "clock drifts",
                             "asked from outside",
                             "second writer"};
static_assert(kEvents.size() == static_cast<std::size_t>(stillhand_msgs::EVENT_SECOND_WRITER) + 1);

const char* name_of(stillhand_msgs::EventKind kind) {
  const auto number = static_cast<std::size_t>(kind);
  return number < kEvents.size() ? kEvents[number] : "event";
}

bool same(const Mark& a, const Mark& b) {
  return a.what == b.what && a.what != kModelChanged && a.source == b.source &&
         a.topic == b.topic && a.peer == b.peer;
}

const char* what_of(const stillhand_msgs::Event& event) {
  switch (event.code()) {
    case stillhand_msgs::CODE_STALL:
      return "stood still";
    case stillhand_msgs::CODE_MODEL_CHANGED:
      return kModelChanged;
    default:
      return name_of(event.kind());
  }
}

double noticed_s(const Mark& mark, const Trial& trial) {
  return kControlPeriod_s * static_cast<double>(mark.first_tick - trial.start_tick);
}

}  // namespace

std::string line_of(const Mark& mark) {
  std::string line = fmt::format("{}: {}", mark.source, mark.what);
  if (!mark.topic.empty()) line += fmt::format(" on {}", mark.topic);
  if (!mark.peer.empty()) line += fmt::format(" of {}", mark.peer);
  if (!mark.text.empty()) line += fmt::format(" ({})", mark.text);
  return line;
}

std::optional<double> model_lost_s(const Mark& mark, const Trial& trial) {
  if (mark.what != kModelChanged) return std::nullopt;
  return noticed_s(mark, trial) - mark.worst_us / 1e6;
}

std::string model_change(const Mark& mark, const Trial& trial) {
  const std::optional<double> since_s = model_lost_s(mark, trial);
  if (!since_s) return {};
  const std::string when = *since_s >= 0.0
                               ? fmt::format("since {:.0f} s of trial {}", *since_s, trial.number)
                               : fmt::format("since before trial {}", trial.number);
  return fmt::format("the model no longer holds {}, {}; noticed at {:.0f} s", when, mark.text,
                     noticed_s(mark, trial));
}

Mark mark_of(const stillhand_msgs::Event& event) {
  return {what_of(event),
          event.source().c_str(),
          event.topic().c_str(),
          event.peer().c_str(),
          event.text().c_str(),
          event.tick(),
          1,
          event.by_us()};
}

void add_mark(std::vector<Mark>& marks, const Mark& mark) {
  const auto known =
      std::ranges::find_if(marks, [&](const Mark& other) { return same(mark, other); });
  if (known == marks.end()) {
    marks.push_back(mark);
    return;
  }
  ++known->count;
  known->worst_us = std::max(known->worst_us, mark.worst_us);
}

}  // namespace stillhand::session
