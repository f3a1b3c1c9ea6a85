// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/session/core/trial_numbers.hpp"
#include "apps/libraries/session/force_budget.hpp"
#include "apps/libraries/session/in_process.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "services/core/cancellation/parts/adaptive_gain.hpp"
#include "services/core/identification/identifier.hpp"

namespace stillhand::close_the_loop {

/// [Hz] Gain and phase adapt within seconds: ten values a second show their course.
inline constexpr double kWeightRate_hz = 10.0;

/// One trial as it was measured.  Its numbers are those of a tracking trial; forces, share and
/// delay are by the rig's truth.
struct TrialRun : session::TrialNumbers {
  std::string label;        ///< "I", "A", "B", "C", "C'", "C+"
  std::int64_t number = 0;  ///< of the trial in its session
  recording::Recording measured;
  std::vector<cancellation::AdaptiveGain::Pair>
      weights;                                      ///< w_0, w_1 as adapted, at kWeightRate_hz
  std::optional<session::ForceBudget> budget = {};  ///< of a live trial with cancellation
};

/// A session as the loop needs it, in one process or over DDS.
class Session {
 public:
  Session() = default;
  virtual ~Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Runs one trial; the same one may run again.  @param label  its name in the result  @throws
  /// ConfigError, std::runtime_error
  virtual TrialRun run(const session::PlannedTrial& planned, const std::string& label) = 0;
  /// The paper's model of a pegged trial, which the canceller uses from now on.
  /// @throws ConfigError when the trial yields no usable one
  virtual identification::FeedthroughModel identify(const TrialRun& pegged) = 0;
  /// Sets the model that the canceller uses from the next trial on.  @return why it refuses, or
  /// empty
  virtual std::string use(const cancellation::ControlModel& model) = 0;
};

/// RMS error and the rest, from target and cursor.
identification::TrackingMetrics metrics_of(const identification::TrackingRecord& record,
                                           const session::PlannedTrial& planned);
/// The same, as measured.
identification::TrackingMetrics metrics_of(const recording::Recording& measured,
                                           const session::PlannedTrial& planned);

/// The rig and the subject of a session in one process.
struct SimulatedRig {
  session::CoreConfigs configs = {};
  std::uint64_t undeclared_effect = 0;  ///< seed of the effect, sized against the default rig
  rig::EffectSource source = rig::EffectSource::kKinds;
};

/// One trial on a rig of its own, in one process.
/// @param trials  those that the rig runs; the last one is returned
/// @param model   null: none
/// @throws ConfigError when the canceller refuses the model
TrialRun run_alone(const SimulatedRig& rig, std::uint64_t seed,
                   const std::vector<session::PlannedTrial>& trials,
                   const cancellation::ControlModel* model, const std::string& label);

/// All in one process, as fast as the machine allows.
class InProcessSession final : public Session {
 public:
  InProcessSession(const SimulatedRig& rig, std::uint64_t seed);

  TrialRun run(const session::PlannedTrial& planned, const std::string& label) override;
  identification::FeedthroughModel identify(const TrialRun& pegged) override;
  std::string use(const cancellation::ControlModel& model) override;
  /// undeclared_effect.json, once the verdict is out.
  [[nodiscard]] const std::string& open_effect() const noexcept { return sealed_; }
  /// Digest of what open_effect() will give.
  [[nodiscard]] const std::string& commitment() const noexcept { return commitment_; }

 private:
  std::string sealed_;  ///< its text, which nothing here reads
  std::string commitment_;
  session::InProcessLoop loop_;
};

}  // namespace stillhand::close_the_loop
