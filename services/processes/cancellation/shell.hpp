// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <memory>
#include <optional>

#include "idl/model.h"
#include "idl/session.h"
#include "services/bus/service.hpp"
#include "services/core/cancellation/model_schedule.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/cancellation/trial_arming.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/processes/cancellation/trial_parts.hpp"
#include "services/system/process/handover.hpp"
#include "services/system/process/interlock.hpp"

namespace stillhand::cancellation {

/// The process of cancellation: one motor command for each sensed sample, in the receiving thread,
/// by one Countermeasure with the parts of the newest trial.  Models are prepared in another thread
/// and taken by the sample that ModelSchedule names.  The receiving thread takes no lock that
/// another thread holds: models and parts go to the threads that prepare them by queues.
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
  /// A sound one, ready to be used.
  struct Ready {
    PreparedModel model;
    std::int32_t number;
    Tick from_tick;
  };

  void on_assignment(const stillhand_msgs::TrialAssignment& message);
  void on_sensed(const stillhand_msgs::Sensed& sensed);
  void on_model(const Received& received);
  /// In the preparing thread: every model that has come since, in order.
  /// @return the newest sound one, or nullptr
  std::unique_ptr<Ready> prepare_received();
  /// Offers a model that has become ready, and hands over the one that is due.
  void follow_models(Tick tick);
  void note_when_armed();
  /// nullptr: it is prepared, or will say so.
  [[nodiscard]] const char* why_not(Readiness readiness) const noexcept;
  static void log(const char* why);
  void note_interlock(const Trial& trial);

  runtime::Service& service_;
  const Config config_;
  Countermeasure core_;
  const bool perturbs_;
  ModelSchedule schedule_;
  TrialArming arming_;
  runtime::Interlock interlock_;
  bool reported_latch_ = false;
  const Ready* ready_ = nullptr;  ///< the newest; the handover owns it
  std::atomic<const char*> why_no_model_{"no model has come"};  ///< a literal
  runtime::Publisher<stillhand_msgs::MotorCommand> command_;
  TrialParts parts_;
  /// Not yet prepared.  One that finds no room is refused.  Its size is set at run time, as that of
  /// those of TrialParts.
  boost::lockfree::spsc_queue<Received> received_{16};
  runtime::Handover<Ready> handover_;  // last: its thread ends before the rest
};

}  // namespace stillhand::cancellation
