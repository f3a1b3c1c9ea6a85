// SPDX-License-Identifier: Apache-2.0
#include "apps/study/explain/calibrate.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "apps/study/explain/slopes.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/yaml_text.hpp"

namespace stillhand::study {
namespace {

// Gauss-Newton steps with the slopes of the start; a step that changes no mean by a hundredth ends
// them.
constexpr int kMostSteps = 6;
constexpr double kSettled = 0.01;
// The targets: means of A and of A-B, and deviations of A-B.
constexpr std::array<Eigen::Index, 9> kTargets{0, 1, 2, 3, 4, 5, 9, 10, 11};
using Targets = Eigen::Matrix<double, 9, 1>;

Targets picked(const TableVector& all) {
  Targets out;
  for (std::size_t i = 0; i < kTargets.size(); ++i) {
    out[static_cast<Eigen::Index>(i)] = all[kTargets[i]];
  }
  return out;
}

class Calibrating {
 public:
  Calibrating(const ExplainOptions& options, const OnStage& on_stage)
      : options_(options), on_stage_(on_stage), paper_(paper_tables(options.unit_mm)) {}

  Calibration run() {
    Calibration out;
    out.subjects = options_.subjects;
    out.seed = options_.seed;
    const Nuisance nuisance =
        slopes_of(options_.study, options_.subjects, options_.seed, options_.threads,
                  [&](double share) { return on_stage_("slopes", share); });
    const Eigen::VectorXd prior = nuisance.prior_sd;
    Eigen::VectorXd shift = Eigen::VectorXd::Zero(prior.size());
    for (int n = 0; n <= kMostSteps; ++n) {
      const TableVector off = tables_at(shift, options_.seed, n) - paper_.values;
      const TableVector z = off.cwiseQuotient(paper_.standard_error);
      const double cost = picked(z).squaredNorm() + shift.cwiseQuotient(prior).squaredNorm();
      out.steps.push_back({{shift.begin(), shift.end()}, z, cost});
      if (n == kMostSteps) break;
      const Eigen::VectorXd step = gauss_newton(nuisance, off, shift);
      if (step.cwiseAbs().maxCoeff() < kSettled) break;
      shift += step;
    }
    const auto best = std::ranges::min_element(out.steps, {}, &CalibrationStep::cost);
    out.population = shifted(options_.study.population, best->shift);
    const Eigen::VectorXd chosen = Eigen::Map<const Eigen::VectorXd>(
        best->shift.data(), static_cast<Eigen::Index>(best->shift.size()));
    out.judged_z = (tables_at(chosen, options_.seed + 1, kMostSteps + 1) - paper_.values)
                       .cwiseQuotient(paper_.standard_error);
    return out;
  }

 private:
  TableVector tables_at(const Eigen::VectorXd& shift, std::uint64_t seed, int n) const {
    StudyOptions options = options_.study;
    options.seed = seed;
    options.population = shifted(options.population, {shift.begin(), shift.end()});
    const auto responses =
        run_settings({{"", options}}, options_.subjects, options_.threads,
                     [&](std::int64_t done, std::int64_t all) {
                       return on_stage_(n > kMostSteps ? "judging" : fmt::format("step {}", n),
                                        static_cast<double>(done) / static_cast<double>(all));
                     });
    return predict_tables(metrics_of(responses.front()), options_.subjects).mean;
  }

  // The step to the least of Eq. SU-6, slopes as at the start.
  [[nodiscard]] Eigen::VectorXd gauss_newton(const Nuisance& nuisance, const TableVector& off,
                                             const Eigen::VectorXd& shift) const {
    Eigen::MatrixXd slope(9, shift.size());
    for (std::size_t i = 0; i < kTargets.size(); ++i) {
      slope.row(static_cast<Eigen::Index>(i)) =
          nuisance.slope.row(kTargets[i]) / paper_.standard_error[kTargets[i]];
    }
    const Targets z = picked(off.cwiseQuotient(paper_.standard_error));
    const Eigen::VectorXd weight = nuisance.prior_sd.cwiseAbs2().cwiseInverse();
    Eigen::MatrixXd normal = slope.transpose() * slope;
    normal.diagonal() += weight;
    return normal.ldlt().solve(-(slope.transpose() * z) - weight.cwiseProduct(shift));
  }

  const ExplainOptions& options_;
  const OnStage& on_stage_;
  PaperTables paper_;
};

std::string z_text(const TableVector& z) {
  return fmt::format(
      "A {:5.2f} {:5.2f} {:5.2f}   A-B {:5.2f} {:5.2f} {:5.2f}   SD {:5.2f} {:5.2f} "
      "{:5.2f}",
      z[0], z[1], z[2], z[3], z[4], z[5], z[9], z[10], z[11]);
}

std::vector<std::string> log_of(const Calibration& calibration) {
  std::vector<std::string> lines{
      "RMS error, dwell ratio, f_c: simulated - paper, in the paper's standard errors"};
  for (std::size_t n = 0; n < calibration.steps.size(); ++n) {
    const CalibrationStep& step = calibration.steps[n];
    lines.push_back(fmt::format("step {}: {}   cost {:.2f}", n, z_text(step.z), step.cost));
  }
  lines.push_back(fmt::format("other subjects, seed {}: {}", calibration.seed + 1,
                              z_text(calibration.judged_z)));
  const auto best = std::ranges::min_element(calibration.steps, {}, &CalibrationStep::cost);
  for (std::size_t i = 0; i < best->shift.size(); ++i) {
    lines.push_back(fmt::format("{}: times {:.3f}; prior {:.2f} of its logarithm; {}",
                                calibrated()[i].name, std::exp(best->shift[i]),
                                calibrated()[i].prior_sd, calibrated()[i].source));
  }
  return lines;
}

}  // namespace

Calibration calibrate(const ExplainOptions& options, const OnStage& on_stage) {
  if (options.subjects < 6) {
    throw ConfigError("--subjects", std::to_string(options.subjects), "6 or more with --calibrate");
  }
  check_base(options);
  return Calibrating(options, on_stage).run();
}

std::string population_yaml(const Calibration& calibration, const std::string& command_line) {
  std::string text = fmt::format("# Population calibrated by: {}\n# {} subjects of seed {}\n",
                                 command_line, calibration.subjects, calibration.seed);
  for (const std::string& line : log_of(calibration)) text += "# " + line + "\n";
  return text + "\n" + settings::yaml_text(calibration.population);
}

void print_calibration(const Calibration& calibration) {
  for (const std::string& line : log_of(calibration)) fmt::print("{}\n", line);
}

}  // namespace stillhand::study
