// SPDX-License-Identifier: Apache-2.0
#include "apps/study/explain/spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "services/core/contract/expects.hpp"
#include "services/core/signal/moments.hpp"
#include "services/core/statistics/descriptive.hpp"

namespace stillhand::study {
namespace {

constexpr int kSteps = 8;  // of a parameter, from no cause to the end of its range
constexpr int kResamples = 400;
constexpr std::size_t kMostCombined = 3;
// Normal deviates of a two-sided level of 0.05 and of a power of 0.8.
constexpr double kLevelAndPower = 1.959964 + 0.841621;

std::vector<double> column(const std::vector<Metrics>& subjects, std::size_t from, std::size_t to) {
  std::vector<double> out;
  for (const Metrics& one : subjects) {
    const double value = one[to] - one[from];
    if (std::isfinite(value)) out.push_back(value);
  }
  return out;
}

double share_given(const Deviations& with, const Deviations& chain, const Deviations& paper) {
  double sum = 0.0;
  for (std::size_t k = 3; k < 6; ++k) {
    const double missing = paper[k] - chain[k];
    if (missing > 0.0) sum += std::min(1.0, (with[k] - chain[k]) / missing);
  }
  return sum / 3.0;
}

// 95 % of people drawn from these again.
std::array<double, 2> given_interval(const std::vector<Metrics>& with,
                                     const std::vector<Metrics>& chain, const Deviations& paper) {
  std::mt19937_64 engine(1);
  std::uniform_int_distribution<std::size_t> any(0, with.size() - 1);
  std::vector<double> shares;
  for (int n = 0; n < kResamples; ++n) {
    std::vector<Metrics> one;
    std::vector<Metrics> without;
    for (std::size_t i = 0; i < with.size(); ++i) {
      const std::size_t drawn = any(engine);
      one.push_back(with[drawn]);
      without.push_back(chain[drawn]);
    }
    shares.push_back(share_given(deviations_of(one), deviations_of(without), paper));
  }
  return {statistics::quantile(shares, 0.025), statistics::quantile(shares, 0.975)};
}

// Eq. SU-24: the means of B - C stay at the paper's, those of A and A - B where they were
// calibrated to.
bool means_hold(const TableVector& z, const TableVector& z_alone) {
  for (Eigen::Index i = 0; i < kTableMeans; ++i) {
    const double off = i < 6 ? std::abs(z[i] - z_alone[i]) : std::abs(z[i]);
    const double most = i < 6 ? 1.0 : std::max(1.0, std::abs(z_alone[i]));
    if (off > most) return false;
  }
  return true;
}

class Ranking {
 public:
  Ranking(const SpreadResponses& responses, const PaperTables& paper)
      : responses_(responses), paper_(paper), chain_(metrics_of(responses.chain)) {}

  Spread run() {
    Spread out;
    out.subjects = chain_.size();
    out.paper = paper_deviations(paper_);
    out.chain = fit({}, true);
    for (std::size_t c = 0; c < responses_.causes.size(); ++c) {
      out.ends.push_back(fit({{c, responses_.causes[c].cause->most}}, true));
      out.ranked.push_back(best_of(c));
    }
    const auto better = [](const SpreadFit& a, const SpreadFit& b) { return a.given > b.given; };
    std::ranges::stable_sort(out.ranked, better);
    SpreadFit best = out.chain;
    combine({}, 0, best);
    out.combination = fit(best.causes, true);
    return out;
  }

 private:
  // Every subject with the causes, their changes added up, Eq. SU-8.
  [[nodiscard]] std::vector<Metrics> with(const std::vector<AtValue>& causes) const {
    std::vector<Metrics> out = chain_;
    for (const auto& [c, value] : causes) {
      for (std::size_t i = 0; i < out.size(); ++i) {
        const Metrics at = metrics_at(responses_.causes[c], i, value);
        for (std::size_t k = 0; k < at.size(); ++k) out[i][k] += at[k] - chain_[i][k];
      }
    }
    return out;
  }

  [[nodiscard]] SpreadFit fit(const std::vector<AtValue>& causes, bool with_interval) const {
    const std::vector<Metrics> subjects = with(causes);
    SpreadFit out = fit_spread(subjects, chain_, paper_);
    out.causes = causes;
    for (const auto& [c, value] : causes) {
      out.name += (out.name.empty() ? "" : " + ") + responses_.causes[c].cause->name;
    }
    if (causes.empty()) out.name = "paper_chain";
    if (with_interval) {
      const auto interval = given_interval(subjects, chain_, paper_deviations(paper_));
      out.low = interval[0];
      out.high = interval[1];
    }
    return out;
  }

  // Steps of the whole grid: a cause may lie on both sides of none.
  [[nodiscard]] double value(std::size_t c, int step, int steps) const {
    const auto& grid = responses_.causes[c].cause->grid;
    return grid.front() + (grid.back() - grid.front()) * step / steps;
  }

  [[nodiscard]] SpreadFit best_of(std::size_t c) const {
    SpreadFit best = fit({{c, responses_.causes[c].cause->none}}, false);
    for (int step = 0; step <= kSteps; ++step) {
      SpreadFit one = fit({{c, value(c, step, kSteps)}}, false);
      if (one.holds && one.given > best.given) best = std::move(one);
    }
    return fit(best.causes, true);
  }

  // Of all combinations of `kMostCombined` whose means hold the one with the largest likelihood.
  void combine(const std::vector<AtValue>& causes, std::size_t first, SpreadFit& best) const {
    if (!causes.empty()) {
      SpreadFit one = fit(causes, false);
      if (one.holds && one.log_likelihood > best.log_likelihood) best = std::move(one);
    }
    if (causes.size() == kMostCombined) return;
    for (std::size_t c = first; c < responses_.causes.size(); ++c) {
      for (int step = 0; step <= 2; ++step) {
        const double at = value(c, step, 2);
        if (at == responses_.causes[c].cause->none) continue;
        std::vector<AtValue> more = causes;
        more.emplace_back(c, at);
        combine(more, c + 1, best);
      }
    }
  }

  const SpreadResponses& responses_;
  const PaperTables& paper_;
  std::vector<Metrics> chain_;
};

}  // namespace

Deviations deviations_of(const std::vector<Metrics>& subjects) {
  Deviations out{};
  for (std::size_t k = 0; k < 6; ++k) {
    out[k] = statistics::standard_deviation(column(subjects, k, k + 3));
  }
  return out;
}

Deviations paper_deviations(const PaperTables& paper) {
  Deviations out{};
  for (std::size_t k = 0; k < 6; ++k) {
    out[k] = std::exp(paper.values[kTableMeans + static_cast<Eigen::Index>(k)]);
  }
  return out;
}

SpreadFit fit_spread(const std::vector<Metrics>& subjects, const std::vector<Metrics>& chain,
                     const PaperTables& paper) {
  SpreadFit out;
  const Prediction tables = predict_tables(subjects, subjects.size());
  const auto z_of = [&](const TableVector& mean) -> TableVector {
    return (mean - paper.values).cwiseQuotient(paper.standard_error);
  };
  out.z = z_of(tables.mean);
  out.holds = means_hold(out.z, z_of(predict_tables(chain, chain.size()).mean));
  for (Eigen::Index k = 0; k < 3; ++k) {
    // Table vector: A, B - A, C - B.
    const TableVector off = tables.mean - paper.values;
    out.z_of_c[static_cast<std::size_t>(k)] =
        (off[k] + off[3 + k] + off[6 + k]) / paper.standard_error[6 + k];
  }
  const Deviations own = deviations_of(subjects);
  const Deviations theirs = paper_deviations(paper);
  for (std::size_t k = 0; k < 6; ++k) out.over_paper[k] = own[k] / theirs[k];
  out.given = share_given(own, deviations_of(chain), theirs);
  const Nuisance nothing{Eigen::MatrixXd::Zero(kTableFigures, 1), Eigen::VectorXd::Ones(1)};
  out.log_likelihood = fit_tables(tables, paper, nothing).log_likelihood;
  return out;
}

SignatureValues signatures_of(const std::vector<Response>& first,
                              const std::vector<Response>& second) {
  std::vector<double> gain, again, f_c, f_c_again, cancelled, place, log_force, delay, b, c;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Metrics& one = first[i].metrics;
    const Metrics& two = second[i].metrics;
    const Observed& seen = first[i].observed;
    if (!std::isfinite(one[5] + one[8] + two[5] + two[8])) continue;
    b.push_back(one[3]);
    c.push_back(one[6]);
    gain.push_back(one[3] - one[6]);
    again.push_back(two[3] - two[6]);
    f_c.push_back(one[8] - one[5]);
    f_c_again.push_back(two[8] - two[5]);
    cancelled.push_back(seen.cancelled_share);
    place.push_back(seen.c_after_b);
    log_force.push_back(std::log(seen.motor_over_feedthrough));
    delay.push_back(1000.0 * seen.counterforce_delay_s);
  }
  using statistics::standard_deviation;
  return {signal::correlation(gain, again),
          signal::correlation(f_c, f_c_again),
          signal::correlation(gain, cancelled),
          signal::correlation(f_c, place),
          signal::correlation(c, b),
          standard_deviation(log_force),
          standard_deviation(delay),
          standard_deviation(c) / standard_deviation(b)};
}

double people_needed(std::size_t signature, double value, double other) {
  if (kSignatures.at(signature).correlation) {
    return 3.0 + std::pow(kLevelAndPower / (std::atanh(value) - std::atanh(other)), 2);
  }
  return 1.0 + 0.5 * std::pow(kLevelAndPower / std::log(value / other), 2);
}

std::pair<std::size_t, double> tells_apart(const SignatureValues& one,
                                           const SignatureValues& other) {
  std::pair<std::size_t, double> best{0, std::numeric_limits<double>::infinity()};
  for (std::size_t s = 0; s < one.size(); ++s) {
    const double needed = people_needed(s, one[s], other[s]);
    if (needed < best.second) best = {s, needed};
  }
  return best;
}

Spread rank_spread(const SpreadResponses& responses, const PaperTables& paper) {
  return Ranking(responses, paper).run();
}

}  // namespace stillhand::study
