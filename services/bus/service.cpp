// SPDX-License-Identifier: Apache-2.0
#include "services/bus/service.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <iostream>
#include <mutex>
#include <optional>
#include <thread>

#include "idl/session_state.hpp"
#include "services/bus/clock_answer.hpp"
#include "services/bus/identity.hpp"
#include "services/bus/reporting.hpp"
#include "services/bus/sources_codec.hpp"
#include "services/bus/trial_codec.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::runtime {
namespace {

constexpr std::chrono::milliseconds kLookPeriod{20};  // StallWatch::look()
constexpr int kLooks = 5;                             // for each StallWatch::step()

void warn_of_expiry(const ServiceOptions& options) {
  if (options.security.empty()) return;
  const std::string warning = expiry_warning({options.security, options.service});
  if (!warning.empty()) std::cerr << "stillhand-" << options.service << ": " << warning << '\n';
}

}  // namespace

struct Service::Reporting {
  explicit Reporting(Service& service, Bus& bus)
      : reporter(bus, [&service](stillhand_msgs::ServiceStatus& status) {
          status.tick(service.tick_.load(std::memory_order_relaxed));
          status.armed_trial(
              static_cast<std::int32_t>(service.armed_.load(std::memory_order_relaxed)));
          status.real_time(service.options_.real_time);
          if (service.session_runs_.load(std::memory_order_relaxed)) {
            status.state(stillhand_msgs::SERVICE_RUNNING);
          }
          service.end_without_experiment();
        }) {}
  Reporter reporter;
  int without_experiment = 0;  // statuses
};

Service::Service(ServiceOptions options, Stop& stop)
    : options_(std::move(options)),
      ticks_evenly_(options_.service != topics::kEndsLast),
      stall_watch_(options_.traces_switches),
      stop_(stop) {
  Bus::Options bus_options;
  bus_options.service = options_.service;
  bus_options.rig = options_.rig;
  bus_options.domain = options_.domain;
  bus_options.profiles = options_.profiles;
  bus_options.serialized = options_.serialized;
  bus_options.answers_replay = options_.answers_replay;
  bus_options.security = options_.security;
  bus_options.one_source = true;
  if (!options_.experiment.empty()) {
    bus_options.experiment = participant_of(options_.experiment, "--experiment");
  }
  bus_options.on_incident = [this](const BusIncident& incident) {
    Note note{incident.kind,
              stillhand_msgs::CODE_NONE,
              incident.topic,
              tick_.load(std::memory_order_relaxed),
              incident.by_us,
              {},
              {}};
    std::memcpy(note.peer, incident.peer, sizeof(note.peer));
    std::strncpy(note.text, incident.policy, sizeof(note.text) - 1);
    reporting_->reporter.publish(note);
    if (on_incident_) on_incident_(incident);
  };
  bus_ = std::make_unique<Bus>(std::move(bus_options));
  reporting_ = std::make_unique<Reporting>(*this, *bus_);
  if (options_.service == "experiment") return;  // it writes the topics
  answer_clock_questions(*bus_);
  bus_->subscribe<stillhand_msgs::TrialControl>(
      topics::kTrialControl, [this](const stillhand_msgs::TrialControl& message, const Arrival&) {
        follow_session(message.session());
        trial_ = from_idl(message);
        if (on_trial_) on_trial_(trial_, message);
      });
  bus_->subscribe<stillhand_msgs::SessionSources>(
      topics::kSessionSources,
      [this](const stillhand_msgs::SessionSources& message, const Arrival& arrival) {
        if (const auto sources = from_idl(message)) {
          bus_->take_sources(arrival.participant, *sources);
        }
      });
}

void Service::follow_session(stillhand_msgs::SessionState session) {
  const bool running = is_running(session);
  bus_->supervise(running);
  session_runs_.store(running, std::memory_order_relaxed);
  if (running) in_session_.store(true, std::memory_order_relaxed);
  // An end that is latched from a session before this process started is not its own.
  if (options_.one_session && session == stillhand_msgs::SESSION_ENDING && in_session_.load()) {
    stop_.request();
  }
}

// No process is left to announce the end of the session.
void Service::end_without_experiment() {
  constexpr int kPatience = 50;  // statuses: 5 s
  if (!options_.one_session || !in_session_.load(std::memory_order_relaxed)) return;
  const std::vector<std::string> lost = bus_->lost_peers();
  const bool gone = std::ranges::find(lost, "experiment") != lost.end();
  reporting_->without_experiment = gone ? reporting_->without_experiment + 1 : 0;
  if (reporting_->without_experiment > kPatience) stop_.request();
}

// A thread of its own: life signs do not wait for the kernel's trace.  A process that waits for
// another one's samples is silent, too: the kernel knows no reason of its own for it, and it says
// nothing.
void Service::note_stalls(const std::stop_token& stop) {
  become_background();
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  for (int turn = 1; !wake.wait_for(lock, stop, kLookPeriod, [&] { return stop.stop_requested(); });
       ++turn) {
    stall_watch_.look();
    if (turn % kLooks != 0) continue;
    const std::optional<Stall> stall = stall_watch_.step();
    if (!stall || stall->why.empty()) continue;
    note_event(stillhand_msgs::EVENT_CYCLE_MISSED, stall->why.c_str(), 1e6 * stall->late_s,
               stillhand_msgs::CODE_STALL);
  }
}

// The reporter's thread uses the bus, and the bus's threads the reporter: the thread goes first,
// then the bus (no callback after that), then the queue.
Service::~Service() {
  reporting_->reporter.stop();
  bus_.reset();
}

void Service::on_trial(
    std::function<void(const Trial&, const stillhand_msgs::TrialControl&)> call) {
  on_trial_ = std::move(call);
}

void Service::on_incident(std::function<void(const BusIncident&)> call) {
  on_incident_ = std::move(call);
}

void Service::note_event(stillhand_msgs::EventKind kind, const char* text, double by_us,
                         stillhand_msgs::EventCode code) noexcept {
  Note note{kind, code, nullptr, tick_.load(std::memory_order_relaxed), by_us, {}, {}};
  std::strncpy(note.text, text, sizeof(note.text) - 1);
  reporting_->reporter.publish(note);
}

void Service::run() {
  run([this] { stop_.wait(); });
}

void Service::run(const std::function<void()>& loop) {
  // Whatever ends the loop: the caller's callbacks must not outlive the call.
  struct Quiet {
    Service& service;
    ~Quiet() {
      service.reporting_->reporter.stop();
      service.bus_->stop_receiving();
    }
  };
  const Quiet quiet{*this};
  bus_->start();
  reporting_->reporter.start();
  const std::jthread stalls([this](const std::stop_token& stop) { note_stalls(stop); });
  loop();
}

int run_service(const std::string& name, int argc, char** argv,
                const std::function<void(Service&)>& body,
                const std::function<void(command_line::Command&, ServiceOptions&)>& more_options) {
  ServiceOptions options;
  options.service = name;
  command_line::Program cli("stillhand-" + name +
                            ": one process of a session; `stillhand lab` starts all of them");
  std::optional<pid_t> parent;
  cli.add_option("--domain", options.domain, "DDS domain, 0 to 232");
  cli.add_option("--rig", options.rig, "number of the rig on the bus");
  cli.add_option("--seed", options.seed, "seed of all randomness in this process");
  cli.add_option("--profiles", options.profiles, "QoS profiles (qos/profiles.xml)").required();
  cli.add_option("--config", options.config, "folder with the settings of each service").required();
  cli.add_option("--out", options.out, "folder or file this process may write");
  cli.add_option("--security", options.security,
                 "folder of certificates (deploy/security/make.sh) [no security]")
      .check(settings::check_name);
  cli.add_flag("--real-time", options.real_time,
               "request real-time priority: SCHED_FIFO, with --security SCHED_RR");
  cli.add_flag("--trace-switches", options.traces_switches,
               "keep the kernel's trace of which program each processor runs, where allowed");
  cli.add_flag(
      "--one-session", options.one_session,
      "end together with the session, so that a service manager starts it for the next one");
  cli.add_option("--experiment", options.experiment,
                 "participant of the experiment that starts this process: no other one names the "
                 "session's sources or announces a trial [any, the first one]");
  cli.add_option("--end-with-parent", parent, "stop when this process, which starts it, ends");
  if (more_options) more_options(cli, options);
  if (const auto status = cli.parse(argc, argv)) return *status;
  try {
    Stop stop;  // a signal is kept for it from here on
    if (parent) end_with_parent(*parent);
    if (options.real_time) {
      options.real_time = become_real_time(!options.security.empty(), priority_of(name));
      lock_memory();  // host_status tells whether it is
    }
    Service service(options, stop);
    warn_of_expiry(options);
    body(service);
    return 0;
  } catch (const ConfigError& error) {
    std::cerr << "stillhand-" << name << ": " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "stillhand-" << name << ": " << error.what() << '\n';
    return 1;
  }
}

}  // namespace stillhand::runtime
