// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/lab.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "apps/lab/clocks.hpp"
#include "apps/lab/conductor.hpp"
#include "apps/lab/hosts.hpp"
#include "apps/lab/lost_service.hpp"
#include "apps/lab/output_folder.hpp"
#include "apps/lab/processes.hpp"
#include "apps/lab/rehearsal.hpp"
#include "apps/lab/summary.hpp"
#include "apps/report/progress.hpp"
#include "services/cancellation/control_model_file.hpp"
#include "services/contract/config_error.hpp"
#include "services/identification/codec.hpp"
#include "services/recording/file_io.hpp"
#include "services/rig/sealed_file.hpp"
#include "services/runtime/process/clock.hpp"
#include "services/runtime/process/domain.hpp"
#include "services/runtime/process/real_time.hpp"
#include "services/runtime/process/shipped.hpp"
#include "services/settings/load.hpp"

namespace stillhand::lab {
namespace {

constexpr double kEndPatience_s = 5.0;
constexpr double kModelLimit_s = 60.0;

/// One lab a domain and rig on this machine, held by an abstract socket name: nothing stays behind
/// however the process ends.
class DomainLock {
 public:
  DomainLock(std::uint32_t domain, std::uint32_t rig)
      : socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const std::string name = "stillhand-lab-" + std::to_string(domain) + "-" + std::to_string(rig);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path + 1, sizeof(address.sun_path) - 2);
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) != 0) {
      close(socket_);
      throw ConfigError("--domain", std::to_string(domain) + ", where another lab runs",
                        "a free DDS domain, or another --rig");
    }
  }
  ~DomainLock() { close(socket_); }
  DomainLock(const DomainLock&) = delete;
  DomainLock& operator=(const DomainLock&) = delete;

 private:
  int socket_;
};

/// Another program on the domain's discovery port would keep everybody apart in silence.
void check_port(std::uint32_t domain) {
  const auto port = static_cast<std::uint16_t>(runtime::first_port_of(domain));
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int shared = 1;  // as Fast DDS opens it: other participants do not count
  setsockopt(probe, SOL_SOCKET, SO_REUSEADDR, &shared, sizeof(shared));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const bool taken = bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0;
  close(probe);
  if (taken) {
    throw ConfigError("--domain",
                      std::to_string(domain) + ", whose UDP port " + std::to_string(port) +
                          " another program holds",
                      "a domain whose port 7400 + 250 * domain is free");
  }
}

// What the assignment on the bus leaves open.
void add_motion(std::vector<std::string>& arguments, const LabOptions& options) {
  const session::ProtocolOptions& protocol = options.protocol;
  if (protocol.motion == session::Motion::kRide) {
    arguments.insert(arguments.end(), {"--ride", options.ride.string()});
  } else if (protocol.motion == session::Motion::kRoad) {
    std::ostringstream speed;
    speed.precision(17);  // every bit of a double
    speed << protocol.road_speed_m_s;
    arguments.insert(arguments.end(),
                     {"--road-class", protocol.road_class, "--speed-m-s", speed.str()});
  }
}

/// @param sealed  what the rig reads of its undeclared effect; empty: it has none
std::vector<Launch> launches(const LabOptions& options, const Hosts& hosts,
                             const std::string& sealed) {
  std::vector<Launch> list;
  // The recorder first: it is there when the others begin.
  for (const std::string_view service : {"recorder", "rig", "sensing", "motion", "cancellation",
                                         "display", "human_operator", "identification"}) {
    const Place place = hosts.of(service);
    Launch launch;
    launch.name = service;
    launch.executable = options.programs / ("stillhand-" + launch.name);
    launch.log = options.out / "logs" / (launch.name + ".log");
    launch.arguments = {"--domain",
                        std::to_string(hosts.domain()),
                        "--rig",
                        std::to_string(options.rig),
                        "--seed",
                        std::to_string(options.protocol.seed),
                        "--profiles",
                        place.profiles.string(),
                        "--config",
                        place.config.string(),
                        "--end-with-parent"};
    const auto add = [&](std::initializer_list<std::string> words) {
      launch.arguments.insert(launch.arguments.end(), words);
    };
    if (options.real_time) add({"--real-time"});
    if (!place.security.empty()) add({"--security", place.security.string()});
    if (service == "recorder") {
      add({"--out", (place.out / "session.mcap").string()});
      const std::vector<std::string> words = recording::keep_words(options.keep);
      launch.arguments.insert(launch.arguments.end(), words.begin(), words.end());
    }
    if (service == "rig" && !sealed.empty()) {
      add({"--undeclared-effect", "--out", options.out.string()});
      launch.standard_input = sealed;
    }
    if (service == "motion") add_motion(launch.arguments, options);
    if (service == "display" && options.headless) add({"--headless"});
    if (service == "display" && options.video) {
      add({"--video", (place.out / "screen.avi").string()});
    }
    if (options.who == Operator::kMouse && (service == "display" || service == "human_operator")) {
      add({"--pointer"});
    }
    list.push_back(hosts.placed(launch));
  }
  return list;
}

// A child that ended is known at once and with what it said.  Of one that hangs the rig tells,
// whose interlock opens; of the rig nothing but its silence.  A network may hold up life signs for
// a while that the rig itself hears.
Conductor::Watch watch_of(const runtime::Bus& bus, Processes& processes,
                          const LabOptions& options) {
  constexpr double kGone_s = 0.5;
  constexpr double kHangs_s = 3.0;
  constexpr double kHangsElsewhere_s = 10.0;
  if (options.attach) return LostService(bus, kGone_s);
  const double patience_s = options.inventory.empty() ? kHangs_s : kHangsElsewhere_s;
  return [&processes, lost = LostService(bus, patience_s, "rig")]() mutable {
    const auto ended = processes.reap();
    return ended ? ended : lost();
  };
}

/// Services that end with the session leave when they hear of its end; the recorder is the last.
void see_services_out(const runtime::Bus& bus) {
  constexpr std::int64_t kPatience_ns = 10'000'000'000;
  const std::int64_t limit_ns = runtime::monotonic_ns() + kPatience_ns;
  while (runtime::monotonic_ns() < limit_ns) {
    const std::vector<std::string> lost = bus.lost_peers();
    if (std::ranges::find(lost, "recorder") != lost.end()) return;
    if (!bus.missing_peers().empty() && lost.empty()) return;  // it was never complete
    runtime::sleep_until_ns(runtime::monotonic_ns() + runtime::kNsPerSecond / 20);
  }
}

/// The session proper, once every process runs.
class Session final : public LiveTrials {
 public:
  Session(const LabOptions& options, const AskedMotions& asked, runtime::Service& service,
          Processes& processes, std::vector<session::TrialOutcome>& outcomes)
      : options_(options),
        asked_(asked),
        outcomes_(outcomes),
        clocks_(service),
        conductor_(service, watch_of(service.bus(), processes, options),
                   [this](const std::string& what, double done) { progress_.show(what, done); }) {}

  void run(const Script& script) {
    conductor_.await_everybody(options_.match_s);
    if (conductor_.interrupted()) return;
    clocks_.start();
    conductor_.begin_session();
    script(*this);
    progress_.finish();
  }
  void end() { conductor_.end_session(); }
  [[nodiscard]] std::string recording() { return conductor_.recording(); }

  const session::TrialOutcome& run(const session::PlannedTrial& planned) override {
    if (options_.wait_for_start) conductor_.pause();
    session::PlannedTrial numbered = planned;
    for (;;) {
      // Nobody takes up a number again that was there: what ran under it is over.
      numbered.trial.number = planned.trial.number + stopped_;
      outcomes_.push_back(conductor_.run(numbered));
      if (const auto motion = asked_.find(planned.trial.number); motion != asked_.end()) {
        outcomes_.back().asked = motion->second;
      }
      if (!outcomes_.back().stopped) break;
      ++stopped_;
    }
    session::TrialOutcome& outcome = outcomes_.back();
    if (outcome.completed && planned.trial.phase == TrialPhase::kPegged) take_model(outcome);
    return outcome;
  }
  [[nodiscard]] const identification::FeedthroughModel& model() const override { return model_; }
  std::string use(const cancellation::ControlModel& model) override {
    return conductor_.use(model);
  }
  [[nodiscard]] bool interrupted() const override { return conductor_.interrupted(); }

 private:
  // Without a model there is nothing to cancel with: the session ends here.
  void take_model(session::TrialOutcome& outcome) {
    const auto model = conductor_.await_model(outcome.planned.trial.number, kModelLimit_s);
    if (model && model->usable()) {
      model_ = identification::from_idl(*model);
      return;
    }
    outcome.completed = false;
    outcome.aborted = model ? std::string("no usable model, a longer --identify-seconds helps: ") +
                                  model->text().c_str()
                            : conductor_.why_stopped("identification gave no model in time");
  }

  const LabOptions& options_;
  const AskedMotions& asked_;
  std::vector<session::TrialOutcome>& outcomes_;
  identification::FeedthroughModel model_;
  std::int64_t stopped_ = 0;  ///< trials that somebody stopped so far
  report::ProgressLine progress_;
  Clocks clocks_;
  Conductor conductor_;
};

// What can be known to be wrong before anything is touched.
AskedMotions check(const LabOptions& options) {
  session::plan(options.protocol);  // checks durations and road
  if (options.domain > runtime::kMaxDomain) {
    throw ConfigError("--domain", std::to_string(options.domain),
                      "0 to " + std::to_string(runtime::kMaxDomain));
  }
  if ((options.protocol.motion == session::Motion::kRide) == options.ride.empty()) {
    throw ConfigError("--ride", options.ride.empty() ? "nothing" : options.ride.string(),
                      "a file together with --motion ride, and only then");
  }
  if (options.who == Operator::kMouse && options.headless) {
    throw ConfigError("--operator", "mouse together with --headless", "a window for the mouse");
  }
  if (options.attach &&
      (options.undeclared_effect != 0 || options.video || options.who == Operator::kMouse ||
       options.protocol.motion != session::Motion::kBandNoise)) {
    throw ConfigError("--attach", "it with --undeclared-effect, --video, --operator or --motion",
                      "those as arguments of the services, which run already");
  }
  if (!(options.match_s > 0.0 && options.match_s <= 3600.0)) {
    throw ConfigError("--match-seconds", std::to_string(options.match_s), "up to 3600 seconds");
  }
  if (!std::filesystem::is_regular_file(options.profiles)) {
    throw ConfigError("--profiles", "no file " + options.profiles.string(), "qos/profiles.xml");
  }
  motion::RideRecord ride;
  if (!options.ride.empty()) {
    ride = motion::read_ride(options.ride.string());
    if (ride.length_s() < options.protocol.trial_s) {
      throw ConfigError(options.ride.string(), std::to_string(ride.length_s()) + " s of ride",
                        "at least the --trial-seconds " + std::to_string(options.protocol.trial_s));
    }
  }
  return rehearse(options.protocol, ride, options.config);
}

}  // namespace

// The rig's executable draws the effect anew and writes it down.
void open_undeclared_effect(const LabOptions& options, const std::string& sealed,
                            const std::string& verdict) {
  constexpr std::int64_t kLimit_ns = 60'000'000'000;
  constexpr std::int64_t kPoll_ns = 20'000'000;
  Launch launch;
  launch.name = "rig";
  launch.executable = options.programs / "stillhand-rig";
  launch.log = options.out / "logs" / "experiment.log";
  launch.standard_input = sealed;
  launch.arguments = {"--open-undeclared-effect",
                      "--config",
                      options.config.string(),
                      "--out",
                      options.out.string(),
                      "--verdict",
                      verdict};
  Processes processes;
  processes.start(launch);
  const std::int64_t limit_ns = runtime::monotonic_ns() + kLimit_ns;
  std::optional<Ended> ended;
  while (!(ended = processes.reap())) {
    if (runtime::monotonic_ns() > limit_ns) {
      throw std::runtime_error("the undeclared effect could not be opened in time");
    }
    runtime::sleep_until_ns(runtime::monotonic_ns() + kPoll_ns);
  }
  if (ended->exit_status != 0) throw std::runtime_error(describe(*ended));
  std::printf("undeclared effect opened: %s\n", (options.out / rig::kSealedFile).string().c_str());
}

void set_places(LabOptions& options) {
  options.programs = runtime::prefix() / "bin";
  options.profiles = runtime::shipped("qos/profiles.xml");
  options.config = runtime::shipped("deploy/config");
}

cancellation::ControlModel control_model(const std::filesystem::path& file, std::uint32_t rig,
                                         const std::filesystem::path& config) {
  auto model =
      cancellation::parse_control_model(recording::read_file(file.string()), file.string(), rig);
  cancellation::require_sound(
      model, settings::load<cancellation::Config>(config / "cancellation.yaml", "cancellation"),
      file.string());
  return model;
}

LiveSession run_session(const LabOptions& options, runtime::Stop& stop, const Script& script) {
  const AskedMotions asked = check(options);
  Hosts hosts(options);
  const DomainLock lock(hosts.domain(), options.rig);
  check_port(hosts.domain());
  LiveSession live;
  live.folder = std::make_shared<OutputFolder>(
      options.out,
      std::vector<std::filesystem::path>{options.ride, options.model, options.inventory});
  if (options.undeclared_effect != 0) {
    live.sealed = rig::text_of({options.undeclared_effect, rig::new_nonce()});
  }
  std::string recorded;
  const auto bring_back = [&] {
    if (options.attach) return hosts.bring_recording(recorded);
    hosts.bring_back();
  };
  try {
    hosts.open(stop);
    runtime::ServiceOptions service_options;
    service_options.service = "experiment";
    service_options.domain = hosts.domain();
    service_options.rig = options.rig;
    service_options.seed = options.protocol.seed;
    service_options.profiles = hosts.of("experiment").profiles;
    service_options.config = options.config;
    service_options.security = hosts.of("experiment").security;
    // Its life sign holds the interlock closed like everybody's.
    service_options.real_time =
        options.real_time && runtime::become_real_time(!service_options.security.empty());
    runtime::Service service(service_options, stop);
    Processes processes;
    Session session(options, asked, service, processes, live.outcomes);
    if (!options.attach) {
      for (const Launch& launch : launches(options, hosts, live.sealed)) processes.start(launch);
    }
    service.run([&] {
      // However it came to an end: the others hear of it, and the recorder closes its file.
      std::exception_ptr trouble;
      try {
        session.run(script);
      } catch (...) {
        trouble = std::current_exception();
      }
      session.end();
      live.interrupted = session.interrupted();
      if (options.attach) {
        recorded = session.recording();
        see_services_out(service.bus());
      } else {
        processes.end_all("recorder", kEndPatience_s);
      }
      if (trouble) std::rethrow_exception(trouble);
    });
  } catch (...) {
    if (live.outcomes.empty()) {
      hosts.clear();  // first: what they say goes into the folder
      live.folder->discard();
    } else {
      bring_back();
    }
    throw;
  }
  if (!live.outcomes.empty()) bring_back();
  hosts.clear();
  if (live.outcomes.empty() && live.interrupted) live.folder->discard();
  return live;
}

int run_lab(const LabOptions& options, runtime::Stop& stop) {
  std::optional<cancellation::ControlModel> model;
  if (!options.model.empty()) model = control_model(options.model, options.rig, options.config);
  const LiveSession live = run_session(options, stop, [&](LiveTrials& trials) {
    for (const session::PlannedTrial& planned : session::plan(options.protocol)) {
      if (trials.interrupted() || !trials.run(planned).completed) break;
      if (!model || planned.trial.phase != TrialPhase::kPegged) continue;
      if (const std::string refused = trials.use(*model); !refused.empty()) {
        throw std::runtime_error(options.model.string() + ": " + refused);
      }
    }
  });
  if (live.outcomes.empty() && live.interrupted) {
    std::cerr << "stillhand lab: interrupted before the first trial\n";
    return 1;
  }
  const runtime::OrdinaryWhile ordinary;
  const int status = report_session(options, live.outcomes, live.interrupted);
  if (!live.sealed.empty()) open_undeclared_effect(options, live.sealed, "summary.json");
  return status;
}

}  // namespace stillhand::lab
