// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/view/view_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "apps/dashboard/core/residual_spectrum.hpp"
#include "apps/dashboard/feed/words.hpp"
#include "services/core/contract/time_difference.hpp"

namespace stillhand::dashboard {

namespace {

Json times(const Growth& growth) {
  return {{"first_ms", instant(growth.first_at_ns)}, {"last_ms", instant(growth.last_at_ns)}};
}

// The readers of a row, and other processes that report to read it.
Json readers_json(const MessageFeed& feed, const topics::Topic& topic) {
  Json readers = Json::array();
  for (std::size_t i = 0; i < topics::kServices.size(); ++i) {
    const auto& reads = feed.services()[i].reads;
    const auto found = reads.find(std::string(topic.name));
    const bool expected =
        std::ranges::find(topic.readers, topics::kServices[i]) != topic.readers.end();
    if (!expected && found == reads.end()) continue;
    Json reader{{"service", topics::kServices[i]}};
    if (found != reads.end()) {
      const EndCounts& counts = found->second.counts();
      reader["matched"] = counts.matched;
      reader["samples"] = counts.samples;
      reader["lost_ticks"] = counts.lost_ticks;
      reader["cycle_misses"] = counts.cycle_misses;
      reader["deadline_misses"] = counts.deadline_misses;
      reader["worst_interval_us"] = number(counts.worst_interval_us);
      reader["latency_p99_us"] = number(counts.latency_p99_us);
      reader["late"] = times(found->second.late());
      reader["missed"] = times(found->second.missed());
      reader["lost"] = times(found->second.lost());
    }
    readers.push_back(std::move(reader));
  }
  return readers;
}

// Four digits: a screen shows no more.
Json numbers(const std::vector<double>& values) {
  Json all = Json::array();
  for (const double value : values) {
    all.push_back(number(std::strtod(fmt::format("{:.4g}", value).c_str(), nullptr)));
  }
  return all;
}

}  // namespace

Json instant(std::int64_t at_ns) {
  return at_ns == 0 ? Json() : Json(static_cast<double>(at_ns) / 1e6);
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json graph_json(const MessageFeed& feed) {
  Json all = Json::array();
  for (const topics::Topic* topic : topics::kCatalogue) {
    if (!feed.wants(std::string(topic->name))) continue;
    all.push_back({{"topic", topic->name},
                   {"pattern", topics::profile_of(*topic)},
                   {"writers", topic->writers},
                   {"readers", readers_json(feed, *topic)}});
  }
  Json mismatches = Json::array();
  for (const QosMismatch& each : feed.qos_mismatches().all()) {
    mismatches.push_back({{"service", each.service},
                          {"topic", each.topic},
                          {"policy", each.policy},
                          {"since_ms", instant(each.since_ns)}});
  }
  return {{"topics", std::move(all)}, {"qos_mismatches", std::move(mismatches)}};
}

Json cost_json(const MessageFeed& feed) {
  if (!feed.cost()) {
    return {{"why", "hidden, since it reveals the condition (--unblinded shows it)"}};
  }
  const std::optional<Cost>& cost = feed.cost()->cost();
  Json json{{"why", feed.cost()->why_none()}};
  if (!cost) return json;
  const session::ForceSums& sums = cost->sums;
  json["trial"] = cost->trial.number;
  json["length_s"] = sums.ticks * kControlPeriod_s;
  json["left_n"] = number(sums.force_n(sums.left));
  json["lateness_n"] = number(sums.force_n(sums.lateness));
  json["limits_n"] = number(sums.force_n(sums.limits));
  json["sensor_n"] = number(sums.force_n(sums.sensor));
  json["rest_n"] = number(sums.force_n(sums.rest));
  for (std::size_t i = 0; i < kLateNames.size(); ++i) {
    json["late_n"][kLateNames[i]] = number(sums.force_n(cost->late[i]));
  }
  return json;
}

Json spectrum_json(const ForceRecord& record) {
  const ResidualSpectrum spectrum = residual_spectrum(record);
  if (spectrum.segments == 0) return {};
  return {{"frequency_hz", numbers(spectrum.frequency_hz)},
          {"force_n2_hz", numbers(spectrum.force_n2_hz)},
          {"residual_n2_hz", numbers(spectrum.residual_n2_hz)},
          {"force_rms_n", number(spectrum.force_rms_n)},
          {"residual_rms_n", number(spectrum.residual_rms_n)},
          {"length_s", spectrum.length_s},
          {"segments", spectrum.segments},
          {"bridged_ticks", spectrum.bridged}};
}

Json timeline_json(const Timeline& timeline) {
  constexpr std::array<const char*, kMarkKinds> kKinds{"late", "lost", "alarm", "event"};
  constexpr std::array kPhases{"idle", "pegged", "tracking", "free"};
  // Rounded up to a microsecond: the instant on the page then includes the marked message.
  const auto since_s = [&](std::int64_t at_ns) {
    return std::ceil(static_cast<double>(difference_ns(at_ns, timeline.begin_ns())) / 1e3) / 1e6;
  };
  Json trials = Json::array();
  for (const TrialSpan& trial : timeline.trials()) {
    trials.push_back({{"trial", trial.number},
                      {"phase", kPhases[static_cast<std::size_t>(trial.phase)]},
                      {"from_s", since_s(trial.from_ns)},
                      {"to_s", since_s(trial.to_ns)}});
  }
  Json marks;
  for (std::size_t kind = 0; kind < kMarkKinds; ++kind) {
    Json& of_kind = marks[kKinds[kind]] = Json::array();
    for (const Mark& mark : timeline.marks(static_cast<MarkKind>(kind))) {
      of_kind.push_back({{"at_s", since_s(mark.at_ns)},
                         {"level", word(mark.level)},
                         {"count", mark.count},
                         {"subject", mark.subject},
                         {"writer", writer_of(mark.subject)},
                         {"what", mark.what},
                         {"amount", number(mark.amount)}});
    }
  }
  return {{"begin_ms", instant(timeline.begin_ns())},
          {"length_s", since_s(timeline.end_ns())},
          {"trials", std::move(trials)},
          {"marks", std::move(marks)}};
}

}  // namespace stillhand::dashboard
