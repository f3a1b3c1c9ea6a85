// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/campaign.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "apps/study/mitigations/choices.hpp"
#include "apps/study/subjects/study.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/descriptive.hpp"
#include "services/system/process/run_jobs.hpp"

namespace stillhand::study {
namespace {

// Parameters are chosen on people of another seed.
constexpr std::uint64_t kOtherPeople = 7'000'003;
constexpr std::int64_t kMostTutors = 16;
constexpr std::int64_t kLeastTutors = 4;
// A person whom the motion disturbs by less has no share that means anything, as in SU-4.
constexpr double kLeastDisturbed = 0.05;

unsigned threads_of(const CampaignOptions& options) {
  return options.threads > 0 ? options.threads : runtime::core_count();
}

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::vector<CellKey> all_cells(const CampaignOptions& options) {
  std::vector<CellKey> out;
  for (const TrialTask task : options.tasks) {
    for (const TrialMotion motion : options.motions) {
      for (const Condition each : options.mitigations) {
        if (!needs_model(each)) {
          out.push_back({each, ModelOf::kNone, task, motion});
          continue;
        }
        for (const ModelOf of : {ModelOf::kOwn, ModelOf::kAverage, ModelOf::kOther}) {
          out.push_back({each, of, task, motion});
        }
      }
    }
  }
  return out;
}

void check(const CampaignOptions& options) {
  constexpr std::int64_t kMost = 1000;
  if (options.subjects < 2 || options.subjects > kMost) {
    throw ConfigError("--subjects", std::to_string(options.subjects),
                      "2 to 1000 with --mitigations: another's model needs another person");
  }
  session::ProtocolOptions protocol;
  protocol.conditions = {session::Condition::kB};
  protocol.trial_s = options.trial_s;
  protocol.identify_s = options.identify_s;
  session::plan(protocol);  // checks the lengths
}

class Running {
 public:
  Running(const CampaignOptions& options, const OnCampaign& on_stage)
      : options_(options), on_stage_(on_stage), threads_(threads_of(options)) {}

  Campaign run() {
    Campaign out;
    out.options = options_;
    const auto began = std::chrono::steady_clock::now();
    const double processor_before_s = processor_seconds();
    identify();
    out.chosen_on = tutors_.size();
    out.chosen = choose(options_, tutors_, options_.seed + kOtherPeople, threads_, on_stage_);
    run_people(out);
    out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    out.processor_s = processor_seconds() - processor_before_s;
    return out;
  }

 private:
  void jobs(const char* stage, std::size_t count, const std::function<void(std::size_t)>& job) {
    const auto on_done = [&](std::size_t done) {
      return on_stage_(stage, static_cast<double>(done) / static_cast<double>(count));
    };
    if (!runtime::run_jobs(count, threads_, job, on_done)) throw Interrupted();
  }

  Tutor person(std::uint64_t seed, std::size_t at) const {
    const auto index = static_cast<std::int64_t>(at);
    Tutor out;
    out.subject = population::draw_subject(options_.population, seed, index);
    out.models = identify_person(out.subject, options_.identify_s, person_seed(seed, index));
    return out;
  }

  void identify() {
    people_.resize(static_cast<std::size_t>(options_.subjects));
    tutors_.resize(
        static_cast<std::size_t>(std::clamp(options_.subjects / 3, kLeastTutors, kMostTutors)));
    jobs("identifying", people_.size() + tutors_.size(), [&](std::size_t at) {
      if (at < people_.size()) {
        people_[at] = person(options_.seed, at);
      } else {
        const std::size_t i = at - people_.size();
        tutors_[i] = person(options_.seed + kOtherPeople, i);
      }
    });
    std::vector<PersonModels> of_tutors;
    of_tutors.reserve(tutors_.size());
    for (const Tutor& tutor : tutors_) of_tutors.push_back(tutor.models);
    average_ = average_models(of_tutors);
  }

  const PersonModels& models_for(std::size_t person, ModelOf of) const {
    if (of == ModelOf::kAverage) return average_;
    if (of == ModelOf::kOther) return people_[(person + 1) % people_.size()].models;
    return people_[person].models;
  }

  // All trials of one person.
  void run_person(std::size_t at, const std::vector<CellKey>& cells, const Chosen& chosen,
                  std::vector<TrialFigures>& figures, std::vector<double>& still_mm) const {
    const Tutor& person = people_[at];
    const std::uint64_t seed = person_seed(options_.seed, static_cast<std::int64_t>(at));
    const auto feel = population::mean_subject(options_.population).who.arm;
    const cancellation::HandCompliance hand{feel.effective_mass_kg, feel.effective_damping_n_s_m,
                                            feel.effective_stiffness_n_m,
                                            rig::StickConfig{}.lever_m};
    for (const TrialTask task : options_.tasks) {
      const TrialScene still = scene_of(options_, person.subject, seed, task, TrialMotion::kBand);
      still_mm.push_back(run_mitigated(still, {}, false).error_mm);
    }
    std::vector<motion::MotionTrajectory> motions(kTrialMotions.size());
    for (const CellKey& cell : cells) {
      TrialScene scene = scene_of(options_, person.subject, seed, cell.task, cell.motion);
      motion::MotionTrajectory& moves = motions[static_cast<std::size_t>(cell.motion)];
      if (moves.duration_ticks() == 0) {
        moves = trial_motion(cell.motion, scene.duration_ticks, scene.ramp_ticks, scene.rig_seed);
      }
      scene.motion = moves;
      const cancellation::Recipe recipe =
          recipe_of(cell.mitigation, {models_for(at, cell.model), chosen, hand, cell.task});
      figures.push_back(run_mitigated(scene, recipe, row_of(cell.mitigation).arm_rest));
    }
  }

  void run_people(Campaign& out) {
    const std::vector<CellKey> cells = all_cells(options_);
    std::vector<std::vector<TrialFigures>> figures(people_.size());
    std::vector<std::vector<double>> still_mm(people_.size());
    jobs("running", people_.size(),
         [&](std::size_t at) { run_person(at, cells, out.chosen, figures[at], still_mm[at]); });
    out.still_mm.resize(options_.tasks.size());
    for (std::size_t t = 0; t < options_.tasks.size(); ++t) {
      for (const auto& person : still_mm) out.still_mm[t].push_back(person[t]);
    }
    std::vector<double> none_mm;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      std::vector<TrialFigures> people;
      people.reserve(figures.size());
      for (const auto& person : figures) people.push_back(person[c]);
      // "none" is the first of each task and motion.
      if (cells[c].mitigation == kB) {
        none_mm.clear();
        for (const TrialFigures& one : people) none_mm.push_back(one.error_mm);
      }
      const auto task = std::ranges::find(options_.tasks, cells[c].task) - options_.tasks.begin();
      out.cells.push_back(cell_figures(cells[c], std::move(people), none_mm,
                                       out.still_mm[static_cast<std::size_t>(task)]));
    }
  }

  const CampaignOptions& options_;
  const OnCampaign& on_stage_;
  unsigned threads_;
  std::vector<Tutor> people_;
  std::vector<Tutor> tutors_;
  PersonModels average_;
};

}  // namespace

CellFigures cell_figures(const CellKey& key, std::vector<TrialFigures> people,
                         const std::vector<double>& none_mm, const std::vector<double>& still_mm) {
  CellFigures out;
  out.key = key;
  out.people = std::move(people);
  std::vector<double> gained;
  std::vector<double> disturbed;
  std::vector<double> judged;
  const auto count = static_cast<double>(out.people.size());
  for (std::size_t i = 0; i < out.people.size(); ++i) {
    const TrialFigures& one = out.people[i];
    out.error_mm += one.error_mm / count;
    out.motor_n += one.motor_n / count;
    out.effort_n += one.effort_n / count;
    gained.push_back(none_mm[i] - one.error_mm);
    disturbed.push_back(none_mm[i] - still_mm[i]);
    if (one.error_mm > none_mm[i]) ++out.harmed;
    const bool shown = disturbed.back() > kLeastDisturbed * none_mm[i];
    out.restored.push_back(shown ? gained.back() / disturbed.back() : NAN);
    if (!shown) continue;
    judged.push_back(out.restored.back());
    if (!out.worst_person || out.restored[i] < out.restored[*out.worst_person]) {
      out.worst_person = i;
    }
  }
  out.harm = statistics::share_interval(out.harmed, out.people.size());
  out.restored_mean = statistics::ratio_interval(gained, disturbed);
  if (!judged.empty()) out.restored_median = statistics::median_interval(judged);
  return out;
}

Campaign run_campaign(const CampaignOptions& options, const OnCampaign& on_stage) {
  check(options);
  return Running(options, on_stage).run();
}

}  // namespace stillhand::study
