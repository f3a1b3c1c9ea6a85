// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>

#include "apps/recordings/info.hpp"
#include "services/core/recording/mcap/mcap_loss.hpp"

namespace stillhand::recordings {
namespace {

using nlohmann::ordered_json;

// A terminal's width of findings; `verify` and --json list all.
constexpr std::size_t kMostFindings = 10;

// Log times before 2000 are no calendar's: a clock that counts from the host's start.
std::string calendar(std::uint64_t time_ns) {
  constexpr std::uint64_t kYear2000_s = 946'684'800;
  const auto time_s = static_cast<std::time_t>(time_ns / 1'000'000'000);
  std::tm parts{};
  if (time_ns / 1'000'000'000 < kYear2000_s || gmtime_r(&time_s, &parts) == nullptr) {
    return fmt::format("{:.3f} s", static_cast<double>(time_ns) * 1e-9);
  }
  std::array<char, 64> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S UTC", &parts);
  return text.data();
}

// Texts of a file are shown without control characters, which could move a terminal's cursor.
std::string shown(std::string text) {
  std::ranges::replace_if(text, [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; }, '?');
  return text;
}

std::string state_of(const RecordingInfo& info) {
  if (info.being_written) return "still being written";
  if (info.whole) return "whole";
  return info.lost_bytes == 0
             ? "not closed or damaged, but nothing is lost"
             : fmt::format("damaged, {} lost", recording::byte_count(info.lost_bytes));
}

std::string topic_table(const RecordingInfo& info) {
  std::size_t width = 5;
  std::size_t type_width = 4;
  for (const TopicInfo& topic : info.topics) {
    width = std::max(width, topic.topic.size());
    type_width = std::max(type_width, topic.type.size());
  }
  const auto cell = [](std::string text, std::size_t to) {
    text.resize(std::max(text.size(), to), ' ');
    return shown(std::move(text)) + "  ";
  };
  std::string text =
      cell("topic", width) + cell("type", type_width) + "  messages   rate [Hz]  lost ticks\n";
  for (const TopicInfo& topic : info.topics) {
    const std::string lost = topic.lost_ticks ? std::to_string(*topic.lost_ticks) : "-";
    const std::string rate = topic.rate_hz > 0.0 ? fmt::format("{:.5g}", topic.rate_hz) : "-";
    text += cell(topic.topic, width) + cell(topic.type.empty() ? "?" : topic.type, type_width) +
            fmt::format("{:>10}  {:>10}  {:>10}\n", topic.messages, rate, lost);
  }
  return text;
}

ordered_json topic_json(const TopicInfo& topic) {
  ordered_json entry{{"topic", topic.topic},       {"type", topic.type},
                     {"encoding", topic.encoding}, {"schema_encoding", topic.schema_encoding},
                     {"messages", topic.messages}, {"rate_hz", topic.rate_hz},
                     {"first_ns", topic.first_ns}, {"last_ns", topic.last_ns},
                     {"lost_ticks", nullptr},      {"channels", topic.channels}};
  if (topic.lost_ticks) entry["lost_ticks"] = *topic.lost_ticks;
  return entry;
}

}  // namespace

std::string damage_text(const std::vector<recording::Damage>& damage) {
  std::string text;
  for (const recording::Damage& each : damage) {
    text += fmt::format("byte {}: {}", each.offset, shown(each.text));
    if (each.lost_bytes > 0) {
      text += fmt::format(" ({} lost)", recording::byte_count(each.lost_bytes));
    }
    text += '\n';
  }
  return text;
}

std::string info_text(const RecordingInfo& info) {
  const double duration_s = static_cast<double>(info.end_ns - info.start_ns) * 1e-9;
  std::string text = fmt::format(
      "{}: {}, {}\nwritten by {}, profile {}; {} chunks{}\n", shown(info.path),
      recording::byte_count(info.bytes), state_of(info), shown(info.program), shown(info.profile),
      info.chunks,
      info.packings.empty() ? "" : fmt::format(" ({})", fmt::join(info.packings, ", ")));
  if (info.messages > 0) {
    text += "from " + calendar(info.start_ns) + ", " + fmt::format("{:.3f} s, ", duration_s);
  }
  text += std::to_string(info.messages) + " messages\n\n" + topic_table(info);
  for (const recording::Metadata& metadata : info.metadata) {
    text += "\n" + shown(metadata.name) + "\n";
    for (const auto& [key, value] : metadata.texts) {
      if (metadata.name == "stillhand.counts" && value == "0") continue;  // most of a hundred
      text += fmt::format("  {}: {}\n", shown(key), shown(value));
    }
  }
  if (info.attachments > 0) {
    text += fmt::format("\n{} attachments, which are not read\n", info.attachments);
  }
  if (info.damage.empty()) return text;
  const auto listed = static_cast<std::ptrdiff_t>(std::min(info.damage.size(), kMostFindings));
  text += "\ndamage\n" + damage_text({info.damage.begin(), info.damage.begin() + listed});
  if (info.damage.size() > kMostFindings) {
    text += fmt::format("and {} more findings\n", info.damage.size() - kMostFindings);
  }
  return text;
}

std::string info_json(const RecordingInfo& info) {
  ordered_json out{{"file", info.path},
                   {"bytes", info.bytes},
                   {"program", info.program},
                   {"profile", info.profile},
                   {"whole", info.whole},
                   {"being_written", info.being_written},
                   {"messages", info.messages},
                   {"start_ns", info.start_ns},
                   {"end_ns", info.end_ns},
                   {"duration_s", static_cast<double>(info.end_ns - info.start_ns) * 1e-9},
                   {"chunks", info.chunks},
                   {"compression", info.packings},
                   {"attachments", info.attachments},
                   {"topics", ordered_json::array()},
                   {"metadata", ordered_json::array()},
                   {"lost_bytes", info.lost_bytes},
                   {"damage", ordered_json::array()},
                   {"clock_steps", ordered_json::array()}};
  for (const TopicInfo& topic : info.topics) out["topics"].push_back(topic_json(topic));
  for (const recording::Metadata& metadata : info.metadata) {
    out["metadata"].push_back({{"name", metadata.name}, {"texts", metadata.texts}});
  }
  for (const recording::Damage& damage : info.damage) {
    out["damage"].push_back(
        {{"offset", damage.offset}, {"lost_bytes", damage.lost_bytes}, {"text", damage.text}});
  }
  for (const recording::ClockStep& step : info.clock_steps) {
    out["clock_steps"].push_back({{"at_ns", step.at_ns}, {"by_ns", step.by_ns}});
  }
  // A damaged or foreign text need not be UTF-8.
  return out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace stillhand::recordings
