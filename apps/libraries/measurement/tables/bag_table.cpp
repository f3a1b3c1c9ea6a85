// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/bag_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "apps/libraries/measurement/tables/at_times.hpp"
#include "apps/libraries/measurement/tables/bag_topics.hpp"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/recording/mcap/mcap_loss.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::measurement {
namespace {

using recording::Cell;
using recording::CellKind;

double number_of(const Cell& cell) {
  if (const auto* value = std::get_if<double>(&cell)) return *value;
  if (const auto* value = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*value);
  if (const auto* value = std::get_if<std::uint64_t>(&cell)) return static_cast<double>(*value);
  return std::numeric_limits<double>::quiet_NaN();
}

// Of a topic's messages, those that do not fit its definition, at most: damage hits single ones,
// and a writer with another definition has more of them.
constexpr double kMostMisfits = 0.05;
constexpr std::ptrdiff_t kFarBack_rows = 100;
constexpr std::int64_t kFarBack_ns = 1'000'000'000;
// Between the segments of stamps that went back: no bridge reaches over it.
constexpr std::int64_t kBetweenSegments_ns = 2'000'000'000;

// A whole number within +-4e9, which no sum of seconds and nanoseconds overflows; else 0.
std::int64_t whole_of(const Cell& cell) {
  const double value = number_of(cell);
  return std::abs(value) <= 4e9 ? static_cast<std::int64_t>(value) : 0;
}

// How many of the stamps counted so far lie between two others: a binary indexed tree (Fenwick,
// Software: Practice and Experience 24, 1994) over the stamps in their order.
class CountedStamps {
 public:
  explicit CountedStamps(std::vector<std::int64_t> stamps)
      : stamps_(std::move(stamps)), sums_(stamps_.size() + 1) {
    std::ranges::sort(stamps_);
  }
  void count(std::int64_t stamp, std::ptrdiff_t by) {
    for (std::size_t k = up_to(stamp); k < sums_.size(); k += k & (~k + 1)) sums_[k] += by;
  }
  [[nodiscard]] std::ptrdiff_t within(std::int64_t low, std::int64_t high) const {
    return sum(up_to(high)) - sum(up_to(low - 1));
  }

 private:
  [[nodiscard]] std::size_t up_to(std::int64_t stamp) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(stamps_, stamp) - stamps_.begin());
  }
  [[nodiscard]] std::ptrdiff_t sum(std::size_t k) const {
    std::ptrdiff_t out = 0;
    for (; k > 0; k &= k - 1) out += sums_[k];
    return out;
  }
  std::vector<std::int64_t> stamps_;
  std::vector<std::ptrdiff_t> sums_;
};

// Where a column of the table lies.
struct Source {
  std::size_t topic = 0;
  std::size_t cell = 0;
};

// The rows of one topic.
struct TopicRows {
  std::vector<std::size_t> wanted;  // places in the list of columns asked for
  std::vector<std::int64_t> time_ns;
  std::vector<std::vector<double>> values;
  std::vector<double> time_s;
  std::size_t misfits = 0;            // messages that do not fit the definition
  std::size_t longer = 0;             // messages with bytes behind its members
  std::vector<std::size_t> segments;  // first message of each, as they came; the stamps go back

  // A message that comes late has a stamp that no other has.  Where the stamps have gone back,
  // those that follow lie among those that came before.  Of a file that has lost messages, these
  // may be the ones: there, a second's worth of rows that goes back is enough.
  void find_segments(bool lossy) {
    segments = {0};
    if (std::ranges::is_sorted(time_ns)) return;
    CountedStamps before(time_ns);  // of this segment
    std::size_t counted = 0;
    std::size_t latest = 0;
    for (std::size_t i = 1; i < time_ns.size(); ++i) {
      if (time_ns[i] >= time_ns[latest]) {
        latest = i;
        continue;
      }
      std::size_t end = i + 1;
      while (end < time_ns.size() && time_ns[end] < time_ns[latest]) ++end;
      const auto begin = time_ns.begin();
      const auto at = [&](std::size_t k) { return begin + static_cast<std::ptrdiff_t>(k); };
      const auto [low, high] = std::minmax_element(at(i), at(end));
      for (; counted < i; ++counted) before.count(time_ns[counted], 1);
      const auto among = before.within(*low, *high);
      // A second's worth of rows ahead of all others is no message that came late.
      const bool ahead =
          at(end) - at(i) >= kFarBack_rows && *high < *std::min_element(at(segments.back()), at(i));
      const bool far = at(end) - at(i) >= kFarBack_rows || *high - *low >= kFarBack_ns;
      if (ahead || 2 * among >= at(end) - at(i) || (lossy && far)) {
        for (std::size_t k = segments.back(); k < i; ++k) before.count(time_ns[k], -1);
        segments.push_back(i);
        latest = i;
      } else {
        i = end - 1;
      }
    }
  }
  // [ns] earliest and latest stamp of a segment.
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> span(std::size_t segment) const {
    const auto [low, high] = std::minmax_element(at(segment), at(segment + 1));
    return {*low, *high};
  }
  void move(std::size_t segment, std::int64_t by_ns) {
    for (auto t = at(segment); t != at(segment + 1); ++t) {
      time_ns[static_cast<std::size_t>(t - time_ns.cbegin())] += by_ns;
    }
  }
  [[nodiscard]] std::vector<std::int64_t>::const_iterator at(std::size_t segment) const {
    const std::size_t first = segment < segments.size() ? segments[segment] : time_ns.size();
    return time_ns.cbegin() + static_cast<std::ptrdiff_t>(first);
  }

  // By time; of several messages with one stamp the first stays.
  std::size_t sort() {
    std::vector<std::size_t> order(time_ns.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return time_ns[i]; });
    const auto same = [&](std::size_t a, std::size_t b) { return time_ns[a] == time_ns[b]; };
    order.erase(std::unique(order.begin(), order.end(), same), order.end());
    const std::size_t dropped = time_ns.size() - order.size();
    const auto arrange = [&](auto& list) {
      auto arranged = list;
      arranged.resize(order.size());
      for (std::size_t i = 0; i < order.size(); ++i) arranged[i] = list[order[i]];
      list = std::move(arranged);
    };
    arrange(time_ns);
    for (auto& column : values) arrange(column);
    return dropped;
  }
};

// The file, its reader and its topics, open as long as the table.
struct OpenBag {
  explicit OpenBag(const std::string& from) : path(from), file(from), reader(file) {
    if (!reader.status().ok()) {
      throw ConfigError(path, reader.status().text, "an MCAP recording of a session or of ROS 2");
    }
    topics = find_bag_topics(reader, path);
  }
  // What is lost of what has been read so far.
  [[nodiscard]] std::string loss() const {
    return recording::loss_line(path, reader, std::nullopt, file.being_written());
  }
  std::string path;
  recording::FileSource file;
  recording::McapReader reader;
  BagTopics topics;
};

TableHead head_of_bag(const OpenBag& bag, const std::string& path, std::vector<Source>& sources) {
  TableHead head;
  head.path = path;
  head.form = "MCAP" + (bag.reader.profile().empty() ? "" : " of " + bag.reader.profile());
  head.has_times = true;
  for (std::size_t t = 0; t < bag.topics.topics.size(); ++t) {
    const BagTopic& topic = *bag.topics.topics[t];
    const auto& columns = topic.columns->columns();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (columns[c].kind == CellKind::kText) continue;
      if (topic.stamp && (c == topic.stamp->first || c == topic.stamp->second)) continue;
      const std::string title = topic.name + "." + columns[c].name;
      const std::string unit =
          columns[c].unit.empty() ? ros_unit(topic.type, columns[c].name) : columns[c].unit;
      head.columns.push_back({title, title, unit, static_cast<std::size_t>(topic.messages)});
      sources.push_back({t, c});
    }
  }
  if (head.columns.empty()) {
    const auto& left_out = bag.topics.left_out;
    const std::string lost = bag.loss().empty() ? "" : " (" + bag.loss() + ")";
    throw ConfigError(path,
                      left_out.empty() ? "an MCAP file without messages" + lost
                                       : "no topic to read (" + left_out.front() + ")",
                      "messages in CDR with their definition (ros2msg or omgidl)");
  }
  return head;
}

class BagTable : public TableFile {
 public:
  BagTable(std::unique_ptr<OpenBag> bag, TableHead head, std::vector<Source> sources,
           std::size_t most_values)
      : TableFile(std::move(head)),
        bag_(std::move(bag)),
        sources_(std::move(sources)),
        most_values_(most_values) {}

  RawColumns read(const std::vector<std::size_t>& columns) override {
    std::map<std::size_t, TopicRows> by_topic;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      TopicRows& rows = by_topic[sources_.at(columns[i]).topic];
      rows.wanted.push_back(i);
      rows.values.emplace_back();
    }
    RawColumns out;
    check_size(by_topic);
    collect(columns, by_topic);
    set_loss(bag_->loss());
    note_misfits(by_topic, out);
    follow_back_steps(by_topic, out);
    std::int64_t zero_ns = std::numeric_limits<std::int64_t>::max();
    for (auto& [number, rows] : by_topic) {
      if (const std::size_t dropped = rows.sort(); dropped > 0) {
        if (dropped > rows.time_ns.size()) {
          throw ConfigError(head().path,
                            std::to_string(dropped) + " messages of " + name(number) +
                                " with the stamp of another one",
                            "stamps that move on; this sender does not set header.stamp");
        }
        out.notes.push_back(std::to_string(dropped) + " messages of " + name(number) +
                            " left out: their stamp is that of another one.");
      }
      if (!rows.time_ns.empty()) zero_ns = std::min(zero_ns, rows.time_ns.front());
    }
    for (auto& [number, rows] : by_topic) {
      for (const std::int64_t t : rows.time_ns) {
        rows.time_s.push_back(static_cast<double>(t - zero_ns) / 1e9);
      }
    }
    join(sources_[columns[0]].topic, by_topic, columns.size(), out);
    return out;
  }

 private:
  [[nodiscard]] const std::string& name(std::size_t topic) const {
    return bag_->topics.topics[topic]->name;
  }

  void note_misfits(const std::map<std::size_t, TopicRows>& by_topic, RawColumns& out) const {
    for (const auto& [number, rows] : by_topic) {
      const std::size_t all = rows.misfits + rows.time_ns.size();
      if (rows.longer > 0) {
        out.notes.push_back(std::to_string(rows.longer) + " of " + std::to_string(all) +
                            " messages of " + name(number) +
                            " are longer than their definition: what follows its members is not "
                            "read.");
      }
      if (rows.misfits == 0) continue;
      const std::string count = std::to_string(rows.misfits) + " of " + std::to_string(all) +
                                " messages of " + name(number) + " do not fit their definition";
      if (static_cast<double>(rows.misfits) > kMostMisfits * static_cast<double>(all)) {
        throw ConfigError(head().path, count, "at most 5 %; record it with the right definition");
      }
      out.notes.push_back(count + ": they are left out.");
    }
  }

  // One clock stamps all topics.  Where it has gone back, time goes on and a new stretch begins.
  void follow_back_steps(std::map<std::size_t, TopicRows>& by_topic, RawColumns& out) const {
    std::size_t most = 1;
    for (auto& [number, rows] : by_topic) {
      if (rows.time_ns.empty()) return;
      rows.find_segments(bag_->reader.lost_bytes() > 0);
      most = std::max(most, rows.segments.size());
    }
    for (const auto& [number, rows] : by_topic) {
      if (rows.segments.size() == most) continue;
      throw ConfigError(head().path, "time stamps that go back, but not those of " + name(number),
                        "topics of one clock");
    }
    const auto earliest = [&](std::size_t segment) {
      std::int64_t out_ns = std::numeric_limits<std::int64_t>::max();
      for (const auto& [number, rows] : by_topic) {
        out_ns = std::min(out_ns, rows.span(segment).first);
      }
      return out_ns;
    };
    const std::int64_t start_ns = earliest(0);
    for (std::size_t segment = 1; segment < most; ++segment) {
      std::int64_t end_ns = std::numeric_limits<std::int64_t>::min();
      for (const auto& [number, rows] : by_topic) {
        end_ns = std::max(end_ns, rows.span(segment - 1).second);
      }
      const std::int64_t by_ns = end_ns + kBetweenSegments_ns - earliest(segment);
      for (auto& [number, rows] : by_topic) rows.move(segment, by_ns);
      out.back_steps.push_back({static_cast<double>(end_ns - start_ns) / 1e9,
                                static_cast<double>(by_ns - kBetweenSegments_ns) / 1e9});
    }
  }

  void check_size(const std::map<std::size_t, TopicRows>& by_topic) const {
    for (const auto& [number, rows] : by_topic) {
      const std::uint64_t messages = bag_->topics.topics[number]->messages;
      if (messages > most_values_ / rows.wanted.size()) {
        throw ConfigError(head().path, std::to_string(messages) + " messages of " + name(number),
                          "at most " + std::to_string(most_values_) + " values");
      }
    }
  }

  void collect(const std::vector<std::size_t>& columns,
               std::map<std::size_t, TopicRows>& by_topic) {
    std::vector<Cell> cells;
    // Not the wanted topics alone: a chunk without a checksum has that of the whole data section.
    const recording::Status status =
        bag_->reader.verify([&](const recording::MessageView& message) {
          const auto found = bag_->topics.by_channel.find(message.channel.id);
          if (found == bag_->topics.by_channel.end()) return;
          const auto number =
              static_cast<std::size_t>(std::ranges::find_if(bag_->topics.topics,
                                                            [&](const auto& topic) {
                                                              return topic.get() == found->second;
                                                            }) -
                                       bag_->topics.topics.begin());
          const auto rows = by_topic.find(number);
          if (rows == by_topic.end()) return;
          std::size_t behind = 0;
          if (!found->second->columns->read(message.bytes, cells, &behind)) {
            ++rows->second.misfits;
            return;
          }
          if (behind > 0) ++rows->second.longer;
          take(message, *found->second, cells, columns, rows->second);
        });
    if (!status.ok()) throw ConfigError(head().path, status.text, "a file that can be read");
  }

  void take(const recording::MessageView& message, const BagTopic& topic,
            const std::vector<Cell>& cells, const std::vector<std::size_t>& columns,
            TopicRows& rows) const {
    constexpr std::uint64_t kLatest_ns = std::uint64_t{1} << 62;
    auto time_ns = static_cast<std::int64_t>(std::min(message.log_time_ns, kLatest_ns));
    if (topic.stamp) {
      const std::int64_t stamp_ns =
          whole_of(cells[topic.stamp->first]) * kSecond_ns + whole_of(cells[topic.stamp->second]);
      if (stamp_ns != 0) time_ns = stamp_ns;  // 0: the sender has no clock
    }
    rows.time_ns.push_back(time_ns);
    for (std::size_t i = 0; i < rows.wanted.size(); ++i) {
      rows.values[i].push_back(number_of(cells[sources_[columns[rows.wanted[i]]].cell]));
    }
  }

  // The rows of the first topic; the others are taken at its times.
  void join(std::size_t first, std::map<std::size_t, TopicRows>& by_topic, std::size_t columns,
            RawColumns& out) const {
    out.values.resize(columns);
    out.time_s = by_topic.at(first).time_s;
    for (auto& [number, rows] : by_topic) {
      const bool same_times = rows.time_s == out.time_s;
      const double longest_s = longest_bridge_s(rows.time_s);
      for (std::size_t i = 0; i < rows.wanted.size(); ++i) {
        out.values[rows.wanted[i]] =
            same_times ? std::move(rows.values[i])
                       : at_times(rows.time_s, rows.values[i], out.time_s, longest_s);
      }
      if (!same_times) {
        out.notes.push_back("Values of " + name(number) + " are taken at the times of " +
                            name(first) + ", by a cubic between its rows.");
      }
    }
  }

  std::unique_ptr<OpenBag> bag_;
  std::vector<Source> sources_;  // of each column
  std::size_t most_values_;
};

}  // namespace

std::unique_ptr<TableFile> bag_table(const std::string& path, std::size_t most_values) {
  auto bag = std::make_unique<OpenBag>(path);
  std::vector<Source> sources;
  TableHead head = head_of_bag(*bag, path, sources);
  head.loss = bag->loss();
  return std::make_unique<BagTable>(std::move(bag), std::move(head), std::move(sources),
                                    most_values);
}

bool is_session(const std::string& path) {
  recording::FileSource file(path);
  const recording::McapReader reader(file);
  return std::ranges::any_of(reader.channels(), [](const auto& entry) {
    return entry.second.topic == topics::kSensed.name;
  });
}

}  // namespace stillhand::measurement
