// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "services/core/cancellation/part.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/cancellation/trial_arming.hpp"
#include "services/system/process/handover.hpp"

namespace stillhand::cancellation {

/// Which parts the countermeasure of the process has in a trial, METHOD CC-18: none, those of C, or
/// the parts of the newest assignment, made in a thread of their own and of the session's model of
/// position.
/// All calls come from the thread that receives samples.  None waits for the thread that makes
/// them: queues reach it, and it hands over without a lock.
class TrialParts {
 public:
  /// What an assignment asks for.
  struct Wanted {
    std::vector<Part> parts = {};  ///< none: nothing of its own
    std::int64_t trial = 0;
    std::int64_t assignment = 0;  ///< its number, TrialArming::newest()
  };

  /// @param cancelling  parts of a trial with cancellation: of C, or a perturbation in place of it
  /// @param refused     called in the making thread, with the reason why there are no parts
  TrialParts(const Config& config, const Recipe& cancelling,
             std::function<void(const char*)> refused);

  /// @return false where the making thread is too far behind: the trial stays unarmed
  bool want(const Wanted& wanted);
  /// The model of position.  The wanted parts are made of it again where they need one; they are
  /// taken only before their trial.
  bool offer_position(const signal::DifferenceModel& model);

  /// Before each step of `core`: gives it the parts of the newest assignment, once it has let go of
  /// stick and command.  @return true where it took parts that have become ready
  bool follow(Tick tick, const TrialArming& arming, Countermeasure& core) noexcept;
  /// After `core` took a model of f^, at that tick: parts that need it are in effect with it.
  void note_model(Tick tick, const TrialArming& arming, const Countermeasure& core) noexcept;
  /// True where `core` has the parts of the newest assignment, which may act at this tick.
  bool enables(Tick tick, const TrialArming& arming, const Countermeasure& core) noexcept {
    return core.runs(wanted(arming)) && arming.acts(tick, prepared());
  }
  /// Of the parts that were taken last.
  [[nodiscard]] PreparedParts prepared() const noexcept {
    return running_ == nullptr ? PreparedParts{} : running_->prepared;
  }
  /// Trial whose own parts `core` has, from when they are taken, so that they settle before it,
  /// until another assignment comes and they have faded; 0: none.
  [[nodiscard]] std::int64_t trial_of(const Countermeasure& core) const noexcept {
    return running_ != nullptr && core.runs(running_->parts) ? running_->trial : 0;
  }

 private:
  struct Running {
    PartList parts;
    std::int64_t trial;
    PreparedParts prepared;
  };

  // Of this size at run time: the destructor of Boost 1.74's queue with a compile-time capacity
  // does not destroy what is still in it.
  template <typename T>
  struct Queue : boost::lockfree::spsc_queue<T> {
    Queue() : boost::lockfree::spsc_queue<T>(16) {}
  };

  PartList& wanted(const TrialArming& arming) noexcept;
  bool ask(bool pushed);
  std::unique_ptr<Running> make();
  /// In the making thread: what came since.  @return true where there may be something to make
  bool listen();

  const Config config_;
  const std::function<void(const char*)> refused_;
  PartList nothing_{Recipe{}};
  PartList cancelling_;
  Queue<Wanted> wanted_in_;
  Queue<signal::DifferenceModel> positions_in_;
  Wanted wanted_;                                    ///< the making thread's
  std::optional<signal::DifferenceModel> position_;  ///< the making thread's
  Running* running_ = nullptr;                       ///< the handover owns it
  runtime::Handover<Running> handover_;              // last: its thread ends before the rest
};

}  // namespace stillhand::cancellation
