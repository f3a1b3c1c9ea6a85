// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/view/health_json.hpp"

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/dashboard/feed/words.hpp"

namespace stillhand::dashboard {

namespace {

// Edges of the jitter's bars; everything above the last is a bar of its own.
const std::vector<std::int64_t> kJitterEdges_ns{
    10'000, 20'000, 50'000, 100'000, 200'000, 500'000, 1'000'000, 2'000'000, 5'000'000, 10'000'000};

Json spread_json(const Spread& spread) {
  return {{"count", spread.count},
          {"p50_us", us(spread.p50_ns)},
          {"p99_us", us(spread.p99_ns)},
          {"p999_us", us(spread.p999_ns)},
          {"max_us", us(spread.max_ns)}};
}

Json lateness_json(const Lateness& lateness) {
  return {{"count", lateness.count},
          {"worst_us", us(lateness.worst_ns)},
          {"first_ms", instant(lateness.first_at_ns)},
          {"last_ms", instant(lateness.last_at_ns)}};
}

Json topic_json(const TopicHealth& topic, std::int64_t now_ns) {
  const TopicReport report = topic.report(now_ns);
  const TopicPlan& plan = topic.plan();
  return {{"topic", plan.name},
          {"writer", writer_of(plan.name)},
          {"expected_hz", plan.period_ns == 0 ? 0.0 : 1e9 / static_cast<double>(plan.period_ns)},
          {"deadline_us", us(plan.deadline_ns)},
          {"samples", report.samples},
          {"rate_hz", report.rate_hz},
          {"first_tick", report.first_tick},
          {"last_tick", report.last_tick},
          {"lost", report.lost},
          {"not_sent", report.not_sent},
          {"lost_since_ms", instant(report.lost_since_ns)},
          {"sent_late", lateness_json(report.sent)},
          {"arrived_late", lateness_json(report.arrived)},
          {"jitter", spread_json(report.jitter)},
          {"jitter_counts", topic.jitter_up_to(kJitterEdges_ns)},
          {"latency", spread_json(report.latency)},
          {"recent_jitter", spread_json(report.recent_jitter)},
          {"recent_latency", spread_json(report.recent_latency)},
          {"negative_latencies", report.negative_latencies},
          {"first_ms", instant(report.first_at_ns)},
          {"last_ms", instant(report.last_at_ns)}};
}

/// The host of a process, "" until its first report.
std::string host_of(const MessageFeed& feed, std::string_view service) {
  for (const ServiceView& view : feed.services()) {
    if (view.host && view.host->service().to_string() == service)
      return view.host->host().to_string();
  }
  return "";
}

Json alarm_json(const MessageFeed& feed, const NamedAlarm& named) {
  const Alarm& alarm = named.alarm;
  const std::string_view writer = writer_of(named.subject);
  return {{"watch", word(named.watch)},
          {"subject", named.subject},
          {"writer", writer},
          {"host", host_of(feed, writer.empty() ? named.subject : writer)},
          {"unit", unit(named.watch)},
          {"level", word(alarm.level())},
          {"active", alarm.active()},
          {"acknowledged", alarm.acknowledged()},
          {"worst", alarm.worst()},
          {"count", alarm.count()},
          {"since_ms", instant(alarm.since_ns())},
          {"last_ms", instant(alarm.last_ns())}};
}

}  // namespace

Json topics_json(const MessageFeed& feed, std::int64_t now_ns) {
  Json all = Json::array();
  for (const TopicHealth& topic : feed.health().topics()) {
    if (feed.wants(topic.plan().name)) all.push_back(topic_json(topic, now_ns));
  }
  return all;
}

Json jitter_edges_us() {
  Json edges = Json::array();
  for (const std::int64_t edge_ns : kJitterEdges_ns) edges.push_back(us(edge_ns));
  return edges;
}

Json chain_json(const ChainHealth& chain) {
  return {{"sensed", spread_json(chain.to_sensed())},
          {"command", spread_json(chain.to_command())},
          {"motor", spread_json(chain.to_motor())}};
}

// Alarms of one level are already in the order of the chain.
Json alarms_json(const MessageFeed& feed) {
  std::vector<const NamedAlarm*> raised;
  for (const NamedAlarm& each : feed.health().alarms()) {
    if (each.alarm.level() != Level::kHealthy) raised.push_back(&each);
  }
  std::ranges::stable_sort(raised, std::greater{},
                           [](const NamedAlarm* each) { return each->alarm.level(); });
  Json all = Json::array();
  for (const NamedAlarm* each : raised) all.push_back(alarm_json(feed, *each));
  return all;
}

}  // namespace stillhand::dashboard
