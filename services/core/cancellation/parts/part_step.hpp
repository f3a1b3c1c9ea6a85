// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "services/core/cancellation/control_model.hpp"
#include "services/core/cancellation/part.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/trial.hpp"

namespace stillhand::cancellation {

/// One tick, as parts see it: sound, and within the range of the sensors.
struct Moment {
  double accel_m_s2;
  double theta_rad;
  double omega_rad_s;
  double predicted_n;  ///< f^
  double motor_n;      ///< of the motor since the tick before
  Tick tick;
  const Trial& trial;
};

/// What a part does in a tick, METHOD Eq. MI-6, in full effect; share and envelope follow.  A part
/// overrides what it does.  One thread.  No call allocates or throws.
class PartStep {
 public:
  virtual ~PartStep() = default;
  [[nodiscard]] virtual std::unique_ptr<PartStep> copy() const = 0;

  /// On the stick [N], + right.
  virtual double force_n(const Moment& /*now*/) noexcept { return 0.0; }
  /// Off the stick's displacement [m].
  virtual double moved_m(const Moment& /*now*/, double /*lever_m*/) noexcept { return 0.0; }
  /// The command behind all that was taken off [rad]; called of a row with `filters_command`.
  virtual double filtered_rad(double theta_rad) noexcept { return theta_rad; }
  /// After the others of the same tick: the stick's displacement [m], and whether all is in full
  /// effect.
  virtual void learn(double /*x_m*/, bool /*learns*/) noexcept {}
  /// What it knows of the stick is old.
  virtual void restart() noexcept {}
};

/// Base of a step: how it is copied.
template <typename Step>
class StepOf : public PartStep {
 public:
  [[nodiscard]] std::unique_ptr<PartStep> copy() const override {
    return std::make_unique<Step>(static_cast<const Step&>(*this));
  }
};

/// Owns a step; a copy goes on on its own.
class OwnedStep {
 public:
  explicit OwnedStep(std::unique_ptr<PartStep> step) : step_(std::move(step)) {}
  ~OwnedStep() = default;
  OwnedStep(const OwnedStep& other) : step_(other.step_->copy()) {}
  OwnedStep(OwnedStep&&) noexcept = default;
  OwnedStep& operator=(const OwnedStep& other) { return *this = OwnedStep(other); }
  OwnedStep& operator=(OwnedStep&&) noexcept = default;

  PartStep* operator->() const noexcept { return step_.get(); }

 private:
  std::unique_ptr<PartStep> step_;
};

/// Names a part in a refusal.
std::string key_of(const Part& part);
/// @throws stillhand::ConfigError for a hand that is nobody's
HandCompliance sound_hand(const Part& part, const HandCompliance& hand);

}  // namespace stillhand::cancellation
