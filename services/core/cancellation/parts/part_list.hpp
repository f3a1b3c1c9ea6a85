// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "services/core/cancellation/control_model_filter.hpp"
#include "services/core/cancellation/parts/adaptive_gain.hpp"
#include "services/core/cancellation/parts/linear_arm.hpp"
#include "services/core/cancellation/parts/part_step.hpp"
#include "services/core/cancellation/parts/perturbation.hpp"
#include "services/core/cancellation/parts/scheduled_force.hpp"

namespace stillhand::cancellation {

/// Takes the motion that a model predicts off the command.
struct SignalConfig {
  signal::DifferenceModel feedthrough_to_position = {};  ///< G at 1 kHz: m per m/s^2
  /// Given: what the motor moves is taken off too, by this arm's compliance.
  std::optional<admittance::ArmValues> moved_by_motor = {};
  admittance::StickValues stick = {};
};

/// Which parts act: {} in B, {force} in C, {force, follow} in C'.
struct Recipe {
  std::optional<ControlModel> model = {};  ///< of f^; none: the session's, Countermeasure::take()
  bool force = false;                      ///< the motor acts against f^
  std::optional<HandCompliance> follow = {};    ///< gain and phase of f^ are followed (CC-10)
  std::optional<ScheduleConfig> schedule = {};  ///< the force of Eq. MI-5
  std::optional<SignalConfig> signal = {};
  std::optional<signal::Multisine> perturbation = {};  ///< [N] as its accel_m_s2, CC-17
  std::vector<Part> parts = {};  ///< those that are made of their values alone: PartRow::make
  double lever_m = 0.10;
};

/// The parts of a countermeasure: what each adds to the force and takes off the command, METHOD
/// Eq. MI-6, before the share and the envelope that all have in common.
/// One thread.  No call but the constructor allocates or throws.
class PartList {
 public:
  /// @throws stillhand::ConfigError when a part's settings or models are refused.
  explicit PartList(const Recipe& recipe);

  /// The motor acts against f^.
  [[nodiscard]] bool acts_against_force() const noexcept { return force_; }
  /// A part needs f^.
  [[nodiscard]] bool needs_force() const noexcept { return needs_force_; }

  /// What follows gain and phase, as at its start; none: as the model says.
  [[nodiscard]] const std::optional<AdaptiveGain>& follow() const noexcept { return follow_; }

  /// Of all parts but the force, in full effect [N].
  double forces(const Moment& now) noexcept;
  /// What is to be taken off the stick's angle in full effect [rad], a filter included.
  double off(const Moment& now) noexcept;
  /// After both of the same tick.  @param learns  all is in full effect
  void learn(double theta_rad, bool learns) noexcept;
  /// What they know of the stick is old.
  void restart() noexcept {
    for (const OwnedStep& step : steps_) step->restart();
  }

  /// w of Eq. MI-5; 0 without a schedule.
  [[nodiscard]] double schedule_weight() const noexcept {
    return schedule_ ? schedule_->weight() : 0.0;
  }
  /// From the first step until the model of position has settled [ticks], CC-4; 0 without one.  The
  /// arms of MI-5 and the lag of CC-5 are not counted.
  [[nodiscard]] std::int64_t settle_ticks() const noexcept { return settle_ticks_; }

 private:
  void add(const Part& part);
  /// Off the stick's displacement [m].
  double moved(const Moment& now) noexcept;

  bool force_;
  bool needs_force_;
  double lever_m_;
  std::optional<AdaptiveGain> follow_;
  std::optional<Perturbation> perturbation_;
  std::optional<ScheduledForce> schedule_;
  std::optional<ControlModelFilter> signal_;
  std::optional<LinearArm> moved_by_motor_;
  std::vector<OwnedStep> steps_;       ///< in the order of kPartRows
  std::optional<std::size_t> filter_;  ///< which of them filters the command
  std::int64_t settle_ticks_ = 0;
};

}  // namespace stillhand::cancellation
