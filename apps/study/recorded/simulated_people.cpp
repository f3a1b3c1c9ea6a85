// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/simulated_people.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <utility>

#include "apps/close_the_loop/verdict/control_model.hpp"
#include "apps/libraries/experiment/core/plan.hpp"
#include "apps/study/recorded/average.hpp"
#include "apps/study/subjects/trial_analysis.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/multiple_testing.hpp"
#include "services/core/statistics/signed_rank.hpp"
#include "services/files/cancellation/control_model_file.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/run_jobs.hpp"

namespace stillhand::study {
namespace {

using experiment::Design;
using session::PlannedTrial;

std::int64_t session_number(const std::string& name) {
  std::int64_t number = 0;
  const auto read = std::from_chars(name.data(), name.data() + name.size(), number);
  if (read.ec != std::errc() || read.ptr != name.data() + name.size()) {
    throw ConfigError("session", name, "the number of a session of an experiment");
  }
  return number;
}

// Body and crossover model as a session of the experiment has them.
session::CoreConfigs configs_of(const Design& design, std::size_t index) {
  session::CoreConfigs configs;
  const auto subject = population::draw_subject({}, static_cast<std::uint64_t>(design.subject_seed),
                                                static_cast<std::int64_t>(index));
  configs.rig.body = subject.body;
  configs.human_operator = subject.who;
  configs.human_operator.arm = population::learnt_feel(configs.rig.body, configs.rig.stick);
  return configs;
}

// The sessions of one participant in one process.
class SimulatedPerson {
 public:
  SimulatedPerson(const Registration& registration, const std::string& code)
      : registration_(registration),
        design_(registration.design),
        index_(experiment::participant_index(code, design_.participants)) {
    protocol_.trial_s = design_.trial_s;
    protocol_.identify_s = design_.identify_s;
    const auto mitigation = std::ranges::find_if(design_.conditions, experiment::is_mitigation);
    if (mitigation != design_.conditions.end()) {
      throw ConfigError("--simulated", "an experiment with " + *mitigation,
                        "A, B, C, C' and C+: a mitigation runs over the bus, or in `stillhand "
                        "study --mitigations`");
    }
    if (design_.control_model == experiment::kDiagnosed) {
      throw ConfigError("--simulated", "an experiment whose C+ each session diagnosed",
                        "C+ of a file, or no C+");
    }
    chooses_models_ = std::ranges::any_of(design_.conditions,
                                          [](const std::string& each) { return each.size() > 1; });
  }

  // Runs a session's pegged and tracking trials in the order of their numbers.
  void run(const std::string& session, const std::vector<std::int64_t>& pegged,
           const std::vector<const RecordedTrial*>& trials, const std::set<TrialId>& used) {
    const std::int64_t number = session_number(session);
    session::InProcessLoop loop(configs_of(design_, index_),
                                experiment::session_seed(design_, index_, number), kKeepEvery);
    auto next = pegged.begin();
    for (const RecordedTrial* trial : trials) {
      for (; next != pegged.end() && *next < trial->number; ++next) identify(loop, number, *next);
      track(loop, *trial, used.contains(id_of(*trial)));
    }
    for (; next != pegged.end(); ++next) identify(loop, number, *next);
  }

  SubjectResult result() {
    SubjectResult out;
    out.identification = std::move(identification_);
    for (const auto& [condition, trials] : trials_) {
      std::vector<const TrackedTrial*> each;
      for (const TrackedTrial& trial : trials) each.push_back(&trial);
      out.trials[condition] = averaged(each);
      out.order.push_back(condition);
    }
    return out;
  }

 private:
  void use(session::InProcessLoop& loop, const auto& model) const {
    require_taken(loop.use_model(model), "a model", "one that the canceller accepts");
  }

  void identify(session::InProcessLoop& loop, std::int64_t session, std::int64_t number) {
    PlannedTrial planned = session::identification_trial(protocol_);
    planned.motion_seed = experiment::identification_seed(design_, index_, session);
    planned.trial.number = number;
    identification_ = identified(loop.run(planned).pegged);
    use(loop, used_model(identification_));
  }

  // As a session chooses it (apps/experiment/session_script.cpp).
  void choose_model(session::InProcessLoop& loop, Condition condition) const {
    if (!chooses_models_ || !cancels(condition)) return;
    if (condition == kCPlus) {
      const std::string file = (registration_.folder / design_.model_file()).string();
      use(loop,
          cancellation::parse_control_model(recording::read_file(file), file, experiment::kRig));
      return;
    }
    auto model = cancellation::control_model(identification_.control.model);
    if (condition == kCPrime) model.adapts = close_the_loop::average_hand();
    use(loop, model);
  }

  void track(session::InProcessLoop& loop, const RecordedTrial& trial, bool used) {
    const experiment::Step seeds = experiment::trial_at_place(design_, index_, trial.step);
    PlannedTrial planned =
        session::tracking_trial(protocol_, planned_as(trial.condition), trial.step);
    planned.motion_seed = seeds.motion_seed;
    planned.reference_seed = seeds.target_seed;
    planned.trial.number = trial.number;
    choose_model(loop, trial.condition);
    TrackedTrial tracked = evaluated(loop.run(planned), planned);
    if (used) trials_[trial.condition].push_back(std::move(tracked));
  }

  const Registration& registration_;
  const Design& design_;
  std::size_t index_;
  session::ProtocolOptions protocol_;
  bool chooses_models_ = false;
  Identification identification_;
  std::map<Condition, std::vector<TrackedTrial>> trials_;
};

SubjectResult simulate_person(const RecordedSource& source, const std::string& code) {
  std::map<std::string, std::vector<std::int64_t>> pegged;
  std::map<std::string, std::vector<const RecordedTrial*>> trials;
  for (const PeggedTrial& each : source.pegged) {
    if (each.participant == code) pegged[each.session].push_back(each.number);
  }
  for (const RecordedTrial& each : source.trials) {
    if (each.participant != code) continue;
    if (each.step == 0) {
      throw ConfigError("trial " + std::to_string(each.number) + " of session " + each.session,
                        "no place in the plan", "a trial that the experiment announced");
    }
    trials[each.session].push_back(&each);
  }
  SimulatedPerson person(source.registered->registration, code);
  for (const auto& [session, own] : trials) {
    if (!pegged.contains(session)) {
      throw ConfigError("session " + session, "no complete pegged trial",
                        "one before its tracking trials");
    }
    person.run(session, pegged[session], own, source.used);
  }
  return person.result();
}

std::optional<statistics::TTest> tested(const std::vector<double>& recorded,
                                        const std::vector<double>& simulated) {
  if (recorded.size() < 2) return std::nullopt;
  try {
    return statistics::paired_t_test(recorded, simulated);
  } catch (const ConfigError&) {
    return std::nullopt;  // the differences have no variance
  }
}

}  // namespace

std::size_t SimulatedSide::more_than_chance() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      paired, [](const PairedCheck& check) { return check.p_holm && *check.p_holm < kAlpha; }));
}

std::vector<PairedCheck> paired_checks(const std::vector<std::string>& participants,
                                       const Analysis& recorded,
                                       const std::vector<std::string>& simulated_participants,
                                       const Analysis& simulated) {
  std::vector<PairedCheck> out;
  std::vector<double> p;
  for (const auto& [condition, metrics] : recorded.conditions) {
    if (!simulated.conditions.contains(condition)) continue;
    for (std::size_t k = 0; k < kMetricCount; ++k) {
      std::vector<double> one;
      std::vector<double> other;
      std::vector<double> differences;
      for (std::size_t i = 0; i < simulated_participants.size(); ++i) {
        const auto at = std::ranges::find(participants, simulated_participants[i]);
        if (at == participants.end()) continue;
        const double real =
            metrics[k].per_subject[static_cast<std::size_t>(at - participants.begin())];
        const double made = simulated.conditions.at(condition)[k].per_subject[i];
        if (!std::isfinite(real + made)) continue;
        one.push_back(real);
        other.push_back(made);
        differences.push_back(real - made);
      }
      PairedCheck check{.condition = condition, .metric = k, .n = differences.size()};
      if (!differences.empty()) {
        check.mean_difference = statistics::mean(differences);
        check.p_signed_rank = statistics::signed_rank_two_sided_p(differences);
        check.test = tested(one, other);
      }
      if (check.test) p.push_back(check.test->p);
      out.push_back(check);
    }
  }
  if (p.empty()) return out;
  const std::vector<double> adjusted = statistics::holm_adjusted(p);
  auto next = adjusted.begin();
  for (PairedCheck& check : out) {
    if (check.test) check.p_holm = *next++;
  }
  return out;
}

SimulatedSide simulate_people(const RecordedSource& source, unsigned threads,
                              const OnProgress& on_progress) {
  const std::vector<std::string>& codes = source.participants;
  std::vector<std::optional<SubjectResult>> results(codes.size());
  std::vector<std::string> failed(codes.size());
  const auto job = [&](std::size_t i) {
    try {
      results[i] = simulate_person(source, codes[i]);
    } catch (const std::exception& error) {
      failed[i] = error.what();
    }
  };
  const auto on_done = [&](std::size_t done) {
    return on_progress(static_cast<std::int64_t>(done), static_cast<std::int64_t>(codes.size()));
  };
  const unsigned count = threads > 0 ? threads : runtime::core_count();
  if (!runtime::run_jobs(codes.size(), count, job, on_done)) throw Interrupted();
  SimulatedSide out;
  out.same_people = true;
  out.seed = static_cast<std::uint64_t>(source.registered->registration.design.subject_seed);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    if (results[i]) {
      out.participants.push_back(codes[i]);
      out.results.push_back(std::move(*results[i]));
    } else {
      out.failed[codes[i]] = failed[i];
    }
  }
  if (!out.results.empty()) out.analysis = analyse(out.results);
  return out;
}

SimulatedSide simulate_population(const StudyOptions& options, const OnProgress& on_progress) {
  SimulatedSide out;
  out.seed = options.seed;
  out.results = run_study(options, on_progress);
  out.analysis = analyse(out.results);
  return out;
}

}  // namespace stillhand::study
