// SPDX-License-Identifier: Apache-2.0
#include "apps/study/explain/inference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "services/core/contract/expects.hpp"
#include "services/core/signal/random.hpp"
#include "services/core/statistics/distributions.hpp"

namespace stillhand::study {
namespace {

constexpr std::uint64_t kSpreadStream = 0x6578706c;
// Coefficients of variation of a personal cause, equally probable beforehand.
constexpr std::array<double, 5> kSpreads{0.0, 0.2, 0.4, 0.6, 0.8};
constexpr double kFarthestDeviate = 2.5;  // Eq. SU-1
constexpr int kValuesAlone = 25;          // of a parameter's posterior
constexpr int kValuesPaired = 9;
constexpr int kDrawsAlone = 8;  // of a personal parameter, for each subject
constexpr int kDrawsPaired = 4;

// One cause at work: which subjects, which draws of its parameter.
class Acting {
 public:
  Acting(const CauseResponses& cause, const std::vector<Response>& without, int draws,
         std::uint64_t seed)
      : cause_(cause), without_(without) {
    signal::Gaussian deviate(seed, kSpreadStream);
    deviates_.resize(without.size() * static_cast<std::size_t>(draws));
    for (double& z : deviates_) {
      do z = deviate();
      while (std::abs(z) > kFarthestDeviate);
    }
  }

  [[nodiscard]] bool has_parameter() const { return !cause_.cause->grid.empty(); }
  [[nodiscard]] double value(int step, int steps) const {
    if (!has_parameter()) return 1.0;
    const double least = cause_.cause->grid.front();
    return least + (cause_.cause->most - least) * step / (steps - 1.0);
  }
  /// The parameter of a draw, Eq. SU-1.
  [[nodiscard]] double drawn(std::size_t draw, double mean, double cv) const {
    if (!has_parameter() || cv == 0.0) return mean;
    const double log_variance = std::log1p(cv * cv);
    const double value =
        mean * std::exp(std::sqrt(log_variance) * deviates_[draw] - 0.5 * log_variance);
    return std::clamp(value, cause_.cause->grid.front(), cause_.cause->grid.back());
  }
  /// Change of a subject's metrics, linear between the values of the grid.
  [[nodiscard]] Metrics change(std::size_t subject, double value) const {
    Metrics out = metrics_at(cause_, subject, value);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] -= without_[subject].metrics[k];
    return out;
  }
  [[nodiscard]] double none() const { return has_parameter() ? cause_.cause->none : 0.0; }
  [[nodiscard]] const Cause& cause() const { return *cause_.cause; }

 private:
  const CauseResponses& cause_;
  const std::vector<Response>& without_;
  std::vector<double> deviates_;
};

// A point of the parameters' grid, and what the tables say of it.
struct Point {
  std::vector<double> values;
  std::vector<double> spreads;
  double log_likelihood;
};

// Interaction of two causes, per subject, at the values of PairResponses.
struct Interaction {
  std::array<double, 2> at{};
  std::vector<Metrics> beyond;
};

// The subjects of one hypothesis at one point.
std::vector<Metrics> population_at(std::span<const Acting> acting, const Interaction* interaction,
                                   const std::vector<Response>& without, int draws,
                                   const Point& point, std::size_t first, std::size_t step) {
  std::vector<Metrics> out;
  for (std::size_t subject = first; subject < without.size(); subject += step) {
    for (int k = 0; k < draws; ++k) {
      const std::size_t draw =
          subject * static_cast<std::size_t>(draws) + static_cast<std::size_t>(k);
      Metrics metrics = without[subject].metrics;
      double share = 1.0;
      for (std::size_t c = 0; c < acting.size(); ++c) {
        const double value = acting[c].drawn(draw, point.values[c], point.spreads[c]);
        const Metrics change = acting[c].change(subject, value);
        for (std::size_t i = 0; i < metrics.size(); ++i) metrics[i] += change[i];
        if (interaction != nullptr) {
          share *= std::clamp((value - acting[c].none()) / (interaction->at[c] - acting[c].none()),
                              0.0, 1.0);
        }
      }
      if (interaction != nullptr) {
        for (std::size_t i = 0; i < metrics.size(); ++i) {
          metrics[i] += share * interaction->beyond[subject][i];
        }
      }
      out.push_back(metrics);
    }
  }
  return out;
}

std::vector<Point> grid_of(std::span<const Acting> acting, int steps) {
  std::vector<Point> points{{}};
  for (const Acting& one : acting) {
    std::vector<Point> more;
    for (const Point& point : points) {
      for (int step = 0; step < (one.has_parameter() ? steps : 1); ++step) {
        for (const double spread : kSpreads) {
          if (spread > 0.0 && !one.cause().personal) continue;
          Point next = point;
          next.values.push_back(one.value(step, steps));
          next.spreads.push_back(spread);
          more.push_back(next);
        }
      }
    }
    points = std::move(more);
  }
  return points;
}

double log_mean_exp(const std::vector<Point>& points) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Point& point : points) most = std::max(most, point.log_likelihood);
  double sum = 0.0;
  for (const Point& point : points) sum += std::exp(point.log_likelihood - most);
  return most + std::log(sum / static_cast<double>(points.size()));
}

// Quantiles of one coordinate under the posterior weights.
Marginal marginal(const std::vector<Point>& points, double log_evidence, std::string name,
                  const auto& coordinate) {
  std::vector<std::pair<double, double>> weighted;
  weighted.reserve(points.size());
  for (const Point& point : points) {
    weighted.emplace_back(coordinate(point), std::exp(point.log_likelihood - log_evidence) /
                                                 static_cast<double>(points.size()));
  }
  std::ranges::sort(weighted);
  const auto quantile = [&](double probability) {
    double sum = 0.0;
    for (const auto& [value, weight] : weighted) {
      sum += weight;
      if (sum >= probability) return value;
    }
    return weighted.back().first;
  };
  return {std::move(name), quantile(0.5), quantile(0.025), quantile(0.975)};
}

bool is_known(const Metrics& metrics) {
  return std::ranges::all_of(metrics, [](double value) { return std::isfinite(value); });
}

// What a subject's metrics with both causes have beyond the sum of both changes.
Metrics beyond_sum(const Inference& all, const std::vector<Acting>& acting,
                   const PairResponses& pair, std::size_t subject) {
  const Metrics first = acting[0].change(subject, pair.values[0]);
  const Metrics second = acting[1].change(subject, pair.values[1]);
  Metrics out = pair.at[subject].metrics;
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] -= (*all.without)[subject].metrics[k] + first[k] + second[k];
  }
  return out;
}

Metrics mean_of_known(const std::vector<Metrics>& all, std::size_t count) {
  Metrics out{};
  double known = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_known(all[i])) continue;
    known += 1.0;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += all[i][k];
  }
  for (double& value : out) value /= known;
  return out;
}

class Explaining {
 public:
  Explaining(const Inference& all, std::vector<Acting> acting, const Interaction* interaction,
             int steps, int draws)
      : all_(all),
        acting_(std::move(acting)),
        interaction_(interaction),
        draws_(draws),
        points_(grid_of(acting_, steps)) {}

  Hypothesis explained(std::vector<std::size_t> causes) {
    Hypothesis out;
    out.causes = std::move(causes);
    out.halves = {evidence(0, 2), evidence(1, 2)};
    out.log_evidence = evidence(0, 1);
    Point middle;
    for (std::size_t c = 0; c < acting_.size(); ++c) summarise(c, out, middle);
    if (out.name.empty()) out.name = "none";
    const Fit fit = fit_at(middle, 0, 1);
    out.shift.assign(fit.shift.begin(), fit.shift.end());
    out.z = (fit.after - all_.paper.values).cwiseQuotient(all_.paper.standard_error);
    out.fit_p = statistics::chi_squared_above(
        fit.chi_square,
        static_cast<double>(kTableFigures) - static_cast<double>(out.parameters.size()));
    return out;
  }

 private:
  [[nodiscard]] Fit fit_at(const Point& point, std::size_t first, std::size_t step) const {
    const auto subjects =
        population_at(acting_, interaction_, *all_.without, draws_, point, first, step);
    const auto known = static_cast<std::size_t>(std::ranges::count_if(subjects, is_known));
    return fit_tables(predict_tables(subjects, known / static_cast<std::size_t>(draws_)),
                      all_.paper, all_.nuisance);
  }
  double evidence(std::size_t first, std::size_t step) {
    for (Point& point : points_) point.log_likelihood = fit_at(point, first, step).log_likelihood;
    return log_mean_exp(points_);
  }
  void summarise(std::size_t c, Hypothesis& out, Point& middle) const {
    const Cause& cause = acting_[c].cause();
    out.name += (out.name.empty() ? "" : " + ") + cause.name;
    const auto of = [&](const std::string& what, const auto& coordinate) {
      out.parameters.push_back(
          marginal(points_, out.log_evidence, cause.name + "." + what, coordinate));
      return out.parameters.back().median;
    };
    middle.values.push_back(1.0);
    middle.spreads.push_back(0.0);
    if (acting_[c].has_parameter()) {
      middle.values.back() = of(cause.parameter, [c](const Point& p) { return p.values[c]; });
    }
    if (cause.personal) {
      middle.spreads.back() = of("cv [-]", [c](const Point& p) { return p.spreads[c]; });
    }
    out.values.push_back(middle.values.back());
    out.spreads.push_back(middle.spreads.back());
  }

  const Inference& all_;
  std::vector<Acting> acting_;
  const Interaction* interaction_;
  int draws_;
  std::vector<Point> points_;
};

}  // namespace

Metrics metrics_at(const CauseResponses& cause, std::size_t subject, double value) {
  const auto& grid = cause.cause->grid;
  if (grid.empty()) return cause.at.front()[subject].metrics;
  const auto upper =
      std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(grid, value) - grid.begin(), 1,
                                 static_cast<std::ptrdiff_t>(grid.size()) - 1);
  const auto at = static_cast<std::size_t>(upper);
  const double share = (value - grid[at - 1]) / (grid[at] - grid[at - 1]);
  const Metrics& low = cause.at[at - 1][subject].metrics;
  const Metrics& high = cause.at[at][subject].metrics;
  Metrics out{};
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = low[k] + share * (high[k] - low[k]);
  return out;
}

Hypothesis explain_nothing(const Inference& all) {
  return Explaining(all, {}, nullptr, 1, 1).explained({});
}

Hypothesis explain_with(const Inference& all, std::size_t index, const CauseResponses& cause) {
  const int draws = cause.cause->personal ? kDrawsAlone : 1;
  std::vector<Acting> acting{{cause, *all.without, draws, index}};
  return Explaining(all, std::move(acting), nullptr, kValuesAlone, draws).explained({index});
}

Hypothesis explain_with(const Inference& all, const std::array<const CauseResponses*, 2>& causes,
                        const PairResponses& pair) {
  const bool personal = causes[0]->cause->personal || causes[1]->cause->personal;
  const int draws = personal ? kDrawsPaired : 1;
  std::vector<Acting> acting;
  for (std::size_t c = 0; c < 2; ++c) {
    acting.emplace_back(*causes[c], *all.without, draws, pair.causes[c]);
  }
  Interaction interaction{pair.values, {}};
  for (std::size_t subject = 0; subject < all.without->size(); ++subject) {
    // A pair is simulated for some of the subjects; the others take their mean.
    const bool own = subject < pair.at.size();
    interaction.beyond.push_back(own ? beyond_sum(all, acting, pair, subject)
                                     : mean_of_known(interaction.beyond, pair.at.size()));
  }
  return Explaining(all, std::move(acting), &interaction, kValuesPaired, draws)
      .explained({pair.causes[0], pair.causes[1]});
}

std::vector<std::string> indistinguishable(const std::vector<Hypothesis>& among) {
  double best = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& one : among) best = std::max(best, one.log_evidence);
  std::vector<std::string> names;
  for (const Hypothesis& one : among) {
    if (one.log_evidence > best - kTellsApart) names.push_back(one.name);
  }
  return names.size() > 1 ? names : std::vector<std::string>{};
}

}  // namespace stillhand::study
