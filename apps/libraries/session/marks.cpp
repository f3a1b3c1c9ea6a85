// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/marks.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace stillhand::session {
namespace {

const char* name_of(stillhand_msgs::EventKind kind) {
  switch (kind) {
    case stillhand_msgs::EVENT_DEADLINE_MISSED:
      return "deadline missed";
    case stillhand_msgs::EVENT_CYCLE_MISSED:
      return "cycle missed";
    case stillhand_msgs::EVENT_TICKS_LOST:
      return "ticks lost";
    case stillhand_msgs::EVENT_LIVELINESS_LOST:
      return "liveliness lost";
    case stillhand_msgs::EVENT_LIVELINESS_RECOVERED:
      return "liveliness recovered";
    case stillhand_msgs::EVENT_INTERLOCK_OPENED:
      return "interlock opened";
    case stillhand_msgs::EVENT_FORCE_ZERO:
      return "motor force zero after interlock opened";
    case stillhand_msgs::EVENT_MODEL_REFUSED:
      return "model refused";
    case stillhand_msgs::EVENT_MODEL_LOADED:
      return "model loaded";
    case stillhand_msgs::EVENT_INCOMPATIBLE_QOS:
      return "incompatible QoS";
    case stillhand_msgs::EVENT_CLOCK_STEPPED:
      return "clock stepped";
    case stillhand_msgs::EVENT_CLOCK_DRIFTS:
      return "clock drifts";
    case stillhand_msgs::EVENT_COMMAND:
      return "asked from outside";
    case stillhand_msgs::EVENT_SECOND_WRITER:
      return "second writer";
    case stillhand_msgs::EVENT_NOTE:
      return "note";
  }
  return "event";
}

bool same(const Mark& a, const Mark& b) {
  return a.what == b.what && a.source == b.source && a.topic == b.topic && a.peer == b.peer;
}

}  // namespace

std::string line_of(const Mark& mark) {
  std::string line = fmt::format("{}: {}", mark.source, mark.what);
  if (!mark.topic.empty()) line += fmt::format(" on {}", mark.topic);
  if (!mark.peer.empty()) line += fmt::format(" of {}", mark.peer);
  if (!mark.text.empty()) line += fmt::format(" ({})", mark.text);
  return line;
}

Mark mark_of(const stillhand_msgs::Event& event) {
  return {event.code() == stillhand_msgs::CODE_STALL ? "stood still" : name_of(event.kind()),
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
