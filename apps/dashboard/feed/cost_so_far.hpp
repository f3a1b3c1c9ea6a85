// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/session/on_time.hpp"
#include "idl/control_loop.h"
#include "idl/model.h"
#include "idl/session.h"
#include "services/core/contract/trial.hpp"

namespace stillhand::dashboard {

/// What keeps an answer from the motor, along the loop.
enum class Late : std::uint8_t { kSensing, kCancellation, kRig, kInterlock };
inline constexpr std::array<const char*, 4> kLateNames{"sensing", "cancellation", "rig",
                                                       "interlock"};

/// A trial's force so far, Eq. DB-7.
struct Cost {
  Trial trial;
  session::ForceSums sums;
  std::array<double, kLateNames.size()> late{};  ///< shares of sums.lateness [N^2], by Late
};

/// What lateness costs a trial with cancellation while it runs, Eq. DB-7: the equation of the
/// session's summary (SN-8, SN-9), from the messages as they come.  A tick is judged kMargin behind
/// the newest one, when all that answers it has come.  One thread; a copy goes on on its own.
class CostSoFar {
 public:
  static constexpr Tick kMargin = 250;

  /// @throws ConfigError as the cores do
  explicit CostSoFar(const session::AnswerConfigs& configs);

  void take(const stillhand_msgs::FeedthroughModel& model);
  void take(const stillhand_msgs::AugmentedModel& model);
  void take(const stillhand_msgs::TrialAssignment& assignment);
  void take(const stillhand_msgs::TrialControl& control);
  void take(const stillhand_msgs::RawSample& raw);
  /// @param stamp_ns  on the rig's clock, as that of the next
  void take(const stillhand_msgs::Sensed& sensed, std::int64_t stamp_ns);
  void take(const stillhand_msgs::MotorCommand& command, std::int64_t stamp_ns);
  void take(const stillhand_msgs::RigTruth& truth);

  /// Of the newest trial with cancellation; none: why_none().
  [[nodiscard]] const std::optional<Cost>& cost() const noexcept { return cost_; }
  /// Why there is no cost of the trial that runs, or empty.
  [[nodiscard]] std::string why_none() const;
  /// The trial of cost() is the newest one.
  [[nodiscard]] bool runs() const noexcept {
    return cost_ && cost_->trial.start_tick == trial_.start_tick;
  }

 private:
  static constexpr std::size_t kRows = 1024;
  struct Row {
    Tick tick = -1;
    std::optional<sensing::DeviceSample> raw;
    std::int64_t raw_ns = 0;
    std::optional<std::int64_t> sensed_ns, command_ns;
    std::int32_t model = -1;
    struct Used {
      double feedthrough_n, motor_n, accel_m_s2;
      Tick motor_tick;
      bool permitted;
    };
    std::optional<Used> used;
  };

  void keep(std::int32_t number, cancellation::ControlModel model);
  Row& row_of(Tick tick);
  void begin_at(Tick tick);
  void judge(const Row& row);
  void follow(std::int32_t model);
  void blame(const Row& row, double late_n);
  [[nodiscard]] Late who(const Row& row) const;
  [[nodiscard]] bool cancels() const noexcept {
    return assigned_trial_ == trial_.number && assigned_cancels_;
  }

  session::AnswerConfigs configs_;
  session::OnTime on_time_;
  std::map<std::int32_t, cancellation::ControlModel> models_;
  std::int32_t model_ = -1;
  std::vector<Row> rows_ = std::vector<Row>(kRows);
  Tick next_ = -1, since_ = 0;  ///< to be judged next; the first that was
  Tick newest_ = -1;
  Trial trial_;
  std::int64_t assigned_trial_ = -1;
  bool assigned_cancels_ = false;
  bool known_ = true;  ///< the feedthrough is: of devices nobody knows it
  bool whole_ = false;
  std::optional<Cost> cost_;
  std::optional<Late> late_;
  Tick late_by_ = 0;  ///< the largest age behind late_
};

}  // namespace stillhand::dashboard
