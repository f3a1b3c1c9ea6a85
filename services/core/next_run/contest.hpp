// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "services/core/diagnosis/model/signals.hpp"
#include "services/core/next_run/candidates.hpp"

namespace stillhand::next_run {

/// By how much the evidence has to exceed chance before a tie counts as broken, Eq. NR-5.
inline constexpr double kStrong = 6.0;          ///< [-] twice a log ratio; Kass and Raftery, 1995
inline constexpr double kStandardErrors = 2.0;  ///< as in the choice of a name, Eq. DG-17

/// Evidence for candidate i (row) against j (column), Eq. NR-2 and NR-4.
struct Evidence {
  Eigen::MatrixXd twice_log_ratio;  ///< [-] positive: i explains more
  Eigen::MatrixXd standard_error;   ///< [-] over blocks of 2 s

  /// Eq. NR-5.
  [[nodiscard]] bool settled(Eigen::Index i, Eigen::Index j) const;
  /// The candidate that beats every other one; -1: none.
  [[nodiscard]] Eigen::Index winner() const;
  /// Those that no other one beats.
  [[nodiscard]] std::vector<Eigen::Index> left() const;
};

/// What a run is expected to add to the evidence, Eq. NR-3: i is true (row), j is fitted to its
/// prediction (column).
struct Expected {
  Eigen::MatrixXd separation;      ///< [-] noncentrality
  Eigen::MatrixXd standard_error;  ///< [-] over blocks of 2 s
  Eigen::VectorXd price;           ///< [-] that each candidate pays for its numbers in the run
};

/// Candidates against each other: what a recording says, what a further run can say, and what it
/// said.  README Eq. NR-2 to NR-6.  Pure; const functions from any thread.
class Contest {
 public:
  /// @param signals  of the recording to which the candidates were fitted
  /// @throws stillhand::ConfigError where the run of one is not finite
  Contest(std::vector<Candidate> candidates, const diagnosis::Signals& signals);

  [[nodiscard]] const std::vector<Candidate>& candidates() const noexcept { return candidates_; }
  /// Of the recording alone.
  [[nodiscard]] const Evidence& before() const noexcept { return before_; }
  /// Those that the recording does not beat, Eq. NR-5: fitted again behind the noise model, some of
  /// the search's fall back.
  [[nodiscard]] std::vector<Candidate> still_tied() const;
  /// [Hz] The band that the recording excites; outside of it no candidate's body is determined,
  /// Eq. DG-65.
  [[nodiscard]] std::pair<double, double> band_hz() const noexcept { return band_hz_; }
  /// [unit of the output] RMS of the noise.
  [[nodiscard]] double noise_rms() const noexcept { return std::sqrt(variance_); }

  /// What candidate i predicts of a run.
  /// @param run  its channels; the output counts for nothing
  [[nodiscard]] std::vector<double> prediction(std::size_t i,
                                               const diagnosis::Measurement& run) const;
  /// @param steps  of the refit; 0: by one linearisation
  [[nodiscard]] Expected expected(const diagnosis::Measurement& run, int steps) const;
  /// [unit of the output] What the second leaves of the first one's prediction, fitted to it as in
  /// Eq. NR-3, behind the noise model.
  [[nodiscard]] Eigen::VectorXd unmatched(std::size_t i, std::size_t j,
                                          const diagnosis::Measurement& run, int steps) const;
  /// By how many deviations such a run is expected to break each tie, i being true.
  [[nodiscard]] Eigen::MatrixXd margin(const Expected& expected) const;
  /// The probability that it does, Eq. NR-6.
  [[nodiscard]] Eigen::MatrixXd chance(const Expected& expected) const;
  /// Eq. NR-7.
  [[nodiscard]] double probability_settled(const Expected& expected) const;

  /// Evidence of the recording and of a run that was made since.
  [[nodiscard]] Evidence with(const diagnosis::Measurement& run) const;

 private:
  struct Refit {
    double cost = 0.0;         // [-] Eq. NR-3; of noise of variance 1
    double known = 0.0;        // [-] the part of it that the recording's knowledge adds
    double price = 0.0;        // [-] of the numbers in the run, Eq. NR-4
    Eigen::VectorXd residual;  // [unit of the output] behind the noise model
  };
  [[nodiscard]] diagnosis::Signals signals_of(const diagnosis::Measurement& run) const;
  // The run with that candidate's prediction as its output, behind the noise model; none: the
  // candidate's run is not finite.
  [[nodiscard]] std::optional<diagnosis::Signals> as_predicted(
      std::size_t i, const diagnosis::Measurement& run) const;
  [[nodiscard]] Refit refitted(std::size_t j, const diagnosis::Signals& run, int steps) const;
  void weigh(const diagnosis::Signals& judged);
  diagnosis::Linearisation fitted(Candidate& candidate, const diagnosis::Signals& judged) const;
  diagnosis::Linearisation cause_fitted(Candidate& candidate,
                                        const diagnosis::Signals& judged) const;
  // Moves the others to where the best one is, where they explain as much there.
  void meet(std::size_t best, const diagnosis::Signals& judged,
            std::vector<diagnosis::Linearisation>& lines);

  std::vector<Candidate> candidates_;
  std::vector<std::string> inputs_;
  std::pair<double, double> band_hz_;
  std::vector<double> taps_;                  // Eq. DG-61
  std::vector<Eigen::MatrixXd> information_;  // of each candidate's numbers, noise of variance 1
  std::vector<Eigen::VectorXd> of_a_sample_;  // of each number by itself, one sample's share
  double variance_ = 1.0;                     // of the whitened noise
  Evidence before_;
};

}  // namespace stillhand::next_run
