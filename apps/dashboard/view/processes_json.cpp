// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/view/processes_json.hpp"

#include <array>
#include <map>
#include <string>
#include <utility>

#include "services/core/contract/time_difference.hpp"

namespace stillhand::dashboard {

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

}  // namespace stillhand::dashboard
