// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/dashboard/core/alarm.hpp"
#include "apps/dashboard/core/chain_health.hpp"
#include "apps/dashboard/core/config.hpp"
#include "apps/dashboard/core/topic_health.hpp"

namespace stillhand::dashboard {

/// The quantity that an alarm watches.
enum class Watch : std::uint8_t { kLate, kLost, kSilent, kLatency, kChain, kService };
inline constexpr std::size_t kWatches = 6;

/// An alarm with its place.
struct NamedAlarm {
  Watch watch;
  std::string subject;  ///< topic or process; empty for the chain
  Alarm alarm;
};

/// Health of a whole bus: every topic, the chain, the processes and the alarms.  A live bus and
/// a recording feed it in the same way.  Pure: time enters with each call; one thread.
class BusHealth {
 public:
  /// @param topics    in the order in which a fault is looked for: from the sensor to the motor
  /// @param services  whose life sign is awaited
  /// @throws ConfigError when a warning lies above its critical value
  BusHealth(const Config& config, const std::vector<TopicPlan>& topics,
            const std::vector<std::string>& services);

  /// @param topic  its place in the list
  Verdict take(std::size_t topic, const Sample& sample, std::int64_t ahead_ns = 0);
  /// While a session runs, silence and lateness are faults.
  void set_running(bool running, std::int64_t now_ns) noexcept;
  /// A life sign.  @param service  its place in the list
  void alive(std::size_t service, std::int64_t now_ns) noexcept;
  /// Alarms that rest on missing samples; ten times a second.
  void step(std::int64_t now_ns);
  /// Everything that is raised now.
  void acknowledge() noexcept;

  [[nodiscard]] ChainHealth& chain() noexcept { return chain_; }
  [[nodiscard]] const ChainHealth& chain() const noexcept { return chain_; }
  [[nodiscard]] const std::vector<TopicHealth>& topics() const noexcept { return topics_; }
  [[nodiscard]] const std::vector<NamedAlarm>& alarms() const noexcept { return alarms_; }
  [[nodiscard]] bool running() const noexcept { return running_; }
  /// [ns] newest life sign of a service, 0 none yet.
  [[nodiscard]] std::int64_t last_alive_ns(std::size_t service) const {
    return alive_ns_.at(service);
  }
  [[nodiscard]] Level level() const noexcept;
  /// [ns] when step() first found it at this level; 0 before the first step().
  [[nodiscard]] std::int64_t level_since_ns() const noexcept { return level_since_ns_; }

 private:
  struct TopicAlarms {
    std::size_t late, lost, silent, latency;
  };

  [[nodiscard]] bool armed(std::int64_t began_ns, std::int64_t now_ns) const noexcept;
  std::size_t add(Watch watch, std::string subject, Threshold threshold);

  Config config_;
  std::vector<TopicHealth> topics_;
  std::vector<TopicAlarms> topic_alarms_;
  std::vector<NamedAlarm> alarms_;
  std::vector<std::int64_t> alive_ns_;
  std::size_t first_service_alarm_ = 0, chain_alarm_ = 0;
  ChainHealth chain_;
  bool running_ = false;
  std::int64_t running_since_ns_ = 0;
  Level stepped_level_ = Level::kHealthy;
  std::int64_t level_since_ns_ = 0;
};

}  // namespace stillhand::dashboard
