// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/bus_health.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

#include "services/core/contract/time_difference.hpp"
#include "services/core/contract/units.hpp"

namespace stillhand::dashboard {

namespace {

constexpr double kInTime = -1.0;  // below every threshold: late_warning_ms may be 0

Threshold checked(const char* key, double warning, double critical) {
  if (warning > critical) {
    std::ostringstream got, want;
    got << warning;
    want << "at most " << critical << ", the critical value";
    throw ConfigError(std::string("dashboard.") + key, got.str(), want.str());
  }
  return {warning, critical};
}

double ms(std::int64_t ns) { return static_cast<double>(ns) / kNsPerMs; }

}  // namespace

BusHealth::BusHealth(const Config& config, const std::vector<TopicPlan>& topics,
                     const std::vector<std::string>& services)
    : config_(config), alive_ns_(services.size(), 0) {
  validate(config, "dashboard");
  const Threshold late =
      checked("late_warning_ms", config.late_warning_ms, config.late_critical_ms);
  const Threshold lost =
      checked("lost_warning_ticks", config.lost_warning_ticks, config.lost_critical_ticks);
  const Threshold silent =
      checked("silent_warning_ms", config.silent_warning_ms, config.silent_critical_ms);
  const Threshold latency =
      checked("latency_warning_ms", config.latency_warning_ms, config.latency_critical_ms);
  const Threshold chain =
      checked("chain_warning_ms", config.chain_warning_ms, config.chain_critical_ms);
  const Threshold service =
      checked("service_warning_ms", config.service_warning_ms, config.service_critical_ms);
  for (const TopicPlan& plan : topics) {
    topics_.emplace_back(plan);
    if (plan.deadline_ns == 0) {
      topic_alarms_.push_back({});
      continue;
    }
    topic_alarms_.push_back({add(Watch::kLate, plan.name, late), add(Watch::kLost, plan.name, lost),
                             add(Watch::kSilent, plan.name, silent),
                             add(Watch::kLatency, plan.name, latency)});
  }
  chain_alarm_ = add(Watch::kChain, "", chain);
  first_service_alarm_ = alarms_.size();
  for (const std::string& name : services) add(Watch::kService, name, service);
}

std::size_t BusHealth::add(Watch watch, std::string subject, Threshold threshold) {
  alarms_.push_back({watch, std::move(subject), Alarm(threshold)});
  return alarms_.size() - 1;
}

bool BusHealth::armed(std::int64_t began_ns, std::int64_t now_ns) const noexcept {
  const std::int64_t from_ns = std::max(began_ns, running_since_ns_);
  return running_ && ms(difference_ns(now_ns, from_ns)) >= config_.grace_s * 1e3;
}

Verdict BusHealth::take(std::size_t topic, const Sample& sample, std::int64_t ahead_ns) {
  TopicHealth& health = topics_.at(topic);
  const Verdict verdict = health.step(sample, ahead_ns);
  if (health.plan().deadline_ns == 0 || !verdict.counted ||
      !armed(health.first_at_ns(), sample.arrived_ns)) {
    return verdict;
  }
  const TopicAlarms& mine = topic_alarms_[topic];
  alarms_[mine.late].alarm.step(verdict.sent_late_ns > 0 ? ms(verdict.sent_late_ns) : kInTime,
                                sample.arrived_ns);
  alarms_[mine.lost].alarm.step(static_cast<double>(verdict.lost), sample.arrived_ns);
  return verdict;
}

void BusHealth::set_running(bool running, std::int64_t now_ns) noexcept {
  if (running && !running_) running_since_ns_ = level_since_ns_ = now_ns;
  running_ = running;
}

void BusHealth::alive(std::size_t service, std::int64_t now_ns) noexcept {
  alive_ns_.at(service) = std::max(alive_ns_.at(service), now_ns);
}

void BusHealth::step(std::int64_t now_ns) {
  for (std::size_t topic = 0; topic < topics_.size(); ++topic) {
    if (topics_[topic].plan().deadline_ns == 0) continue;
    const TopicAlarms& mine = topic_alarms_[topic];
    const bool on = armed(0, now_ns);
    const std::int64_t since_ns = std::max(topics_[topic].last_at_ns(), running_since_ns_);
    alarms_[mine.silent].alarm.step(on ? ms(difference_ns(now_ns, since_ns)) : 0.0, now_ns);
    const bool told = armed(topics_[topic].first_at_ns(), now_ns);
    alarms_[mine.latency].alarm.step(told ? ms(topics_[topic].recent_latency_p99_ns(now_ns)) : 0.0,
                                     now_ns);
    if (on) continue;
    // No sample is judged now, so none keeps these up.
    alarms_[mine.late].alarm.step(kInTime, now_ns);
    alarms_[mine.lost].alarm.step(0.0, now_ns);
  }
  const double chain_ms = ms(chain_.take_worst_ns());
  alarms_[chain_alarm_].alarm.step(armed(0, now_ns) ? chain_ms : 0.0, now_ns);
  for (std::size_t service = 0; service < alive_ns_.size(); ++service) {
    const std::int64_t since_ns = std::max(alive_ns_[service], running_since_ns_);
    alarms_[first_service_alarm_ + service].alarm.step(
        armed(0, now_ns) ? ms(difference_ns(now_ns, since_ns)) : 0.0, now_ns);
  }
  if (level_since_ns_ == 0 || level() != stepped_level_) level_since_ns_ = now_ns;
  stepped_level_ = level();
}

void BusHealth::acknowledge() noexcept {
  for (NamedAlarm& each : alarms_) {
    if (each.alarm.level() != Level::kHealthy) each.alarm.acknowledge();
  }
}

Level BusHealth::level() const noexcept {
  Level worst = Level::kHealthy;
  for (const NamedAlarm& each : alarms_) worst = std::max(worst, each.alarm.level());
  return worst;
}

}  // namespace stillhand::dashboard
