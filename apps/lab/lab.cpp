// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/lab.hpp"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <optional>
#include <stdexcept>

#include "apps/lab/check_options.hpp"
#include "apps/lab/conducted_trials.hpp"
#include "apps/lab/control_model.hpp"
#include "apps/lab/domain_lock.hpp"
#include "apps/lab/hosts.hpp"
#include "apps/lab/launches.hpp"
#include "apps/lab/live_closing.hpp"
#include "apps/lab/output_folder.hpp"
#include "apps/lab/processes.hpp"
#include "apps/lab/subject_settings.hpp"
#include "apps/lab/summary.hpp"
#include "apps/lab/undeclared_effect.hpp"
#include "apps/libraries/session/instructions.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/rig/sealed_file.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::lab {
namespace {

constexpr double kEndPatience_s = 5.0;

// Services that end with the session leave when they receive its end; the recorder is the last.
void see_services_out(const runtime::Bus& bus) {
  constexpr std::int64_t kPatience_ns = 10'000'000'000;
  const std::int64_t limit_ns = runtime::monotonic_ns() + kPatience_ns;
  while (runtime::monotonic_ns() < limit_ns) {
    const std::vector<std::string> lost = bus.lost_peers();
    if (std::ranges::find(lost, topics::kEndsLast) != lost.end()) return;
    if (!bus.missing_peers().empty() && lost.empty()) return;  // it was never complete
    runtime::sleep_until_ns(runtime::monotonic_ns() + runtime::kNsPerSecond / 20);
  }
}

runtime::ServiceOptions service_options(const LabOptions& options, const Hosts& hosts) {
  const Place place = hosts.of("experiment");
  runtime::ServiceOptions own;
  own.service = "experiment";
  own.domain = hosts.domain();
  own.rig = options.rig;
  own.seed = options.protocol.seed;
  own.profiles = place.profiles;
  own.config = options.config;
  own.security = place.security;
  // The interlock stays closed only while this process, too, shows its life sign.
  own.real_time = options.real_time && runtime::become_real_time(!own.security.empty(),
                                                                 runtime::priority_of(own.service));
  return own;
}

// From the start of the processes to their end.
// @param recorded  gets the recording's path on the recorder's host, with --attach
void run_processes(const LabOptions& options, const AskedMotions& asked, const Hosts& hosts,
                   runtime::Stop& stop, const Script& script, LiveSession& live,
                   std::string& recorded) {
  runtime::Service service(service_options(options, hosts), stop);
  Processes processes;
  ConductedTrials trials(options, asked, service, processes, live.outcomes);
  if (!options.attach) {
    const std::string own = runtime::text_of(service.bus().participant());
    for (const Launch& launch : launches(options, hosts, own, live.sealed)) processes.start(launch);
  }
  service.run([&] {
    // The end is announced whatever the reason is, and the recorder closes its file.
    std::exception_ptr trouble;
    try {
      trials.run(script);
    } catch (...) {
      trouble = std::current_exception();
    }
    trials.end();
    live.interrupted = trials.interrupted();
    if (options.attach) {
      recorded = trials.recording();
      see_services_out(service.bus());
    } else {
      processes.end_all(std::string(topics::kEndsLast), kEndPatience_s);
    }
    if (trouble) std::rethrow_exception(trouble);
  });
}

// A person at a mouse or gamepad reads the instructions while the stick is pegged.
Prompt before_trials(const LabOptions& options) {
  Prompt prompt{.kind = PromptKind::kIdentification};
  if (options.who == Operator::kSimulated) return prompt;
  prompt.kind = PromptKind::kInstructions;
  prompt.text =
      session::text_of(session::instructions(options.gamepad.empty() ? "mouse" : "gamepad"));
  return prompt;
}

// Of a tracking trial, or of the one with the stick free.
Prompt before_trial(const LabOptions& options, const std::vector<session::PlannedTrial>& plan,
                    std::size_t place) {
  const double lead_s = kTrialLead_s + options.protocol.ramp_s;
  if (plan[place].trial.phase == TrialPhase::kFree) {
    return {.kind = PromptKind::kInstructions, .wait_s = lead_s, .text = session::kHoldStill};
  }
  const auto tracks = [](const session::PlannedTrial& planned) {
    return planned.label != session::Condition::kIdentification &&
           planned.label != session::Condition::kFreeIdentification;
  };
  return {.kind = PromptKind::kTrial,
          .trial = std::count_if(plan.begin(),
                                 plan.begin() + static_cast<std::ptrdiff_t>(place) + 1, tracks),
          .trials = std::ranges::count_if(plan, tracks),
          .wait_s = lead_s};
}

}  // namespace

LiveSession run_session(const LabOptions& asked_options, runtime::Stop& stop,
                        const Script& script) {
  LabOptions options = asked_options;
  const AskedMotions asked = check_options(options);
  const std::filesystem::path own_config = options.out / "logs" / "config";
  if (std::error_code error; std::filesystem::equivalent(options.config, own_config, error)) {
    throw ConfigError("--config", options.config.string() + ", which this session would replace",
                      "a copy of it, or another --out");
  }
  const bool perturbed = options.protocol.perturb_period_s != 0.0;
  if (options.subject != 0 || perturbed) options.config = own_config;
  Hosts hosts(options);
  const DomainLock lock(hosts.domain(), options.rig);
  LiveSession live;
  live.config = options.config;
  live.folder = std::make_shared<OutputFolder>(
      options.out,
      std::vector<std::filesystem::path>{options.ride, options.model, options.inventory});
  std::string recorded;
  const auto bring_back = [&] {
    if (options.attach) return hosts.bring_recording(recorded);
    hosts.bring_back();
  };
  try {
    if (options.subject != 0) {
      write_subject_settings(asked_options.config, options.config,
                             options.subject_seed.value_or(options.protocol.seed), options.subject);
    }
    if (perturbed) {
      write_perturbed_settings(options.subject != 0 ? options.config : asked_options.config,
                               options.config, options.task);
    }
    if (options.undeclared_effect != 0) {
      live.sealed = rig::text_of({options.undeclared_effect, digest::new_nonce()});
    }
    hosts.open(stop);
    run_processes(options, asked, hosts, stop, script, live, recorded);
  } catch (...) {
    if (live.outcomes.empty()) {
      hosts.clear();  // first: its lines go into the folder
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
    const std::vector<session::PlannedTrial> plan = session::plan(options.protocol);
    for (std::size_t place = 0; place < plan.size(); ++place) {
      const session::PlannedTrial& planned = plan[place];
      trials.show(place == 0 ? before_trials(options) : before_trial(options, plan, place));
      if (trials.interrupted()) break;
      const session::TrialOutcome outcome = trials.run(planned);
      if (!outcome.completed) break;
      if (options.close_live && !LiveClosing(options, trials).after(outcome)) break;
      if (!model || planned.trial.phase != TrialPhase::kPegged) continue;
      if (const std::string refused = trials.use(*model); !refused.empty()) {
        throw std::runtime_error(options.model.string() + ": " + refused);
      }
    }
  });
  if (live.outcomes.empty() && live.interrupted) {
    runtime::remark("interrupted before the first trial");
    return 1;
  }
  const runtime::OrdinaryWhile ordinary;
  const int status = report_session(options, live.outcomes, live.interrupted);
  if (!live.sealed.empty()) open_undeclared_effect(options, live, "summary.json");
  return status;
}

}  // namespace stillhand::lab
