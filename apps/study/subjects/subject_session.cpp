// SPDX-License-Identifier: Apache-2.0
#include "apps/study/subjects/subject_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "apps/study/subjects/trial_analysis.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/expects.hpp"
#include "services/files/settings/yaml_text.hpp"

namespace stillhand::study {
namespace {

using session::PlannedTrial;

std::uint64_t subject_seed(std::uint64_t seed, std::int64_t index) {
  std::seed_seq mix{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                    std::uint32_t{0x53756271}, static_cast<std::uint32_t>(index)};
  std::array<std::uint32_t, 2> words{};
  mix.generate(words.begin(), words.end());
  return std::uint64_t{words[1]} << 32 | words[0];
}

std::vector<PlannedTrial> plan_of(const StudyOptions& options, std::int64_t index) {
  session::ProtocolOptions protocol = options.protocol;
  protocol.seed = subject_seed(options.seed, index);
  std::vector<PlannedTrial> trials = session::plan(protocol);
  if (!options.personal || options.personal->visit == 0) return trials;
  protocol.seed = session::repeat_seed(protocol.seed, options.personal->visit);
  std::vector<PlannedTrial> again = session::plan(protocol);
  std::ranges::copy(again.begin() + 1, again.end(), trials.begin() + 1);
  return trials;
}

// Settings of every core for this subject under a condition.
session::CoreConfigs configs_of(const StudyOptions& options, const population::Subject& subject,
                                Condition condition) {
  session::CoreConfigs configs;
  configs.rig.body = subject.body;
  configs.rig.motor = options.motor;
  configs.human_operator = subject.who;
  configs.cancellation.sampling = cancellation::sampling_named(options.canceller);
  if (condition == kE) configs.rig.stick.viscous_damping_n_s_m += options.damped_stick_n_s_m;
  if (row_of(condition).arm_rest) {
    configs.rig.body.arm_rest_stiffness_n_m = options.arm_rest_stiffness_n_m;
    configs.rig.body.arm_rest_damping_n_s_m = options.arm_rest_damping_n_s_m;
  }
  // Each subject practised with the stick as it is in the trial (paper III-C).
  configs.human_operator.arm = population::learnt_feel(configs.rig.body, configs.rig.stick);
  // The command filter uses an average person's arm.
  const human_operator::ArmFeel average = population::mean_subject(options.population).who.arm;
  configs.command_filter.mass_kg = average.effective_mass_kg;
  configs.command_filter.damping_n_s_m = average.effective_damping_n_s_m;
  configs.command_filter.stiffness_n_m = average.effective_stiffness_n_m;
  return configs;
}

// Without this check, condition C would run without a motor if the canceller refuses the model.
void use(session::InProcessLoop& loop, const identification::FeedthroughModel& model) {
  require_taken(loop.use_model(model), "identification.model",
                "a model that the canceller accepts; a longer --identify-seconds helps");
}

// E and F change the stick or the body, so they need their own rig.
bool own_rig(Condition condition) { return condition == kE || row_of(condition).arm_rest; }

}  // namespace

identification::FeedthroughModel used_model(const Identification& identification) {
  identification::FeedthroughModel model;
  model.fit = identification.fit;
  model.control = identification.control.model;
  return model;
}

bool is_calibrated(const StudyOptions& options) {
  return settings::yaml_text(options.population) == settings::yaml_text(population::Population{}) &&
         options.protocol.trial_s == 180.0 && options.protocol.identify_s == 120.0;
}

rig::SealedEffect sealed_effect(const StudyOptions& options) {
  rig::RigConfig rig;
  rig.body = population::mean_subject(options.population).body;
  return {options.undeclared_effect, rig};
}

void check_subject(const StudyOptions& options, std::int64_t index) {
  const population::Subject subject =
      population::draw_subject(options.population, options.seed, index);
  try {
    for (const auto condition : options.protocol.conditions) {
      const auto configs = configs_of(options, subject, condition);
      const session::InProcessLoop loop(configs, 0);
    }
  } catch (const ConfigError& error) {
    throw ConfigError("population",
                      fmt::format("subject {} of it with {}", index + 1, error.what()),
                      "means closer to the defaults or smaller spreads");
  }
}

SubjectResult run_subject(const StudyOptions& options, std::int64_t index) {
  SubjectResult result;
  result.subject = population::draw_subject(options.population, options.seed, index);
  const std::vector<PlannedTrial> trials = plan_of(options, index);
  const std::uint64_t seed = subject_seed(options.seed, index);
  session::InProcessLoop shared(configs_of(options, result.subject, kA), seed, kKeepEvery,
                                sealed_effect(options));
  std::optional<PersonalTrials> personal;
  if (options.personal) personal.emplace(*options.personal, options.seed, index);
  for (const PlannedTrial& planned : trials) {
    const bool pegged = planned.trial.phase == TrialPhase::kPegged;
    const Condition condition = pegged ? kA : planned.label;
    std::optional<session::InProcessLoop> own;
    if (personal || own_rig(condition)) {
      session::CoreConfigs configs = configs_of(options, result.subject, condition);
      if (personal) personal->change(planned, configs);
      own.emplace(configs, personal ? personal->loop_seed(planned, seed) : seed, kKeepEvery,
                  sealed_effect(options));
      if (planned.cancellation) use(*own, used_model(result.identification));
    }
    const session::TrialSignals signals = (own ? *own : shared).run(planned);
    if (pegged) {
      result.identification = identified(signals.pegged);
      use(shared, used_model(result.identification));
      continue;
    }
    result.order.push_back(condition);
    result.trials[condition] = evaluated(signals, planned);
  }
  return result;
}

TrackedTrial run_with_model(const StudyOptions& options, const SubjectResult& result,
                            std::int64_t index, const identification::FeedthroughModel& model) {
  session::InProcessLoop loop(configs_of(options, result.subject, kC),
                              subject_seed(options.seed, index), kKeepEvery,
                              sealed_effect(options));
  use(loop, model);
  const std::vector<PlannedTrial> trials = plan_of(options, index);
  const auto planned = std::find_if(trials.begin(), trials.end(),
                                    [](const PlannedTrial& t) { return t.label == kC; });
  STILLHAND_EXPECTS(planned != trials.end());
  return evaluated(loop.run(*planned), *planned);
}

}  // namespace stillhand::study
