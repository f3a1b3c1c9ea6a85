// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "idl/model.h"
#include "idl/session.h"
#include "services/cancellation/codec.hpp"
#include "services/cancellation/core/canceller.hpp"
#include "services/cancellation/core/model_schedule.hpp"
#include "services/cancellation/core/perturbation.hpp"
#include "services/cancellation/core/trial_arming.hpp"
#include "services/mitigation/recipe.hpp"
#include "services/runtime/process/handover.hpp"
#include "services/runtime/process/interlock.hpp"
#include "services/runtime/service.hpp"

namespace stillhand::cancellation {

/// The canceller's process: one motor command for each sensed sample, in the receiving thread.
/// Models are prepared in another thread and taken by the sample that ModelSchedule names.  A trial
/// with a mitigation of its own is answered by a Mitigation, which is prepared in a thread too, of
/// the session's models; the canceller runs on without its force, so it stays in time.
class Shell {
 public:
  /// @param perturbation  force in place of cancelling; none: it cancels
  Shell(runtime::Service& service, const Config& config,
        std::optional<signal::Multisine> perturbation = {});
  void run() { service_.run(); }

 private:
  /// A model as it came.
  struct Received {
    ControlModel model;
    std::int32_t number;
    Tick from_tick;
  };
  /// A sound one, ready for the canceller.
  struct Ready {
    PreparedModel model;
    std::int32_t number;
    Tick from_tick;
  };

  /// A trial's mitigation.
  struct Mitigated {
    mitigation::Mitigation core;
    std::int64_t trial;
    PreparedMitigation prepared;
    bool acts = false;  ///< the newest answer has a force, or takes something off
  };

  void on_assignment(const stillhand_msgs::TrialAssignment& message);
  void on_sensed(const stillhand_msgs::Sensed& sensed);
  stillhand_msgs::MotorCommand answer(const stillhand_msgs::Sensed& sensed, bool permitted);
  void on_model(Received received);
  /// Prepares the wanted mitigation, where there is one that is concerned: one that needs a model
  /// that has come since could not be made before.
  void prepare_mitigation(bool (*concerned)(const std::vector<mitigation::Part>&));
  std::unique_ptr<Mitigated> make_mitigation();
  /// Takes a mitigation that has become ready, once the one before has let go of the stick.
  void follow_mitigation(Tick tick);
  /// In the preparing thread: every model that has come since, in order.
  /// @return the newest sound one, or nullptr
  std::unique_ptr<Ready> prepare_received();
  /// Offers a model that has become ready, and hands the canceller the one that is due.
  void follow_models(Tick tick);
  void note_when_armed();
  void note_interlock(const Trial& trial);

  runtime::Service& service_;
  const Config config_;
  Canceller core_;
  std::optional<Perturbation> perturbation_;
  ModelSchedule schedule_;
  TrialArming arming_;
  runtime::Interlock interlock_;
  bool reported_latch_ = false;
  const Ready* ready_ = nullptr;  ///< the newest; the handover owns it
  std::atomic<const char*> why_no_model_{"no model has come"};  ///< a literal
  runtime::Publisher<stillhand_msgs::MotorCommand> command_;
  Mitigated* mitigated_ = nullptr;  ///< the newest; the handover owns it
  std::mutex mutex_;
  std::vector<Received> received_;        ///< not yet prepared
  mitigation::SessionModels models_;      ///< sound ones, the newest
  std::vector<mitigation::Part> wanted_;  ///< of the newest assignment
  std::int64_t wanted_trial_ = 0;         ///< 0: it wants no mitigation
  std::int64_t wanted_assignment_ = 0;    ///< its number
  runtime::Handover<Mitigated> mitigations_;
  runtime::Handover<Ready> handover_;  // last: its thread ends before the rest
};

}  // namespace stillhand::cancellation
