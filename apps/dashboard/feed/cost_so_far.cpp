// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/feed/cost_so_far.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "services/bus/trial_codec.hpp"
#include "services/core/contract/time_difference.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/messages/sensing/codec.hpp"

namespace stillhand::dashboard {
namespace {

// A received tick outside of these is none: sums with it do not overflow.
bool is_sound(Tick tick) { return tick >= 0 && tick <= Tick{1} << 60; }

}  // namespace

CostSoFar::CostSoFar(const session::AnswerConfigs& configs)
    : configs_(configs), on_time_(configs) {}

// A session has a model for each identification; numbers without end are another program's.
void CostSoFar::keep(std::int32_t number, cancellation::ControlModel model) {
  constexpr std::size_t kMostModels = 256;
  if (models_.size() >= kMostModels && !models_.contains(number)) return;
  models_.insert_or_assign(number, std::move(model));
}

void CostSoFar::take(const stillhand_msgs::FeedthroughModel& model) {
  if (!model.usable() || model.to_position()) return;
  keep(model.model(),
       cancellation::control_model(cancellation::from_idl(model, configs_.cancellation.sampling)));
}

void CostSoFar::take(const stillhand_msgs::AugmentedModel& model) {
  keep(model.model(), cancellation::from_idl(model));
}

void CostSoFar::take(const stillhand_msgs::TrialAssignment& assignment) {
  assigned_trial_ = assignment.trial();
  assigned_cancels_ = assignment.cancellation() && assignment.parts().empty();
}

// A trial that is stopped ends where it was stopped: its motor need not answer any more.
void CostSoFar::take(const stillhand_msgs::TrialControl& control) {
  const Trial trial = runtime::from_idl(control);
  if (!trial.sound()) return;
  if (trial.phase == TrialPhase::kTracking) {
    if (trial.start_tick != trial_.start_tick || trial.number != trial_.number) trial_ = trial;
  } else if (trial_.measures(newest_)) {
    trial_.duration_ticks = newest_ - trial_.start_tick;
    trial_.ramp_ticks = 0;
  }
}

// Another rig, or the dashboard itself stood still for longer than rows are kept.
void CostSoFar::begin_at(Tick tick) {
  on_time_ = session::OnTime(configs_);
  model_ = -1;
  next_ = since_ = tick;
  newest_ = tick - 1;
  late_.reset();
}

CostSoFar::Row& CostSoFar::row_of(Tick tick) {
  Row& row = rows_[static_cast<std::size_t>(tick) % kRows];
  if (row.tick != tick) row = Row{};
  row.tick = tick;
  return row;
}

void CostSoFar::take(const stillhand_msgs::RawSample& raw) {
  const Tick tick = raw.tick();
  if (!is_sound(tick)) return;
  const auto kept = static_cast<Tick>(kRows) - kMargin;
  if (next_ < 0 || tick > newest_ + kept || tick < newest_ - kept) begin_at(tick);
  Row& row = row_of(tick);
  row.raw = sensing::from_idl(raw);
  row.raw_ns = raw.stamp_ns();
  newest_ = std::max(newest_, tick);
  for (; next_ <= newest_ - kMargin; ++next_) {
    const Row& due = rows_[static_cast<std::size_t>(next_) % kRows];
    if (due.tick == next_ && due.raw) judge(due);
  }
}

void CostSoFar::take(const stillhand_msgs::Sensed& sensed, std::int64_t stamp_ns) {
  if (is_sound(sensed.tick()) && sensed.tick() >= next_) row_of(sensed.tick()).sensed_ns = stamp_ns;
}

void CostSoFar::take(const stillhand_msgs::MotorCommand& command, std::int64_t stamp_ns) {
  if (!is_sound(command.tick()) || command.tick() < next_) return;
  Row& row = row_of(command.tick());
  row.command_ns = stamp_ns;
  row.model = command.model();
}

void CostSoFar::take(const stillhand_msgs::RigTruth& truth) {
  if (!is_sound(truth.tick()) || truth.tick() < next_) return;
  row_of(truth.tick()).used = {
      truth.feedthrough_force_n(), truth.motor_force_n(), truth.platform_acceleration_m_s2(),
      is_sound(truth.motor_tick()) ? truth.motor_tick() : Tick{-1}, truth.motor_permitted()};
}

// The model that the canceller runs, from the tick at which it began to.
void CostSoFar::follow(std::int32_t model) {
  const auto found = models_.find(model);
  if (model == model_ || found == models_.end()) return;
  if (on_time_.load_model(found->second)) model_ = model;
}

void CostSoFar::judge(const Row& row) {
  follow(row.model);
  const bool covered = cancels() && trial_.covers(row.tick);
  const double accel_m_s2 =
      row.used ? row.used->accel_m_s2 : std::numeric_limits<double>::quiet_NaN();
  const session::AskedForces asked = on_time_.step(*row.raw, accel_m_s2, covered).forces;
  if (row.used) known_ = std::isfinite(row.used->feedthrough_n);
  if (!covered || !row.used || !known_) return;
  if (row.tick == trial_.start_tick) {
    whole_ = since_ <= trial_.start_tick - trial_.ramp_ticks && model_ >= 0 &&
             on_time_.unsettled_ticks() == 0;
    if (whole_) cost_ = Cost{trial_, {}, {}};
    late_.reset();
  }
  if (!whole_ || !runs() || !trial_.measures(row.tick)) return;
  const session::TickForces forces{row.used->feedthrough_n, row.used->motor_n, asked};
  const session::ForceSums sums = session::sums_of(forces);
  cost_->sums += sums;
  blame(row, forces.motor_n - asked.on_time_n);
  if (late_) cost_->late[static_cast<std::size_t>(*late_)] += sums.lateness;
}

// Who was late pays until the force is back where it would be. If another one is later meanwhile,
// that one pays from then on.
void CostSoFar::blame(const Row& row, double late_n) {
  constexpr double kShown_n = 0.01;
  if (late_ && std::abs(late_n) < kShown_n) late_.reset();
  const Tick allowed = configs_.motor.answers_in_tick() ? 0 : 1;
  const Tick age = row.tick - row.used->motor_tick;
  if (row.used->permitted && age <= allowed) return;
  if (late_ && age < late_by_) return;
  late_ = row.used->permitted ? who(row) : Late::kInterlock;
  late_by_ = age;
}

Late CostSoFar::who(const Row& row) const {
  if (!row.sensed_ns) return Late::kSensing;
  if (!row.command_ns) return Late::kCancellation;
  const double wait_s =
      configs_.motor.answers_in_tick() ? configs_.motor.answer_wait_s : kControlPeriod_s;
  const auto wait_ns = static_cast<std::int64_t>(1e9 * wait_s);
  if (difference_ns(*row.command_ns, row.raw_ns) <= wait_ns) return Late::kRig;
  const bool sensing =
      difference_ns(*row.sensed_ns, row.raw_ns) > difference_ns(*row.command_ns, *row.sensed_ns);
  return sensing ? Late::kSensing : Late::kCancellation;
}

std::string CostSoFar::why_none() const {
  if (!known_) return "nobody knows the feedthrough of a rig of devices";
  if (trial_.number < 0) return "no trial yet";
  if (!cancels()) return "the motor does not cancel in this trial";
  if (newest_ < trial_.start_tick + kMargin) return "the trial has not begun";
  return runs() ? "" : "no model, or the trial began before this page heard it";
}

}  // namespace stillhand::dashboard
