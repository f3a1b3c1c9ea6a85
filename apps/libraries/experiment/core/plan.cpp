// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/experiment/core/plan.hpp"

#include <algorithm>
#include <random>

#include "apps/libraries/experiment/core/seeds.hpp"
#include "services/core/contract/expects.hpp"

namespace stillhand::experiment {
namespace {

constexpr std::uint64_t kPracticeFrom = 100'000;  // beyond every trial's place
constexpr std::uint64_t kForAll = 0;

void set_seeds(Step& step, const Design& design, std::size_t participant, std::uint64_t place) {
  const auto of = [&](std::int64_t seed, SeedUse use, bool same) {
    return derived_seed(static_cast<std::uint64_t>(seed), use, same ? kForAll : participant + 1,
                        place);
  };
  step.motion_seed = of(design.motion_seed, SeedUse::kMotion, design.same_motion_for_all);
  step.target_seed = of(design.target_seed, SeedUse::kTarget, design.same_target_for_all);
}

void add_questions(Plan& plan, const Design& design, Question::After after, std::int64_t block) {
  for (std::size_t i = 0; i < design.questions.size(); ++i) {
    if (design.questions[i].after != after) continue;
    Step step;
    step.kind = StepKind::kQuestion;
    step.block = block;
    step.question = i;
    plan.push_back(step);
  }
}

void add_bare(Plan& plan, StepKind kind, std::int64_t block) {
  Step step;
  step.kind = kind;
  step.block = block;
  plan.push_back(step);
}

}  // namespace

std::vector<std::string> labels_of(std::size_t conditions, const Assignment& assignment,
                                   std::size_t participant) {
  // No letter of a condition, nor of the two identifications.
  constexpr const char* kLabels[]{"X", "Y", "Z", "W", "V", "U", "T", "S", "R",
                                  "Q", "O", "N", "M", "L", "K", "H", "G"};
  STILLHAND_EXPECTS(conditions <= std::size(kLabels));
  std::vector<std::string> labels{kLabels, kLabels + conditions};
  std::mt19937_64 engine(derived_seed(assignment.order_seed, SeedUse::kLabels, participant + 1));
  std::shuffle(labels.begin(), labels.end(), engine);
  return labels;
}

Plan plan_of(const Design& design, const Assignment& assignment, std::size_t participant) {
  Plan plan;
  if (design.practice.most_trials > 0) {
    add_bare(plan, StepKind::kPractice, 0);
    add_questions(plan, design, Question::After::kPractice, 0);
  }
  std::int64_t place = 0;
  for (std::int64_t block = 1; block <= design.blocks; ++block) {
    for (std::int64_t pass = 0; pass < design.trials; ++pass) {
      const auto passes = static_cast<std::size_t>((block - 1) * design.trials + pass);
      for (const std::size_t condition :
           condition_order(design.order, design.conditions.size(), assignment.order_seed,
                           participant, passes)) {
        Step step;
        step.block = block;
        step.place = ++place;
        step.condition = condition;
        set_seeds(step, design, participant, static_cast<std::uint64_t>(place));
        plan.push_back(step);
        add_questions(plan, design, Question::After::kTrial, block);
      }
    }
    add_questions(plan, design, Question::After::kBlock, block);
    if (block < design.blocks) add_bare(plan, StepKind::kBreak, block);
  }
  add_questions(plan, design, Question::After::kEnd, design.blocks);
  return plan;
}

Step trial_at_place(const Design& design, std::size_t participant, std::int64_t place) {
  Step step;
  step.place = place;
  set_seeds(step, design, participant, static_cast<std::uint64_t>(place));
  return step;
}

Step practice_trial(const Design& design, std::size_t participant, std::int64_t number) {
  Step step;
  step.kind = StepKind::kPractice;
  set_seeds(step, design, participant, kPracticeFrom + static_cast<std::uint64_t>(number));
  return step;
}

std::uint64_t session_seed(const Design& design, std::size_t participant, std::int64_t session) {
  return derived_seed(static_cast<std::uint64_t>(design.subject_seed), SeedUse::kSession,
                      participant + 1, static_cast<std::uint64_t>(session));
}

std::uint64_t identification_seed(const Design& design, std::size_t participant,
                                  std::int64_t session) {
  return derived_seed(static_cast<std::uint64_t>(design.motion_seed), SeedUse::kIdentification,
                      participant + 1, static_cast<std::uint64_t>(session));
}

std::int64_t trials_of(const Plan& plan) {
  return std::ranges::count(plan, StepKind::kTrial, &Step::kind);
}

}  // namespace stillhand::experiment
