// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "idl/control_loop.h"
#include "idl/model.h"
#include "services/identification/core/identifier.hpp"
#include "services/runtime/service.hpp"

namespace stillhand::identification {

/// Collects the measured ticks of one pegged trial.  One thread.
class PeggedRecord {
 public:
  void begin(const Trial& trial);
  /// @return true with the trial's last measured tick, or the first after it.
  bool take(Tick tick, double accel_m_s2, double force_n);
  [[nodiscard]] std::int64_t trial() const noexcept { return trial_.number; }
  /// The record; lost ticks are interpolated.
  [[nodiscard]] Record record() const;
  [[nodiscard]] std::int64_t lost() const noexcept { return lost_; }
  [[nodiscard]] bool active() const noexcept { return active_; }

 private:
  Trial trial_;
  Record record_;
  std::int64_t lost_ = 0;
  bool active_ = false;
};

/// The identification's process: a model from each pegged trial, fitted in a thread of its own.
class Shell {
 public:
  explicit Shell(runtime::Service& service);
  void run();

 private:
  struct Job {
    Record record;
    std::int64_t lost;
    std::int64_t trial;
  };
  void on_sensed(const stillhand_msgs::Sensed& sensed);
  void fit_jobs(const std::stop_token& stop);
  stillhand_msgs::FeedthroughModel fit(const Job& job);

  runtime::Service& service_;
  Config config_;
  PeggedRecord pegged_;
  std::int32_t models_ = 0;
  std::atomic<Tick> newest_tick_{0};
  runtime::Publisher<stillhand_msgs::FeedthroughModel> model_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::optional<Job> job_;
};

}  // namespace stillhand::identification
