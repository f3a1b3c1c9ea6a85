// SPDX-License-Identifier: Apache-2.0
#include "apps/study/explain/slopes.hpp"

namespace stillhand::study {
namespace {

// Part of a prior deviation, to each side, by which a slope is found.
constexpr double kStep = 0.5;

}  // namespace

std::vector<Setting> slope_settings(const StudyOptions& study) {
  std::vector<Setting> settings;
  for (std::size_t i = 0; i < calibrated().size(); ++i) {
    for (const double sign : {-1.0, 1.0}) {
      std::vector<double> shift(calibrated().size(), 0.0);
      shift[i] = sign * kStep * calibrated()[i].prior_sd;
      settings.push_back({calibrated()[i].name, study});
      settings.back().options.population = shifted(study.population, shift);
    }
  }
  return settings;
}

Nuisance slopes_from(const std::vector<std::vector<Response>>& responses) {
  Nuisance out;
  const auto count = static_cast<Eigen::Index>(calibrated().size());
  out.slope.resize(kTableFigures, count);
  out.prior_sd.resize(count);
  for (std::size_t i = 0; i < calibrated().size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const auto tables = [&](const std::vector<Response>& subjects) {
      return predict_tables(metrics_of(subjects), subjects.size()).mean;
    };
    const TableVector change = tables(responses[2 * i + 1]) - tables(responses[2 * i]);
    out.prior_sd[column] = calibrated()[i].prior_sd;
    out.slope.col(column) = change / (2.0 * kStep * calibrated()[i].prior_sd);
  }
  return out;
}

Nuisance slopes_of(StudyOptions study, std::size_t subjects, std::uint64_t seed, unsigned threads,
                   const std::function<bool(double share)>& on_progress) {
  study.seed = seed;
  return slopes_from(run_settings(
      slope_settings(study), subjects, threads, [&](std::int64_t done, std::int64_t all) {
        return on_progress(static_cast<double>(done) / static_cast<double>(all));
      }));
}

}  // namespace stillhand::study
