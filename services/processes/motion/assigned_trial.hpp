// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "idl/session.h"
#include "services/bus/service.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/trial.hpp"
#include "services/system/process/handover.hpp"

namespace stillhand::motion {

/// A trial's preparation in a process that moves the platform: once its control and its assignment
/// are there, in either order, what it follows is made in a thread of its own.
/// @tparam Prepared has a member `Trial trial`.
template <typename Prepared>
class AssignedTrial {
 public:
  /// May throw ConfigError: it is reported, the platform stands still and the trial is not armed.
  using Make = typename runtime::Handover<Prepared>::Make;
  using Plan = std::function<Make(const stillhand_msgs::TrialAssignment&, const Trial&)>;

  /// @param announce is called with each trial that is announced: what the platform follows is
  /// over,
  ///                 or begins later.
  AssignedTrial(runtime::Service& service, Plan plan, std::function<void(const Trial&)> announce)
      : service_(service), plan_(std::move(plan)) {
    service.on_trial([this, announce = std::move(announce)](const Trial& trial, const auto&) {
      announce(trial);
      prepare_when_complete();
    });
    service.bus().template subscribe<stillhand_msgs::TrialAssignment>(
        topics::kTrialAssignment, [this](const auto& message, const auto&) {
          assignment_ = message;
          prepare_when_complete();
        });
  }

  /// Control path: what the present trial follows, once it is made and once for each trial.
  Prepared* newly_armed() {
    Prepared* newest = handover_.current();
    if (newest == nullptr || newest->trial.number != service_.trial().number ||
        newest->trial.number == armed_) {
      return nullptr;
    }
    newest->trial = service_.trial();  // it may begin later than it was made for
    armed_ = newest->trial.number;
    service_.note_armed(armed_);
    return newest;
  }

  /// Number of the trial that was armed last; -1 before the first.
  std::int64_t armed() const noexcept { return armed_; }

 private:
  void prepare_when_complete() {
    const Trial trial = service_.trial();
    if (!assignment_ || trial.number < 0 || assignment_->trial() != trial.number ||
        prepared_ == trial.number) {
      return;
    }
    prepared_ = trial.number;
    handover_.prepare([this, make = plan_(*assignment_, trial)]() -> std::unique_ptr<Prepared> {
      try {
        return make();
      } catch (const ConfigError& error) {
        service_.note_event(stillhand_msgs::EVENT_NOTE, error.what());
        return nullptr;
      }
    });
  }

  runtime::Service& service_;
  Plan plan_;
  std::optional<stillhand_msgs::TrialAssignment> assignment_;
  std::int64_t prepared_ = -1;  // number of a trial
  std::int64_t armed_ = -1;
  runtime::Handover<Prepared> handover_;  // last: its thread uses the rest
};

}  // namespace stillhand::motion
