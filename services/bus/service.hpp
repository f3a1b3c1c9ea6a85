// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "idl/session.h"
#include "services/bus/bus.hpp"
#include "services/core/contract/trial.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/process/stall_watch.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::command_line {
class Command;
}

namespace stillhand::runtime {

/// Start options of every process.
struct ServiceOptions {
  std::string service;             ///< own name, one of topics::kServices
  std::uint32_t domain = 0;        ///< DDS domain
  std::uint32_t rig = 1;           ///< number of the rig
  std::uint64_t seed = 1;          ///< seed of all randomness in this process
  std::filesystem::path profiles;  ///< QoS profiles
  std::filesystem::path config;    ///< folder of the settings files
  std::filesystem::path security;  ///< see Bus::Options
  bool real_time = false;          ///< request a real-time scheduling policy
  bool traces_switches = false;    ///< keep the kernel's trace of its switches (SwitchTrace)
  bool serialized = false;         ///< see Bus::Options
  bool answers_replay = false;     ///< see Bus::Options
  std::string experiment;          ///< its participant, see Bus::Options; empty: any
  bool one_session = false;        ///< end with the session this process took part in
  std::filesystem::path out;       ///< where this process may write files
};

/// The shell around a core: bus, trial, status, events, stop.  Used by main() through
/// run_service().
class Service {
 public:
  Service(ServiceOptions options, Stop& stop);
  ~Service();

  [[nodiscard]] const ServiceOptions& options() const noexcept { return options_; }
  [[nodiscard]] Bus& bus() noexcept { return *bus_; }
  [[nodiscard]] Stop& stop() noexcept { return stop_; }

  /// Settings of this service from the configuration folder.  @throws ConfigError.
  template <typename Config>
  [[nodiscard]] Config config() const {
    return settings::load<Config>(options_.config / (options_.service + ".yaml"), options_.service);
  }

  /// Calls back, in the receiving thread, for each trial that the experiment announces.
  void on_trial(std::function<void(const Trial&, const stillhand_msgs::TrialControl&)> call);
  /// Calls back with each incident of the bus, in DDS's threads; it must not block.
  void on_incident(std::function<void(const BusIncident&)> call);
  /// The newest trial, for the receiving thread.
  [[nodiscard]] const Trial& trial() const noexcept { return trial_; }

  /// Control path: newest tick handled, for the status topic and for the watch on stalls.
  void note_tick(Tick tick) noexcept {
    tick_.store(tick, std::memory_order_relaxed);
    if (ticks_evenly_) stall_watch_.beat();
  }
  /// This process is prepared for a trial.
  void note_armed(std::int64_t trial) noexcept { armed_.store(trial, std::memory_order_relaxed); }
  /// The session's state by trial control; the experiment, which writes it, calls this itself.
  void follow_session(stillhand_msgs::SessionState session);
  /// An event on the bus, from any thread, without lock or allocation.
  void note_event(stillhand_msgs::EventKind kind, const char* text, double by_us = 0.0,
                  stillhand_msgs::EventCode code = stillhand_msgs::CODE_NONE) noexcept;

  /// Starts the bus and the status thread, and waits for the stop.
  void run();
  /// Callbacks run until this returns, and not after.
  ///
  /// Starts the bus and the status thread, then runs `loop` in this thread until it returns.
  void run(const std::function<void()>& loop);

 private:
  void end_without_experiment();
  void note_stalls(const std::stop_token& stop);

  ServiceOptions options_;
  bool ticks_evenly_;  // a tick after the other, as they come
  StallWatch stall_watch_;
  Stop& stop_;
  std::unique_ptr<Bus> bus_;
  Trial trial_;
  std::function<void(const Trial&, const stillhand_msgs::TrialControl&)> on_trial_;
  std::function<void(const BusIncident&)> on_incident_;
  std::atomic<Tick> tick_{-1};
  std::atomic<std::int64_t> armed_{-1};
  std::atomic<bool> session_runs_{false};
  std::atomic<bool> in_session_{false};  // now, or once
  struct Reporting;
  std::unique_ptr<Reporting> reporting_;
};

/// main() of every service: command line, signals, real time, errors as one line and exit status
/// (0 good, 2 for a fault that the user can correct, 1 for any other).
int run_service(
    const std::string& name, int argc, char** argv, const std::function<void(Service&)>& body,
    const std::function<void(command_line::Command&, ServiceOptions&)>& more_options = {});

}  // namespace stillhand::runtime
