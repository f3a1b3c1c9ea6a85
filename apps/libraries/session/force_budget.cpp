// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/force_budget.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <ranges>

#include "apps/libraries/session/jackknife.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::session {
namespace {

constexpr double kLeast_s = 12.0;
constexpr std::size_t kMean_ticks = 10;  // Eq. SN-10 at 100 Hz
constexpr Eigen::Index kTaps = 100;      // 1 s of motion

/// Sums of a block of the trial.
struct Sums : ForceSums {
  double unexplained = 0.0;  // square of what no filter of the motion explains of the rest

  Sums& operator+=(const Sums& other) {
    ForceSums::operator+=(other);
    unexplained += other.unexplained;
    return *this;
  }
};
using Blocks = std::array<Sums, kJackknifeBlocks>;

/// Every kMean_ticks, weighted by a triangle of twice that width: what is faster than 50 Hz, as the
/// jerk of a platform whose command is late, is no slow motion.
std::vector<double> means_of(const std::vector<double>& fast) {
  constexpr auto kWidth = static_cast<std::ptrdiff_t>(kMean_ticks);
  std::vector<double> slow;
  for (std::size_t n = kMean_ticks; n + kMean_ticks <= fast.size(); n += kMean_ticks) {
    double sum = 0.0;
    for (std::ptrdiff_t k = 1 - kWidth; k < kWidth; ++k) {
      sum += static_cast<double>(kWidth - std::abs(k)) * fast[n + static_cast<std::size_t>(k)];
    }
    slow.push_back(sum / static_cast<double>(kWidth * kWidth));
  }
  return slow;
}

/// What a filter of each channel leaves of a force, Eq. SN-10, as a mean square that the number of
/// its coefficients does not make smaller; of every mean but the first kTaps.
Eigen::VectorXd unexplained(const std::vector<double>& force_n,
                            const std::vector<std::vector<double>>& channels) {
  const std::vector<double> slow_n = means_of(force_n);
  const Eigen::Index rows = static_cast<Eigen::Index>(slow_n.size()) - kTaps;
  const auto columns = static_cast<Eigen::Index>(channels.size()) * kTaps + 1;
  Eigen::MatrixXd a(rows, columns);
  a.col(0).setOnes();
  Eigen::Index column = 1;
  for (const std::vector<double>& fast : channels) {
    const std::vector<double> slow = means_of(fast);
    const Eigen::Map<const Eigen::VectorXd> all(slow.data(),
                                                static_cast<Eigen::Index>(slow.size()));
    for (Eigen::Index tap = 0; tap < kTaps; ++tap) a.col(column++) = all.segment(kTaps - tap, rows);
  }
  const Eigen::Map<const Eigen::VectorXd> whole(slow_n.data(),
                                                static_cast<Eigen::Index>(slow_n.size()));
  const Eigen::VectorXd b = whole.tail(rows);
  const Eigen::MatrixXd squares = a.transpose() * a;
  const Eigen::VectorXd left = b - a * signal::solve_symmetric(squares, a.transpose() * b);
  return left * std::sqrt(static_cast<double>(rows) / static_cast<double>(rows - columns));
}

Blocks blocks_of(const BudgetSignals& signals) {
  const std::size_t size = signals.forces.size();
  std::vector<double> rest_n(size);
  Blocks blocks{};
  const auto block_of = [size](std::size_t n) {
    return std::min(n * kJackknifeBlocks / size, kJackknifeBlocks - 1);
  };
  for (std::size_t n = 0; n < size; ++n) {
    const TickForces& forces = signals.forces[n];
    rest_n[n] = forces.feedthrough_n + forces.asked.noiseless_n;
    blocks[block_of(n)].ForceSums::operator+=(sums_of(forces));
  }
  const Eigen::VectorXd noise_n = unexplained(rest_n, signals.motion);
  const double share = static_cast<double>(size) / static_cast<double>(noise_n.size());
  for (Eigen::Index n = 0; n < noise_n.size(); ++n) {
    const auto tick = static_cast<std::size_t>(n + kTaps + 1) * kMean_ticks;
    blocks[block_of(tick)].unexplained += share * noise_n[n] * noise_n[n];
  }
  return blocks;
}

Sums sum_without(const Blocks& blocks, std::size_t left_out) {
  Sums sum;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (b != left_out) sum += blocks[b];
  }
  return sum;
}

template <typename Of>
ForceEstimate estimate(const Blocks& blocks, Of of) {
  const auto value = [&](std::size_t left_out) {
    const Sums sums = sum_without(blocks, left_out);
    return sums.force_n(of(sums));
  };
  const double force_n = value(blocks.size());
  const double reach_n = jackknife_reach(jackknife_variance(value));
  return {force_n, force_n - reach_n, force_n + reach_n};
}

bool known(const TickForces& forces) {
  return std::isfinite(forces.feedthrough_n + forces.motor_n + forces.asked.on_time_n +
                       forces.asked.unlimited_n + forces.asked.noiseless_n);
}

}  // namespace

ForceSums& ForceSums::operator+=(const ForceSums& other) noexcept {
  ticks += other.ticks;
  left += other.left;
  lateness += other.lateness;
  limits += other.limits;
  sensor += other.sensor;
  rest += other.rest;
  return *this;
}

double ForceSums::force_n(double products) const noexcept {
  return left > 0.0 ? products / std::sqrt(left * ticks) : 0.0;
}

ForceSums sums_of(const TickForces& forces) noexcept {
  const AskedForces& asked = forces.asked;
  const double left_n = forces.feedthrough_n + forces.motor_n;
  return {.ticks = 1.0,
          .left = left_n * left_n,
          .lateness = left_n * (forces.motor_n - asked.on_time_n),
          .limits = left_n * (asked.on_time_n - asked.unlimited_n),
          .sensor = left_n * (asked.unlimited_n - asked.noiseless_n),
          .rest = left_n * (forces.feedthrough_n + asked.noiseless_n)};
}

std::optional<ForceBudget> force_budget(const BudgetSignals& signals) {
  const std::size_t size = signals.forces.size();
  if (static_cast<double>(size) < kLeast_s * kControlRateHz) return std::nullopt;
  if (!std::ranges::all_of(signals.forces, known)) return std::nullopt;
  for (const std::vector<double>& channel : signals.motion) {
    const auto finite = [](double each) { return std::isfinite(each); };
    if (channel.size() != size || !std::ranges::all_of(channel, finite)) return std::nullopt;
  }
  const Blocks blocks = blocks_of(signals);
  return ForceBudget{
      .left = estimate(blocks, [](const Sums& sums) { return sums.left; }),
      .model = estimate(blocks, [](const Sums& sums) { return sums.rest - sums.unexplained; }),
      .lateness = estimate(blocks, [](const Sums& sums) { return sums.lateness; }),
      .limits = estimate(blocks, [](const Sums& sums) { return sums.limits; }),
      .involuntary = estimate(blocks, [](const Sums& sums) { return sums.unexplained; }),
      .sensor = estimate(blocks, [](const Sums& sums) { return sums.sensor; })};
}

}  // namespace stillhand::session
