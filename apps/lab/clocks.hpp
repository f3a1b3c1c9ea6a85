// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "idl/clock.h"
#include "services/bus/service.hpp"
#include "services/core/clock/clock_comparison.hpp"

namespace stillhand::lab {

/// Compares every process's clock with this one's over the bus (services/core/clock), publishes the
/// offsets each second, and reports jumps and drifts as events.  Makes its endpoints: construct it
/// before the bus starts.
class Clocks {
 public:
  explicit Clocks(runtime::Service& service);
  ~Clocks();
  Clocks(const Clocks&) = delete;
  Clocks& operator=(const Clocks&) = delete;

  /// Starts asking; call once the bus runs.
  void start();

 private:
  /// Another process's clock.
  struct Other {
    clock::ClockComparison comparison;
    std::int64_t system_ahead_ns = 0;  ///< its system clock over its monotonic one, less our own
    std::int64_t system_steps = 0;
    bool answered = false;
    bool same_clock = false;
    bool drift_reported = false;
  };

  void work(const std::stop_token& stop);
  void take(const stillhand_msgs::ClockAnswer& answer, const runtime::Arrival& arrival);
  void publish();
  void report(stillhand_msgs::EventKind kind, const std::string& who, const std::string& what);

  runtime::Service& service_;
  runtime::Publisher<stillhand_msgs::ClockQuestion> questions_;
  runtime::Publisher<stillhand_msgs::ClockOffset> offsets_;
  const std::string identity_;
  std::mutex mutex_;
  std::map<std::string, Other> others_;
  std::condition_variable_any wake_;
  std::jthread worker_;
};

}  // namespace stillhand::lab
