// SPDX-License-Identifier: Apache-2.0
// Every fault of a platform, for five times, in every phase of a session: what the platform is sent
// stays within the limits, nothing moves without a trial, and what was lost in a trial stays lost
// in it.  Deterministic: simulated time.
#include <gtest/gtest.h>

#include "services/core/device_rig/platform_response.hpp"
#include "tests/unit/device_rig/platform_bench.hpp"

namespace stillhand::device_rig::platform_campaign_test {

constexpr Tick kAnnounced = 300, kLead = 1000, kRamp = 1500, kMeasured = 1500, kPause = 500;
constexpr Tick kEnd = kAnnounced + kLead + 2 * kRamp + kMeasured;
constexpr Tick kAgain = kEnd + kPause;  // the next announcement
constexpr double kMost_m_s = 0.33;      // of this trial's motion, by seed 3
constexpr Tick kAllOver = kAgain + kLead + kRamp + 500;

struct Fault {
  const char* name;
  bool PlatformBench::Trouble::* first;
  bool PlatformBench::Trouble::* second;
};
using Trouble = PlatformBench::Trouble;
constexpr Fault kFaults[]{
    {"cable out", &Trouble::to_platform_cut, &Trouble::to_host_cut},
    {"set-points are lost", &Trouble::to_platform_cut, nullptr},
    {"replies are lost", &Trouble::to_host_cut, nullptr},
    {"replies 300 ms late", &Trouble::late, nullptr},
    {"the same reply again", &Trouble::repeated, nullptr},
    {"position without a value", &Trouble::not_a_number, nullptr},
    {"the platform reports a fault", &Trouble::fault, nullptr},
    {"the rig's process stands still", &Trouble::host_stands, nullptr},
    {"motion is silent", &Trouble::motion_silent, nullptr},
    {"another process is silent", &Trouble::process_silent, nullptr},
};
constexpr Tick kReturns_ms[]{5, 50, 400, 700, 3000};
struct Phase {
  const char* name;
  Tick at;
};
constexpr Phase kPhases[]{{"before a trial", kAnnounced - 150},
                          {"arming", kAnnounced + 700},
                          {"ramp", kAnnounced + kLead + 700},
                          {"tracking", kAnnounced + kLead + kRamp + 700},
                          {"pause", kEnd + 200}};

Trial trial_at(std::int64_t number, Tick announced) {
  return {number, TrialPhase::kTracking, announced + kLead + kRamp, kMeasured, kRamp};
}

motion::MotionGenerator moving(std::int64_t number, Tick announced) {
  motion::MotionProfile profile;
  profile.kind = motion::MotionKind::kBandNoise;
  profile.seed = 3;
  profile.duration_ticks = kMeasured;
  profile.ramp_ticks = kRamp;
  motion::MotionGenerator generator({});
  generator.arm(motion::MotionTrajectory(profile, {}), trial_at(number, announced));
  return generator;
}

Trial announced(Tick tick) {
  if (tick >= kAnnounced && tick < kEnd) return trial_at(0, kAnnounced);
  return tick >= kAgain ? trial_at(1, kAgain) : Trial{};
}

/// One session of two trials with a fault, as a person at the rig who does nothing lets it go on.
class Session {
 public:
  Session(Parts::Platform protocol, double place_m)
      : bench(protocol, place_m), motion_(moving(0, kAnnounced)) {}

  void run(const Fault* fault, Tick at, Tick lasts) {
    for (Tick tick = 0; clock_ < kAllOver; ++tick) {
      if (clock_ == kAgain) motion_ = moving(1, kAgain);
      const bool wrong = fault != nullptr && tick >= at && tick < at + lasts;
      if (fault != nullptr) bench.trouble.*(fault->first) = wrong;
      if (fault != nullptr && fault->second != nullptr) bench.trouble.*(fault->second) = wrong;
      // As of the rig's own clock, which stands with its process.
      if (!bench.trouble.host_stands) trial_ = announced(clock_++);
      bench.step(trial_, true, {true, motion_.step(clock_)});
      look();
    }
  }
  PlatformBench bench;
  bool moved_without_trial = false, moved_after_loss = false, followed_first = false,
       followed_second = false;
  bool lost_first = false;

 private:
  void look() {
    // A set-point that is held is no motion.  From 0.32 m/s at 5 m/s^2 in 64 ms, 10 ms more for the
    // jerk; then the emulated seat settles.
    const bool quiet = trial_.number < 0 || bench.lost(trial_);
    quiet_ms_ = quiet ? quiet_ms_ + 1 : 0;
    if (quiet_ms_ > 300 || (trial_.number < 0 && clock_ < kAnnounced)) {
      (trial_.number < 0 ? moved_without_trial : moved_after_loss) |= bench.moves();
    }
    lost_first |= trial_.number == 0 && bench.lost(trial_);
    const bool following = bench.drive().stage() == SeatStage::kFollowing;
    if (trial_.number == 0) followed_first |= following;
    if (trial_.number == 1) followed_second |= following;
  }

  motion::MotionGenerator motion_;
  Trial trial_;
  Tick clock_ = 0, quiet_ms_ = 0;
};

// Of a Moog, differences of 60 Hz packets: the jerk is that of the trial's own motion, sampled.
void expect_within_limits(const PlatformBench::Seen& seen, bool moog, const std::string& cell) {
  // It engages where it stood to a millimetre; a packet is one tick old.
  EXPECT_LE(seen.most_jump_m, 0.0015) << cell;
  // The trial's speed, for as long as a reply may be old and a packet on its way.
  EXPECT_LE(seen.most_step_m, kMost_m_s * (moog ? 0.050 + 0.016 : 0.020 + 0.002)) << cell;
  EXPECT_LE(seen.most_acceleration_m_s2, 9.0) << cell;  // motion's own limit
  EXPECT_LE(seen.most_jerk_m_s3, moog ? 1000.0 : 1000.0 * (1.0 + 1e-9)) << cell;
}

class PlatformCampaignTest : public testing::TestWithParam<Parts::Platform> {
 protected:
  [[nodiscard]] bool moog() const { return GetParam() == Parts::Platform::kMoog; }
  [[nodiscard]] const char* name() const { return moog() ? "Moog" : "plain"; }
  // Off the middle; the emulated Moog stands there, too.
  static constexpr double kPlace_m = 0.08;
};

TEST_P(PlatformCampaignTest, WithoutAFaultItEngagesFollowsAndHolds) {
  Session sut(GetParam(), kPlace_m);
  sut.run(nullptr, 0, 0);
  EXPECT_TRUE(sut.followed_first);
  EXPECT_TRUE(sut.followed_second);
  EXPECT_FALSE(sut.lost_first);
  EXPECT_FALSE(sut.moved_without_trial);
  expect_within_limits(sut.bench.seen, moog(), "no fault");
}

TEST_P(PlatformCampaignTest, EveryFaultThatComesBackKeepsEverySetPointWithinItsLimits) {
  for (const Fault& fault : kFaults) {
    for (const Tick returns_ms : kReturns_ms) {
      for (const Phase& phase : kPhases) {
        const std::string cell = std::string(name()) + ", " + fault.name + ", " + phase.name +
                                 ", " + std::to_string(returns_ms) + " ms";
        Session sut(GetParam(), kPlace_m);
        sut.run(&fault, phase.at, returns_ms);
        expect_within_limits(sut.bench.seen, moog(), cell);
        EXPECT_FALSE(sut.moved_without_trial) << cell;
        EXPECT_FALSE(sut.moved_after_loss) << cell;
        // Once the fault is over another trial runs; the last ones of 3 s reach into it.
        const bool over = phase.at + returns_ms < kAgain;
        EXPECT_TRUE(sut.followed_second || !over) << cell;
      }
    }
  }
}

TEST_P(PlatformCampaignTest, WhatIsLostInATrialIsLostForTheTrial) {
  for (const Fault& fault : kFaults) {
    // Its packets have no number.
    if (moog() && fault.first == &Trouble::repeated) continue;
    for (const Tick returns_ms : {400, 700, 3000}) {
      Session sut(GetParam(), kPlace_m);
      sut.run(&fault, kPhases[3].at, returns_ms);
      EXPECT_TRUE(sut.lost_first) << fault.name << ", " << returns_ms;
      EXPECT_FALSE(sut.moved_after_loss) << fault.name << ", " << returns_ms;
    }
  }
}

// The platform's identification: one trial of its own, around the place where it stands.
TEST_P(PlatformCampaignTest, AFaultDuringACalibrationKeepsTheLimitsToo) {
  PlatformTest motion({.motion_m = 0.01}, 2);
  for (const Fault& fault : kFaults) {
    for (const Tick returns_ms : kReturns_ms) {
      PlatformBench sut(GetParam(), kPlace_m);
      constexpr Tick kBegins = 2000, kFails = 3000;
      const Trial trial{0, TrialPhase::kPegged, kBegins, 3'600'000, 0};
      Tick clock = 0;
      for (Tick tick = 0; tick < kBegins + motion.ticks(); ++tick) {
        const bool wrong = tick >= kFails && tick < kFails + returns_ms;
        sut.trouble.*(fault.first) = wrong;
        if (fault.second != nullptr) sut.trouble.*(fault.second) = wrong;
        motion::GuardInput wanted{true, {.position_m = kPlace_m}};
        if (clock >= kBegins) {
          const auto point = motion.at(std::min(clock - kBegins, motion.ticks() - 1));
          wanted.command = {kPlace_m + point.pos_m, point.vel_m_s, point.accel_m_s2};
        }
        sut.step(clock < 200 ? Trial{} : trial, true, wanted);
        if (!sut.trouble.host_stands) ++clock;
      }
      expect_within_limits(sut.seen, moog(), std::string("calibrate, ") + fault.name);
    }
  }
}

// The simulated platform: the shell's permission and Eq. RG-1, RG-39.  It has no faults of its own.
TEST(SimulatedCampaignTest, WhatIsSilentStopsItForTheTrialAndItComesBackSlowly) {
  const rig::PlatformConfig config;
  for (const bool motion_silent : {true, false}) {
    PlatformBench::Seen worst;
    for (const Tick returns_ms : kReturns_ms) {
      for (const Phase& phase : kPhases) {
        rig::Platform sut(config);
        runtime::PlatformPermission permission;
        auto motion = moving(0, kAnnounced);
        Tick quiet_ms = 0;
        bool followed_second = false;
        double before_m = 0.0;
        for (Tick tick = 0; tick < kAllOver; ++tick) {
          if (tick == kAgain) motion = moving(1, kAgain);
          const Trial trial = announced(tick);
          const bool wrong = tick >= phase.at && tick < phase.at + returns_ms;
          const bool command = !(wrong && motion_silent);
          const MotionLeave leave = permission.step(
              trial, tick, {.runs = true, .sound = !wrong || motion_silent, .command = command});
          const auto wanted = motion.step(tick);
          const auto state = sut.step({command, wanted.position_m, wanted.velocity_m_s,
                                       wanted.acceleration_m_s2, leave == MotionLeave::kHold})
                                 .state;
          worst.most_step_m = std::max(worst.most_step_m, std::abs(state.position_m - before_m));
          worst.most_acceleration_m_s2 =
              std::max(worst.most_acceleration_m_s2, std::abs(state.acceleration_m_s2));
          before_m = state.position_m;
          quiet_ms = leave == MotionLeave::kHold ? quiet_ms + 1 : 0;
          // As above; the loop's end takes some time constants, 1/(2 z w) = 8 ms.
          ASSERT_TRUE(quiet_ms < 300 || std::abs(state.velocity_m_s) < 0.002) << tick;
          // Eq. SG-21, and what the loop adds.
          ASSERT_TRUE(leave != MotionLeave::kEngage || std::abs(state.velocity_m_s) < 0.132)
              << tick;
          followed_second |= trial.number == 1 && leave == MotionLeave::kFollow;
        }
        EXPECT_TRUE(followed_second || phase.at + returns_ms >= kAgain) << phase.name;
      }
    }
    EXPECT_LE(worst.most_step_m, 1e-3 * config.max_velocity_m_s);
    EXPECT_LE(worst.most_acceleration_m_s2, config.max_acceleration_m_s2);
  }
}

INSTANTIATE_TEST_SUITE_P(Protocols, PlatformCampaignTest,
                         testing::Values(Parts::Platform::kPlain, Parts::Platform::kMoog),
                         [](const auto& each) {
                           return each.param == Parts::Platform::kMoog ? "Moog" : "Plain";
                         });

}  // namespace stillhand::device_rig::platform_campaign_test
