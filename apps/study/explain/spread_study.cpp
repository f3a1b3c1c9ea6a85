// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "apps/study/explain/explain.hpp"
#include "services/core/statistics/distributions.hpp"

namespace stillhand::study {
namespace {

// The best causes that a laboratory would want to tell apart.
constexpr std::size_t kJudgedCauses = 6;

class SpreadStudy {
 public:
  SpreadStudy(const ExplainOptions& options, const OnStage& on_stage)
      : options_(options), on_stage_(on_stage), paper_(paper_tables(options.unit_mm)) {}

  Spread run() {
    SpreadResponses responses = simulate_causes();
    Spread out = rank_spread(responses, paper_);
    out.seed = options_.seed;
    out.judged_seed = options_.seed + 2;
    judge(out);
    return out;
  }

 private:
  [[nodiscard]] StudyOptions chain(std::uint64_t seed) const {
    StudyOptions out = options_.study;
    out.seed = seed;
    out.canceller = "paper";
    out.personal.emplace();
    return out;
  }

  std::vector<std::vector<Response>> simulate(const std::string& stage,
                                              const std::vector<Setting>& settings) {
    return run_settings(settings, options_.judging_subjects(), options_.threads,
                        [&](std::int64_t done, std::int64_t all) {
                          return on_stage_(stage,
                                           static_cast<double>(done) / static_cast<double>(all));
                        });
  }

  SpreadResponses simulate_causes() {
    std::vector<Setting> settings{{"paper_chain", chain(options_.seed)}};
    for (const Cause& cause : spread_causes()) {
      for (const double value : cause.grid) {
        if (value == cause.none) continue;
        settings.push_back({cause.name, chain(options_.seed)});
        cause.apply(settings.back().options, value);
      }
    }
    const auto all = simulate("causes of spread", settings);
    SpreadResponses out{all.front(), {}};
    std::size_t next = 1;
    for (const Cause& cause : spread_causes()) {
      out.causes.push_back({&cause, {}});
      for (const double value : cause.grid) {
        out.causes.back().at.push_back(value == cause.none ? all.front() : all[next++]);
      }
    }
    return out;
  }

  // Twice each: a second visit repeats the tracking trials.
  void judge(Spread& out) {
    std::vector<const SpreadFit*> fits{&out.chain, &out.combination};
    for (const SpreadFit& one : out.ranked) {
      if (fits.size() < 2 + kJudgedCauses && one.given > 0.0) fits.push_back(&one);
    }
    std::vector<Setting> settings;
    for (const SpreadFit* fit : fits) {
      for (const std::uint64_t visit : {0, 1}) {
        Setting one{fit->name, chain(out.judged_seed)};
        for (const auto& [c, value] : fit->causes) spread_causes()[c].apply(one.options, value);
        one.options.personal->visit = visit;
        settings.push_back(std::move(one));
      }
    }
    const auto all = simulate("judging the spread with other subjects", settings);
    const std::vector<Metrics> chain_alone = metrics_of(all.front());
    for (std::size_t i = 0; i < fits.size(); ++i) {
      SpreadJudged one{fit_spread(metrics_of(all[2 * i]), chain_alone, paper_),
                       {},
                       signatures_of(all[2 * i], all[2 * i + 1])};
      one.fit.name = fits[i]->name;
      one.fit.causes = fits[i]->causes;
      for (std::size_t k = 0; k < 6; ++k) one.ratio_ci95[k] = interval(one.fit.over_paper[k]);
      out.judged.push_back(std::move(one));
    }
  }

  // Of the ratio of two deviations, ours of `judging_subjects` and the paper's of twelve.
  [[nodiscard]] std::array<double, 2> interval(double ratio) const {
    const auto end = [&](double p) {
      return ratio /
             std::sqrt(statistics::f_quantile(
                 p, static_cast<double>(options_.judging_subjects()) - 1.0, kPaperSubjects - 1.0));
    };
    return {end(0.975), end(0.025)};
  }

  const ExplainOptions& options_;
  const OnStage& on_stage_;
  PaperTables paper_;
};

}  // namespace

Spread explain_spread(const ExplainOptions& options, const OnStage& on_stage) {
  return SpreadStudy(options, on_stage).run();
}

}  // namespace stillhand::study
