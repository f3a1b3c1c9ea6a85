// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "services/core/device_rig/platform_exchange.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/core/rig/parts/platform.hpp"
#include "services/devices/device_rig/plant_limits.hpp"
#include "services/devices/device_rig/platform_drive.hpp"
#include "services/system/process/platform_permission.hpp"
#include "tests/emulators/moog_emulator.hpp"
#include "tests/emulators/platform_emulator.hpp"

namespace stillhand::device_rig {

/// A platform, its packets, and all that decides about its set-points, in simulated time: no
/// thread, socket or clock.  The physics of the seat is the simulated rig's platform.
class PlatformBench {
 public:
  /// What is wrong now.
  struct Trouble {
    bool to_platform_cut = false, to_host_cut = false;
    bool late = false;      ///< replies come 300 ms later
    bool repeated = false;  ///< the same reply again and again
    bool not_a_number = false;
    bool fault = false;        ///< the platform reports one
    bool host_stands = false;  ///< the rig's process is stopped
    bool motion_silent = false;
    bool process_silent = false;  ///< the lab, the network, any process of the session
  };
  /// What the platform was sent while it followed, and what it did.
  struct Seen {
    double most_jump_m = 0.0;  ///< first set-point that it follows, from where it stands
    double most_step_m = 0.0;  ///< from a set-point to the next one that came
    double most_acceleration_m_s2 = 0.0;
    double most_jerk_m_s3 = 0.0;
  };

  PlatformBench(Parts::Platform protocol, double place_m)
      : moog_(protocol == Parts::Platform::kMoog),
        exchange_(protocol, kToken, kValid_ms, 0.0),
        drive_(platform_limits({}, link(protocol), protocol)),
        period_ticks_(moog_ ? 16 : 1),
        place_m_(place_m) {}

  /// One millisecond.
  void step(const Trial& trial, bool runs, const motion::GuardInput& wanted) {
    hear();
    if (!trouble.host_stands) host(trial, runs, wanted);
    machine();
    ++now_ms_;
  }

  Trouble trouble;
  Seen seen;
  [[nodiscard]] double place_m() const { return place_m_; }
  [[nodiscard]] bool follows() const { return follows_; }
  [[nodiscard]] const PlatformDrive& drive() const { return drive_; }
  [[nodiscard]] bool lost(const Trial& trial) const { return permission_.latched(trial); }
  [[nodiscard]] bool moves() const { return std::abs(speed_m_s_) > 0.002; }

 private:
  static constexpr std::uint32_t kToken = 7, kValid_ms = 20;
  static constexpr std::int64_t kNs = 1'000'000;
  struct Received {
    double position_m, velocity_m_s, acceleration_m_s2;
    std::int64_t at_ms;
  };
  struct Waiting {
    std::int64_t due_ms;
    std::vector<std::uint8_t> bytes;
  };

  static PlatformLinkConfig link(Parts::Platform protocol) {
    PlatformLinkConfig config{.valid_ms = kValid_ms};
    if (protocol == Parts::Platform::kMoog) config.period_ticks = 16;
    return config;
  }
  void hear() {
    while (!waiting_.empty() && waiting_.front().due_ms <= now_ms_) {
      std::vector<std::uint8_t> bytes = std::move(waiting_.front().bytes);
      waiting_.pop_front();
      if (trouble.host_stands) {
        held_.push_back(std::move(bytes));  // in the socket's buffer
      } else {
        exchange_.take(bytes, now_ms_ * kNs);
      }
    }
    if (trouble.host_stands) return;
    for (const auto& bytes : held_) exchange_.take(bytes, now_ms_ * kNs);
    held_.clear();
  }
  void host(const Trial& trial, bool runs, const motion::GuardInput& wanted) {
    const PlatformSample& sample = exchange_.sample();
    const Tick age = sample.count > 0 ? now_ms_ - sample.at_ns / kNs : PlatformDrive::kNever;
    const bool faulted = drive_.stage() == SeatStage::kFaulted && drive_.trial() == trial.number;
    const bool unsound = faulted || age > 50 || sample.reply.stage == PlatformStage::kFault;
    motion::GuardInput asked = wanted;
    asked.valid = wanted.valid && !trouble.motion_silent;
    const MotionLeave leave = permission_.step(
        trial, tick_,
        {.runs = runs, .sound = !unsound && !trouble.process_silent, .command = asked.valid});
    if (leave == MotionLeave::kHold) asked.valid = false;
    const auto out =
        drive_.step({.leave = leave,
                     .measured = trial.measures(tick_),
                     .trial = trial.number,
                     .age_ticks = age,
                     .reply = sample.reply,
                     .stranger = sample.reply.owner != 0 && sample.reply.owner != kToken,
                     .wanted = asked});
    if (tick_++ % period_ticks_ == 0 || out.set_point.order != order_) send(out.set_point);
    order_ = out.set_point.order;
  }
  void send(const SetPoint& set_point) {
    const Packet packet = exchange_.command(set_point, now_ms_ * kNs);
    if (trouble.to_platform_cut) return;
    plain_.fault(trouble.fault ? 2 : 0);
    moog_machine_.fault(trouble.fault ? 2 : 0);
    const double place_m =
        trouble.not_a_number ? std::numeric_limits<double>::quiet_NaN() : place_m_;
    plain_.stand({place_m, speed_m_s_, 0.0});
    moog_machine_.stand(place_m);
    auto reply = moog_ ? moog_machine_.take(packet.payload(), now_ms_ * kNs)
                       : plain_.take(packet.payload(), now_ms_ * kNs);
    note({set_point.position_m, set_point.velocity_m_s, set_point.acceleration_m_s2, now_ms_});
    if (trouble.to_host_cut || reply.empty()) return;
    if (!trouble.repeated) newest_ = reply;
    waiting_.push_back({now_ms_ + (trouble.late ? 300 : 1), newest_});
  }
  /// A set-point that reached the platform.
  void note(const Received& now) {
    const bool follows = wish().has_value();
    if (!follows) {
      last_.reset();
      before_.reset();
      return;
    }
    if (!last_) seen.most_jump_m = std::max(seen.most_jump_m, std::abs(*wish() - place_m_));
    if (last_) {
      const double dt_s = 1e-3 * static_cast<double>(now.at_ms - last_->at_ms);
      const double speed_m_s = (now.position_m - last_->position_m) / dt_s;
      raise(seen.most_step_m, now.position_m - last_->position_m);
      const bool next = now.at_ms - last_->at_ms == period_ticks_;
      if (!moog_ && next) {
        raise(seen.most_acceleration_m_s2, (now.velocity_m_s - last_->velocity_m_s) / dt_s);
        raise(seen.most_jerk_m_s3, (now.acceleration_m_s2 - last_->acceleration_m_s2) / dt_s);
      }
      // A Moog gets positions alone: their second and third differences.
      const std::optional<double> slope = next ? std::optional(speed_m_s) : std::nullopt;
      std::optional<double> bend;
      if (moog_ && slope && before_) bend = (*slope - *before_) / dt_s;
      if (bend) raise(seen.most_acceleration_m_s2, *bend);
      if (bend && bend_) raise(seen.most_jerk_m_s3, (*bend - *bend_) / dt_s);
      before_ = slope;
      bend_ = bend;
    }
    last_ = now;
  }
  static void raise(double& most, double value) { most = std::max(most, std::abs(value)); }
  [[nodiscard]] std::optional<double> wish() const {
    if (moog_) return moog_machine_.wish_m();
    const auto wish = plain_.wish(now_ms_ * kNs);
    return wish ? std::optional(wish->position_m) : std::nullopt;
  }
  void machine() {
    const auto asked = wish();
    if (!asked) {
      last_.reset();
      before_.reset();
      bend_.reset();
    }
    follows_ = asked.has_value();
    rig::PlatformDemand demand{follows_, 0.0, 0.0, 0.0};
    demand.position_m = asked.value_or(0.0);
    if (follows_ && !moog_) {
      const auto whole = *plain_.wish(now_ms_ * kNs);
      demand.velocity_m_s = whole.velocity_m_s;
      demand.acceleration_m_s2 = whole.acceleration_m_s2;
    }
    if (!begun_) shift_m_ = place_m_;
    begun_ = true;
    demand.position_m -= shift_m_;
    const auto state = physics_.step(demand).state;
    place_m_ = shift_m_ + state.position_m;
    speed_m_s_ = state.velocity_m_s;
  }
  // The walls are the guard's business: the seat's own are far away.
  static rig::PlatformConfig wide() { return {.workspace_m = 1.0}; }

  bool moog_;
  PlatformExchange exchange_;
  PlatformDrive drive_;
  runtime::PlatformPermission permission_;
  emulators::PlatformEmulator plain_;
  emulators::MoogEmulator moog_machine_;
  rig::Platform physics_{wide()};
  Tick period_ticks_;
  Tick tick_ = 0;
  std::int64_t now_ms_ = 1000;
  PlatformOrder order_ = PlatformOrder::kHold;
  std::deque<Waiting> waiting_;
  std::vector<std::vector<std::uint8_t>> held_;
  std::vector<std::uint8_t> newest_;
  std::optional<Received> last_;
  std::optional<double> before_, bend_;
  bool follows_ = false, begun_ = false;
  double place_m_, shift_m_ = 0.0, speed_m_s_ = 0.0;
};

}  // namespace stillhand::device_rig
