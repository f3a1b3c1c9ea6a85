// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "services/cancellation/core/trial_arming.hpp"
#include "services/mitigation/recipe.hpp"
#include "services/runtime/process/handover.hpp"

namespace stillhand::cancellation {

/// The mitigation of a trial, METHOD CC-18: made in a thread of its own, of the newest assignment
/// and of the session's models; run by the thread that receives samples.
/// All calls come from that thread, offer_force() from the one thread that prepares models.  None
/// waits for the thread that makes it: queues reach it, and it hands over without a lock.
class TrialMitigation {
 public:
  /// What an assignment asks for.
  struct Wanted {
    std::vector<mitigation::Part> parts = {};  ///< none: no mitigation
    std::int64_t trial = 0;
    std::int64_t assignment = 0;  ///< its number, TrialArming::newest()
  };
  struct Answer {
    mitigation::MitigationOutput output;
    CancellerInput input;  ///< with what it asked for: enabled while the trial is mitigated
    std::int64_t trial;
  };

  /// @param refused  called in the making thread, with the reason why there is no mitigation
  TrialMitigation(const Config& config, std::function<void(const char*)> refused);

  /// @return false where the making thread is too far behind: the trial stays unarmed
  bool want(const Wanted& wanted);
  /// Models of the force and of the position.  The wanted mitigation is made of them again where it
  /// needs one; it is taken only before its trial.
  bool offer_force(const ControlModel& model);
  bool offer_position(const signal::DifferenceModel& model);

  /// Before each step(): takes a mitigation that has become ready, once the one before has let go
  /// of stick and command.  @return true where it took one
  bool follow(Tick tick, const TrialArming& arming) noexcept;
  /// Of the one that was taken last.
  [[nodiscard]] PreparedMitigation prepared() const noexcept {
    return running_ == nullptr ? PreparedMitigation{} : running_->prepared;
  }
  /// Its newest answer has a force, or takes something off.
  [[nodiscard]] bool acts() const noexcept { return running_ != nullptr && running_->acts; }
  /// From when it is taken, so that it settles before the trial, until another assignment comes and
  /// it has faded.  @return none where no mitigation runs
  std::optional<Answer> step(const CancellerInput& input, const TrialArming& arming) noexcept;

 private:
  struct Running {
    mitigation::Mitigation core;
    std::int64_t trial;
    PreparedMitigation prepared;
    bool acts = false;
  };

  // Of this size at run time: the destructor of Boost 1.74's queue with a compile-time capacity
  // does not destroy what is still in it.
  template <typename T>
  struct Queue : boost::lockfree::spsc_queue<T> {
    Queue() : boost::lockfree::spsc_queue<T>(16) {}
  };

  bool ask(bool pushed);
  std::unique_ptr<Running> make();
  /// In the making thread: what came since.  @return true where there may be something to make
  bool listen();

  const Config config_;
  const std::function<void(const char*)> refused_;
  Queue<Wanted> wanted_in_;
  Queue<ControlModel> forces_in_;
  Queue<signal::DifferenceModel> positions_in_;
  Wanted wanted_;                        ///< the making thread's
  mitigation::SessionModels models_;     ///< the making thread's
  Running* running_ = nullptr;           ///< the handover owns it
  runtime::Handover<Running> handover_;  // last: its thread ends before the rest
};

}  // namespace stillhand::cancellation
