// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/feed/words.hpp"

#include <array>

#include "idl/topics.hpp"

namespace stillhand::dashboard {

namespace {

struct WatchText {
  const char* name;
  const char* unit;
};

constexpr std::array<WatchText, kWatches> kWatchTexts{{{"late", "ms"},
                                                       {"lost", "ticks"},
                                                       {"silent", "ms"},
                                                       {"latency", "ms"},
                                                       {"chain", "ms"},
                                                       {"missing", "ms"}}};

}  // namespace

const char* word(Level level) {
  constexpr std::array kWords{"healthy", "warning", "critical"};
  return kWords[static_cast<std::size_t>(level)];
}

const char* word(Watch watch) { return kWatchTexts[static_cast<std::size_t>(watch)].name; }
const char* unit(Watch watch) { return kWatchTexts[static_cast<std::size_t>(watch)].unit; }

// The kind comes from the bus: it can be any number.
const char* word(stillhand_msgs::EventKind kind) {
  constexpr std::array kKinds{
      "deadline missed",      "cycle missed",     "ticks lost",   "liveliness lost",
      "liveliness recovered", "interlock opened", "force zero",   "model refused",
      "model loaded",         "incompatible QoS", "note",         "clock stepped",
      "clock drifts",         "command",          "second writer"};
  const auto number = static_cast<std::size_t>(kind);
  return number < kKinds.size() ? kKinds[number] : "unknown";
}

Level level_of(stillhand_msgs::EventKind kind) {
  switch (kind) {
    case stillhand_msgs::EVENT_LIVELINESS_LOST:
    case stillhand_msgs::EVENT_INTERLOCK_OPENED:
    case stillhand_msgs::EVENT_INCOMPATIBLE_QOS:
    case stillhand_msgs::EVENT_SECOND_WRITER:
      return Level::kCritical;
    case stillhand_msgs::EVENT_DEADLINE_MISSED:
    case stillhand_msgs::EVENT_CYCLE_MISSED:
    case stillhand_msgs::EVENT_TICKS_LOST:
    case stillhand_msgs::EVENT_MODEL_REFUSED:
    case stillhand_msgs::EVENT_CLOCK_STEPPED:
    case stillhand_msgs::EVENT_CLOCK_DRIFTS:
      return Level::kWarning;
    default:
      return Level::kHealthy;
  }
}

std::string_view writer_of(const std::string& topic) {
  const topics::Topic* row = topics::find(topic);
  return row != nullptr && row->writers.size() == 1 ? row->writers.front() : "";
}

}  // namespace stillhand::dashboard
