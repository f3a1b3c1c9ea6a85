// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/view/snapshot_json.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/dashboard/feed/words.hpp"
#include "apps/dashboard/view/health_json.hpp"
#include "apps/dashboard/view/processes_json.hpp"
#include "apps/dashboard/view/view_json.hpp"
#include "services/bus/trial_codec.hpp"

namespace stillhand::dashboard {

namespace {

constexpr std::size_t kShownEvents = 20;

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

// What the session waits for: "start" of the experimenter, "participant", "break", "rest", "trial"
// (one runs), or nothing; and how long that lasts by the sample clock.
Json protocol_json(const MessageFeed& feed) {
  constexpr std::array kKinds{"nothing", "instructions", "identification", "practice",
                              "trial",   "break",        "question",       "end"};
  const auto& prompt = feed.prompt();
  const auto& control = feed.control();
  if (!prompt || !control || prompt->number() == 0) return {};
  const auto kind = static_cast<std::size_t>(prompt->kind());
  Json protocol{{"kind", kind < kKinds.size() ? kKinds[kind] : "unknown"},
                {"participant", prompt->participant().to_string()},
                {"block", prompt->block()},
                {"blocks", prompt->blocks()},
                {"trial", prompt->trial()},
                {"trials", prompt->trials()},
                {"waits_for", ""},
                {"left_s", nullptr}};
  const Tick now = feed.newest_tick();
  const Trial trial = runtime::from_idl(*control);
  const Tick end_tick = trial.start_tick + trial.duration_ticks;
  const auto wait = [&](const char* what, Tick until) {
    protocol["waits_for"] = what;
    // The tick comes from the bus: a difference of numbers cannot overflow.
    if (until > now) {
      protocol["left_s"] =
          (static_cast<double>(until) - static_cast<double>(now)) * kControlPeriod_s;
    }
  };
  if (control->session() == stillhand_msgs::SESSION_PAUSED) {
    wait("start", -1);
  } else if (trial.phase != TrialPhase::kIdle && now < end_tick + trial.ramp_ticks) {
    wait("trial", end_tick);
  } else if (prompt->steps() > 0) {
    wait("participant", prompt->end_tick());
  } else if (prompt->end_tick() > now) {
    wait(prompt->kind() == stillhand_msgs::PROMPT_BREAK ? "break" : "rest", prompt->end_tick());
  }
  return protocol;
}

Json session_json(const MessageFeed& feed) {
  constexpr std::array kStates{"waiting", "running", "ending", "paused"};
  constexpr std::array kPhases{"idle", "pegged", "tracking", "free"};
  Json session{{"state", "none"},
               {"tick", feed.newest_tick()},
               {"blinded", feed.options().blinded},
               {"replayed", feed.replayed()},
               {"paused", false},
               {"rig_parts", feed.rig_parts()},
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
  const Trial trial = runtime::from_idl(*control);
  session["engaging"] =
      trial.phase != TrialPhase::kIdle && feed.newest_tick() < trial.start_tick - trial.ramp_ticks;
  session["protocol"] = protocol_json(feed);
  if (!feed.condition().empty()) session["condition"] = feed.condition();
  return session;
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
                {"topics", topics_json(feed, now_ns)},
                {"jitter_edges_us", jitter_edges_us()},
                {"chain", chain_json(health.chain())},
                {"cost", cost_json(feed)},
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
