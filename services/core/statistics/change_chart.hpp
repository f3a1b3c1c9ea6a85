// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

namespace stillhand::statistics {

/// Finds a lasting change of the mean of vectors in the plane, one after the other, with neither
/// mean nor covariance known: README Eq. ST-22 to ST-25.
///
/// Each vector is judged by those before it, so a first part without a change is all it needs.
/// Vectors need not be independent: a mean that wanders slowly, with a third of the variance, is no
/// change.  step() neither allocates nor throws.
class ChangeChart {
 public:
  /// As far back as a change is dated.
  static constexpr std::size_t kRemembered = 1024;

  struct Step {
    bool changed = false;  ///< alarm; the chart then begins again
    std::int64_t ago = 0;  ///< with an alarm: vectors since the change, this one included
    Eigen::Vector2d by = Eigen::Vector2d::Zero();  ///< mean since, less that before
  };

  /// @param run_length  mean number of vectors to a false alarm, 90 to 100 000
  explicit ChangeChart(double run_length);

  Step step(const Eigen::Vector2d& x) noexcept;
  /// Begins again.
  void restart() noexcept;

  [[nodiscard]] double threshold() const noexcept { return threshold_; }

 private:
  [[nodiscard]] Eigen::Vector2d judged(const Eigen::Vector2d& x) const noexcept;
  void learn(const Eigen::Vector2d& x) noexcept;
  [[nodiscard]] Step dated() const noexcept;
  [[nodiscard]] const Eigen::Vector2d& past(std::int64_t ago) const noexcept {
    return newest_[static_cast<std::size_t>(count_ - ago) % kRemembered];
  }

  double threshold_;
  std::int64_t count_ = 0;
  std::array<Eigen::Vector2d, kRemembered> newest_{};  ///< at place % size
  Eigen::Vector2d cusum_ = Eigen::Vector2d::Zero();
  std::int64_t learnt_ = 0;
  Eigen::Vector2d mean_ = Eigen::Vector2d::Zero();     ///< of those learnt
  Eigen::Matrix2d scatter_ = Eigen::Matrix2d::Zero();  ///< the same
};

}  // namespace stillhand::statistics
