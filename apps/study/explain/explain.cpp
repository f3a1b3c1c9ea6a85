// SPDX-License-Identifier: Apache-2.0
#include "apps/study/explain/explain.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "apps/study/explain/slopes.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/expects.hpp"

namespace stillhand::study {
namespace {

// [prior deviations] Farther away the tables are not linear in the calibrated means.
constexpr double kFarthestShift = 2.0;
constexpr std::array<double, 2> kOtherUnits_mm{5.3, 5.8};

class Investigation {
 public:
  Investigation(const ExplainOptions& options, const OnStage& on_stage)
      : options_(options), on_stage_(on_stage) {
    options_.study.seed = options_.seed;
  }

  Explanation run() {
    simulate_causes();
    infer(options_.unit_mm, out_.single, out_.pairs);
    simulate_pairs();
    infer(options_.unit_mm, out_.single, out_.pairs);
    out_.paper = paper_tables(options_.unit_mm);
    for (const double unit_mm : kOtherUnits_mm) out_.units.push_back(with_unit(unit_mm));
    judge();
    return std::move(out_);
  }

 private:
  std::vector<std::vector<Response>> simulate(const std::string& stage,
                                              const std::vector<Setting>& settings,
                                              std::size_t subjects) {
    return run_settings(
        settings, subjects, options_.threads, [&](std::int64_t done, std::int64_t all) {
          return on_stage_(stage, static_cast<double>(done) / static_cast<double>(all));
        });
  }

  void simulate_causes() {
    std::vector<Setting> settings{{"none", options_.study}};
    for (const Cause& cause : causes()) {
      const std::vector<double> values = cause.grid.empty() ? std::vector{1.0} : cause.grid;
      for (const double value : values) {
        if (!cause.grid.empty() && value == cause.none) continue;
        settings.push_back({cause.name, options_.study});
        cause.apply(settings.back().options, value);
      }
    }
    const auto slopes = slope_settings(options_.study);
    settings.insert(settings.end(), slopes.begin(), slopes.end());
    sort_out(simulate("each cause alone", settings, options_.subjects));
  }

  // From the order of simulate_causes().
  void sort_out(std::vector<std::vector<Response>> all) {
    std::size_t next = 0;
    const auto take = [&] { return std::move(all[next++]); };
    without_ = take();
    for (const Cause& cause : causes()) {
      CauseResponses responses{&cause, {}};
      const std::size_t values = std::max<std::size_t>(1, cause.grid.size());
      for (std::size_t i = 0; i < values; ++i) {
        const bool none = !cause.grid.empty() && cause.grid[i] == cause.none;
        responses.at.push_back(none ? without_ : take());
      }
      causes_.push_back(std::move(responses));
    }
    nuisance_ =
        slopes_from({std::make_move_iterator(all.begin() + static_cast<std::ptrdiff_t>(next)),
                     std::make_move_iterator(all.end())});
  }

  void infer(double unit_mm, std::vector<Hypothesis>& single, std::vector<Hypothesis>& pairs) {
    const Inference all{&without_, paper_tables(unit_mm), nuisance_};
    single = {explain_nothing(all)};
    for (std::size_t c = 0; c < causes_.size(); ++c) {
      single.push_back(explain_with(all, c, causes_[c]));
    }
    pairs.clear();
    for (const PairResponses& pair : pairs_) {
      pairs.push_back(
          explain_with(all, {&causes_[pair.causes[0]], &causes_[pair.causes[1]]}, pair));
      if (!on_stage_("pairs: evidence",
                     static_cast<double>(pairs.size()) / static_cast<double>(pairs_.size()))) {
        throw Interrupted();
      }
    }
    std::ranges::stable_sort(pairs, std::ranges::greater{}, &Hypothesis::log_evidence);
    const std::array<double, 2> nothing = single.front().halves;
    for (auto* some : {&single, &pairs}) {
      for (Hypothesis& one : *some) {
        one.log_evidence_error =
            std::abs((one.halves[0] - nothing[0]) - (one.halves[1] - nothing[1])) / 2.0;
      }
    }
  }

  // The value of the grid next to the posterior median at which the cause does something.
  [[nodiscard]] double typical_value(std::size_t c) const {
    const Cause& cause = causes()[c];
    if (cause.grid.empty()) return 1.0;
    const double median = out_.single[1 + c].values.front();
    double nearest = cause.grid.back();
    for (const double value : cause.grid) {
      const bool acts = value != cause.none;
      if (acts && std::abs(value - median) < std::abs(nearest - median)) nearest = value;
    }
    return nearest;
  }

  void simulate_pairs() {
    std::vector<Setting> settings;
    for (std::size_t first = 0; first < causes_.size(); ++first) {
      for (std::size_t second = first + 1; second < causes_.size(); ++second) {
        if (causes()[first].name == "paper_chain" && causes()[second].name == "lateness") continue;
        PairResponses pair{{first, second}, {typical_value(first), typical_value(second)}, {}};
        settings.push_back({"pair", options_.study});
        causes()[first].apply(settings.back().options, pair.values[0]);
        causes()[second].apply(settings.back().options, pair.values[1]);
        pairs_.push_back(std::move(pair));
      }
    }
    auto all = simulate("pairs of causes", settings, (options_.subjects + 1) / 2);
    for (std::size_t i = 0; i < all.size(); ++i) pairs_[i].at = std::move(all[i]);
  }

  UnitSensitivity with_unit(double unit_mm) {
    UnitSensitivity out;
    out.unit_mm = unit_mm;
    std::vector<Hypothesis> single;
    std::vector<Hypothesis> pairs;
    infer(unit_mm, single, pairs);
    const auto best = std::ranges::max_element(single, {}, &Hypothesis::log_evidence);
    out.best_single = best->name;
    out.best_pair = pairs.front().name;
    out.paper_chain = single[1].log_evidence - single[0].log_evidence;
    out.best_pair_gain = pairs.front().log_evidence - single[0].log_evidence;
    return out;
  }

  // Calibrated means of a hypothesis as they are simulated.
  [[nodiscard]] static std::vector<double> bounded_shift(const Hypothesis& hypothesis) {
    std::vector<double> shift = hypothesis.shift;
    for (std::size_t i = 0; i < shift.size(); ++i) {
      const double most = kFarthestShift * calibrated()[i].prior_sd;
      shift[i] = std::clamp(shift[i], -most, most);
    }
    return shift;
  }

  // Of the calibration, over that of none.
  [[nodiscard]] static double log_prior(const Hypothesis& hypothesis) {
    double sum = 0.0;
    const std::vector<double> shift = bounded_shift(hypothesis);
    for (std::size_t i = 0; i < shift.size(); ++i) {
      sum -= 0.5 * std::pow(shift[i] / calibrated()[i].prior_sd, 2);
    }
    return sum;
  }

  [[nodiscard]] StudyOptions options_at(const Hypothesis& hypothesis) const {
    StudyOptions options = options_.study;
    options.seed = options_.seed + 1;
    options.population = shifted(options.population, bounded_shift(hypothesis));
    for (std::size_t c = 0; c < hypothesis.causes.size(); ++c) {
      const Cause& cause = causes()[hypothesis.causes[c]];
      cause.apply(options, hypothesis.values[c]);
      if (cause.personal) cause.spread(options.population, hypothesis.spreads[c]);
    }
    return options;
  }

  // Hypotheses by evidence whose subjects the rig accepts: a poor one may ask for limbs that no
  // person has.
  void add_best(const std::vector<const Hypothesis*>& ranked, std::size_t most,
                std::vector<Setting>& settings) const {
    const std::size_t before = settings.size();
    for (const Hypothesis* one : ranked) {
      if (settings.size() - before == most) return;
      StudyOptions options = options_at(*one);
      if (accepted(options)) settings.push_back({one->name, std::move(options)});
    }
  }

  [[nodiscard]] bool accepted(const StudyOptions& options) const {
    try {
      for (std::size_t i = 0; i < options_.judging_subjects(); ++i) {
        check_subject(options, static_cast<std::int64_t>(i));
      }
      return true;
    } catch (const ConfigError&) {
      return false;
    }
  }

  void judge() {
    const auto ranked = [](const Hypothesis* first, const Hypothesis* end) {
      std::vector<const Hypothesis*> all;
      for (; first != end; ++first) all.push_back(first);
      std::ranges::stable_sort(all, std::ranges::greater{},
                               [](const Hypothesis* one) { return one->log_evidence; });
      return all;
    };
    // Without a free parameter: nothing is calibrated again either.
    std::vector<Setting> settings{{out_.single[0].name, options_.study},
                                  {out_.single[1].name, options_.study}};
    causes()[0].apply(settings[1].options, 1.0);
    for (Setting& setting : settings) setting.options.seed = options_.seed + 1;
    const Hypothesis* const first = out_.single.data();
    const Hypothesis* const pairs = out_.pairs.data();
    add_best(ranked(first + 2, first + out_.single.size()), kJudgedSingles, settings);
    add_best(ranked(pairs, pairs + out_.pairs.size()), kJudgedPairs, settings);
    StudyOptions on_time = options_at(out_.best());
    on_time.canceller = "now";
    on_time.motor = options_.study.motor;
    const bool compensates = accepted(on_time);
    if (compensates) settings.push_back({"compensated", std::move(on_time)});
    auto all = simulate("judging with other subjects", settings, options_.judging_subjects());
    for (std::size_t i = 0; i < all.size(); ++i) {
      out_.judged.push_back(judged_of(settings[i].label, std::move(all[i])));
    }
    for (std::size_t i = 2; i < out_.judged.size(); ++i) {
      if (settings[i].label != "compensated") {
        out_.judged[i].log_score += log_prior(out_.find(settings[i].label));
      }
    }
    if (compensates) {
      out_.compensated = std::move(out_.judged.back());
      out_.judged.pop_back();
    }
  }

  [[nodiscard]] Judged judged_of(const std::string& name, std::vector<Response> subjects) const {
    Judged out;
    out.name = name;
    out.tables = predict_tables(metrics_of(subjects), subjects.size());
    Nuisance none = nuisance_;
    none.slope.setZero();
    out.log_score = fit_tables(out.tables, out_.paper, none).log_likelihood;
    out.z = (out.tables.mean - out_.paper.values).cwiseQuotient(out_.paper.standard_error);
    for (Eigen::Index k = 0; k < 3; ++k) {
      out.restored[static_cast<std::size_t>(k)] = -out.tables.mean[6 + k] / out.tables.mean[3 + k];
    }
    out.subjects = std::move(subjects);
    return out;
  }

  ExplainOptions options_;
  const OnStage& on_stage_;
  Explanation out_;
  std::vector<Response> without_;
  std::vector<CauseResponses> causes_;
  std::vector<PairResponses> pairs_;
  Nuisance nuisance_;
};

}  // namespace

const Hypothesis& Explanation::find(const std::string& name) const {
  for (const auto* some : {&single, &pairs}) {
    const auto found = std::ranges::find(*some, name, &Hypothesis::name);
    if (found != some->end()) return *found;
  }
  STILLHAND_EXPECTS(false);
  return single.front();
}

std::vector<Hypothesis> Explanation::all() const {
  std::vector<Hypothesis> out = single;
  out.insert(out.end(), pairs.begin(), pairs.end());
  return out;
}

const Hypothesis& Explanation::best() const {
  const auto alone = std::ranges::max_element(single, {}, &Hypothesis::log_evidence);
  if (pairs.empty() || alone->log_evidence > pairs.front().log_evidence) return *alone;
  return pairs.front();
}

void check_base(const ExplainOptions& options) {
  session::plan(options.study.protocol);
  for (std::size_t i = 0; i < options.subjects; ++i) {
    check_subject(options.study, static_cast<std::int64_t>(i));
  }
}

Explanation explain_paper(const ExplainOptions& options, const OnStage& on_stage) {
  if (options.subjects < 6) {
    throw ConfigError("--subjects", std::to_string(options.subjects),
                      "6 or more with --explain-paper");
  }
  check_base(options);
  const auto start = std::chrono::steady_clock::now();
  Explanation out;
  if (options.means) out = Investigation(options, on_stage).run();
  out.options = options;
  if (options.spread) out.spread = explain_spread(options, on_stage);
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return out;
}

}  // namespace stillhand::study
