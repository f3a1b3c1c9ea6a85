// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/view/snapshot_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/dashboard/view/view_json.hpp"
#include "apps/dashboard/view/words.hpp"
#include "services/contract/time_difference.hpp"

namespace stillhand::dashboard {

namespace {

// Edges of the jitter's bars; everything above the last is a bar of its own.
const std::vector<std::int64_t> kJitterEdges_ns{
    10'000, 20'000, 50'000, 100'000, 200'000, 500'000, 1'000'000, 2'000'000, 5'000'000, 10'000'000};
constexpr std::size_t kShownEvents = 20;

double us(std::int64_t ns) { return static_cast<double>(ns) / 1e3; }

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

Json rigs_json(const std::vector<RigSummary>& rigs) {
  Json all = Json::array();
  for (const RigSummary& each : rigs) {
    all.push_back({{"rig", each.rig},
                   {"level", word(each.level)},
                   {"running", each.running},
                   {"samples", each.samples},
                   {"lost", each.lost},
                   {"worst", each.worst}});
  }
  return all;
}

// The worst first; alarms of one level are already in the order of the chain.
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

Json session_json(const MessageFeed& feed) {
  constexpr std::array kStates{"waiting", "running", "ending", "paused"};
  constexpr std::array kPhases{"idle", "pegged", "tracking"};
  Json session{{"state", "none"},
               {"tick", feed.newest_tick()},
               {"blinded", feed.options().blinded},
               {"replayed", feed.replayed()},
               {"paused", false},
               {"emergency", feed.emergency_ns() != 0},
               {"emergency_ms", instant(feed.emergency_ns())}};
  const auto& control = feed.control();
  if (!control) return session;
  const auto state = static_cast<std::size_t>(control->session());
  const auto phase = static_cast<std::size_t>(control->phase());
  session["state"] = state < kStates.size() ? kStates[state] : "unknown";
  session["paused"] = control->session() == stillhand_msgs::SESSION_PAUSED;
  session["phase"] = phase < kPhases.size() ? kPhases[phase] : "unknown";
  session["trial"] = control->trial();
  session["start_tick"] = control->start_tick();
  session["duration_ticks"] = control->duration_ticks();
  if (!feed.condition().empty()) session["condition"] = feed.condition();
  return session;
}

Json services_json(const MessageFeed& feed, std::int64_t now_ns) {
  constexpr std::array kStates{"starting", "ready", "running", "fault"};
  Json all = Json::array();
  for (std::size_t i = 0; i < topics::kServices.size(); ++i) {
    const ServiceView& view = feed.services()[i];
    const std::int64_t last_ns = feed.health().last_alive_ns(i);
    Json service{{"service", topics::kServices[i]}, {"last_ms", instant(last_ns)}};
    if (view.status) {
      const auto state = static_cast<std::size_t>(view.status->state());
      service["state"] = state < kStates.size() ? kStates[state] : "unknown";
      service["silent_ms"] = us(difference_ns(now_ns, last_ns)) / 1e3;
      service["pid"] = view.status->pid();
      service["real_time"] = view.status->real_time();
      service["waits_for"] = view.status->missing().to_string();
      service["deadline_misses"] = view.deadline_misses;
      service["cycle_misses"] = view.cycle_misses;
      service["lost_ticks"] = view.lost_ticks;
    }
    if (view.host) {
      service["host"] = view.host->host().to_string();
      service["cpu_share"] = number(view.host->process_cpu_share());
      service["priority"] = view.host->priority();
      service["memory_locked"] = view.host->memory_locked();
      service["resident_mb"] = static_cast<double>(view.host->resident_bytes()) / 1e6;
    }
    all.push_back(std::move(service));
  }
  return all;
}

// Each process reports its host; the newest report counts.
Json hosts_json(const MessageFeed& feed) {
  std::map<std::string, Json> by_name;
  std::map<std::string, std::int64_t> newest_ns;
  for (const ServiceView& view : feed.services()) {
    if (!view.host) continue;
    const std::string name = view.host->host().to_string();
    const std::string service = view.host->service().to_string();
    Json& host = by_name[name];
    if (host.is_null()) host = {{"host", name}, {"services", Json::array()}};
    host["services"].push_back(service);
    if (std::int64_t& newest = newest_ns[name]; view.host_at_ns >= newest) {
      newest = view.host_at_ns;
      host["cores"] = view.host->cores();
      host["cpu_share"] = number(view.host->host_cpu_share());
    }
    if (const auto clock = feed.clocks().find(service); clock != feed.clocks().end()) {
      host["clock_offset_us"] = us(clock->second.offset_ns());
      host["clock_uncertainty_us"] = number(clock->second.uncertainty_ns() / 1e3);
    }
  }
  Json all = Json::array();
  for (auto& [name, host] : by_name) all.push_back(std::move(host));
  return all;
}

Json recorders_json(const MessageFeed& feed, std::int64_t now_ns) {
  Json all = Json::array();
  for (const auto& [name, view] : feed.recorders()) {
    const auto& status = view.status;
    all.push_back({{"name", name},
                   {"file", status.file().to_string()},
                   {"paused", status.paused()},
                   {"received", status.received()},
                   {"lost", status.lost()},
                   {"written", status.written()},
                   {"dropped", status.dropped()},
                   {"file_bytes", status.file_bytes()},
                   {"free_bytes", status.free_bytes()},
                   {"trouble", status.trouble().to_string()},
                   {"answer", status.answer().to_string()},
                   {"silent_ms", us(difference_ns(now_ns, view.at_ns)) / 1e3}});
  }
  return all;
}

Json clocks_json(const MessageFeed& feed) {
  Json all = Json::array();
  for (const auto& [service, clock] : feed.clocks()) {
    all.push_back({{"service", service},
                   {"same_clock", clock.same_clock()},
                   {"offset_us", us(clock.offset_ns())},
                   {"uncertainty_us", number(clock.uncertainty_ns() / 1e3)},
                   {"drift_ppm", number(clock.drift_ppm())},
                   {"system_offset_us", us(clock.system_offset_ns())},
                   {"steps", clock.steps()}});
  }
  return all;
}

Json events_json(const MessageFeed& feed) {
  Json all = Json::array();
  for (const HeardEvent& heard : feed.events()) {
    if (all.size() == kShownEvents) break;
    all.push_back({{"at_ms", instant(heard.at_ns)},
                   {"kind", word(heard.event.kind())},
                   {"source", heard.event.source().to_string()},
                   {"topic", heard.event.topic().to_string()},
                   {"peer", heard.event.peer().to_string()},
                   {"by_us", number(heard.event.by_us())},
                   {"text", heard.event.text().to_string()}});
  }
  return all;
}

Json screen_json(const Surroundings& around) {
  const display::ScreenConfig& screen = around.screen.screen;
  return {{"width_m", screen.width_m},
          {"height_m", screen.height_m},
          {"line_width_m", screen.line_width_m},
          {"cross_width_m", screen.cross_width_m},
          {"track_above_bottom_m", screen.track_above_bottom_m},
          {"box_width_m", around.screen.box_width_m}};
}

Json traces_json(const MessageFeed& feed, Tick after) {
  constexpr std::array<const char*, kSignals> kNames{
      "accel_y_m_s2", "force_n", "predicted_force_n", "motor_force_n", "target_m", "cursor_m"};
  const std::vector<Traces::Row> rows = feed.traces().rows(after);
  Json traces;
  Json ticks = Json::array();
  for (const Traces::Row& row : rows) ticks.push_back(row.tick);
  traces["tick"] = std::move(ticks);
  for (std::size_t signal = 0; signal < kSignals; ++signal) {
    Json values = Json::array();
    for (const Traces::Row& row : rows) {
      // Ten micronewtons or micrometres are more than a screen shows.
      values.push_back(number(std::round(row.values[signal] * 1e5) / 1e5));
    }
    traces[kNames[signal]] = std::move(values);
  }
  return traces;
}

}  // namespace

std::string snapshot_json(const MessageFeed& feed, const Surroundings& around, std::int64_t now_ns,
                          Tick after, Parts parts) {
  const BusHealth& health = feed.health();
  Json topics = Json::array();
  for (const TopicHealth& topic : health.topics()) {
    if (feed.wants(topic.plan().name)) topics.push_back(topic_json(topic, now_ns));
  }
  std::vector<double> edges_us;
  edges_us.reserve(kJitterEdges_ns.size());
  for (const std::int64_t edge_ns : kJitterEdges_ns) edges_us.push_back(us(edge_ns));
  Json snapshot{{"mode", around.mode},
                {"file", around.file},
                {"domain", around.domain},
                {"rig", feed.options().rig},
                {"rigs", rigs_json(around.rigs)},
                {"now_ms", instant(now_ns)},
                {"level", word(health.level())},
                {"level_since_ms", instant(health.level_since_ns())},
                {"session", session_json(feed)},
                {"alarms", alarms_json(feed)},
                {"topics", std::move(topics)},
                {"jitter_edges_us", edges_us},
                {"chain",
                 {{"sensed", spread_json(health.chain().to_sensed())},
                  {"command", spread_json(health.chain().to_command())},
                  {"motor", spread_json(health.chain().to_motor())}}},
                {"services", services_json(feed, now_ns)},
                {"hosts", hosts_json(feed)},
                {"recorders", recorders_json(feed, now_ns)},
                {"actions", {{"enabled", around.actions}}},
                {"clocks", clocks_json(feed)},
                {"events", events_json(feed)},
                {"traces", traces_json(feed, after)},
                {"limits", {{"motor_force_n", around.motor_limit_n}}},
                {"screen", screen_json(around)},
                {"dashboard",
                 {{"cpu_share", number(around.cpu_share)},
                  {"clients", around.clients},
                  {"dropped", around.dropped},
                  {"malformed", feed.malformed()},
                  {"trouble", around.trouble}}}};
  if (parts.graph) snapshot["graph"] = graph_json(feed);
  if (parts.spectrum) snapshot["spectrum"] = spectrum_json(feed.forces());
  // Texts come from the bus: bytes that are not UTF-8 are replaced.
  return snapshot.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace stillhand::dashboard
