// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/ride.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "places.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/motion/motion_trajectory.hpp"
#include "services/messages/motion/ride_file.hpp"

namespace stillhand::motion::ride_test {

// A ride of sines, sampled at a rate that is no divisor of 1 kHz.
MotionProfile ride_of(const std::vector<std::pair<double, double>>& hz_and_m_s2, double seconds,
                      double rate_hz = 104.0) {
  MotionProfile profile;
  profile.kind = MotionKind::kRide;
  profile.rms_m_s2 = 0.0;
  profile.band_low_hz = 0.1;
  profile.band_high_hz = 10.0;
  profile.duration_ticks = ticks_in(seconds);
  profile.ride_rate_hz = rate_hz;
  const auto count = static_cast<std::size_t>(std::ceil((seconds + 3.0) * rate_hz));
  for (std::size_t i = 0; i < count; ++i) {
    const double t_s = static_cast<double>(i) / rate_hz;
    double a = 0.0;
    for (const auto& [hz, m_s2] : hz_and_m_s2) {
      a += m_s2 * std::sin(2.0 * std::numbers::pi * hz * t_s);
    }
    profile.ride_accel_m_s2.push_back(a);
  }
  return profile;
}

// Oracle: the sine itself, from its largest value on, where the mirror image goes on smoothly.  H
// at 2 Hz with a corner of 0.1 Hz is 1 - (0.05)^8 = 1 - 4e-11; what remains is leakage of the other
// end, where the mirror image turns the sine round: a kink, whose high-passed trace has died out,
// and whose cut at 8..10 Hz rings as 1/(distance)^3; 1e-3 of the amplitude bounds it generously.
TEST(RideTest, ASineIsResampledWithoutDelayOrLoss) {
  auto profile = ride_of({{2.0, 1.0}}, 40.0);
  auto& ride = profile.ride_accel_m_s2;
  ride.erase(ride.begin(), ride.begin() + 13);  // an eighth of a second
  const MotionTrajectory sut(profile, PlatformLimits{});
  EXPECT_EQ(sut.report().corner_hz, 0.1);
  for (Tick n = 0; n < 38'000; ++n) {
    const double want =
        std::cos(2.0 * std::numbers::pi * 2.0 * static_cast<double>(n) * kControlPeriod_s);
    ASSERT_NEAR(sut.at(n + profile.ramp_ticks).acceleration_m_s2, want, 1e-3) << n;
  }
}

// Eq. MO-14 with corners of 1 and 10 Hz, on a single sample, whose N lines all are 2/N; far from
// the ends it has no mirror image, and its mean of 1/4160 is felt in the lowest lines alone.
TEST(RideTest, ItsBandPassIsThatOfItsEquation) {
  auto profile = ride_of({{2.0, 0.0}}, 40.0);
  profile.ride_accel_m_s2[2200] = 1.0;
  const MotionSpectrum got = Ride(profile).above(1.0);
  for (const double near_hz : {0.8, 1.0, 2.0, 7.9, 8.5, 9.0, 9.7}) {
    const auto line = static_cast<std::size_t>(std::llround(near_hz * got.period_s) - got.first);
    const double f_hz = got.rad_s(line) / (2.0 * std::numbers::pi);
    const double edge = std::clamp((f_hz - 8.0) / 2.0, 0.0, 1.0);
    EXPECT_NEAR(std::abs(got.accel_m_s2[line]) * 104.0 * got.period_s / 2.0,
                (0.5 + 0.5 * std::cos(std::numbers::pi * edge)) / (1.0 + std::pow(f_hz, -8)), 3e-3);
  }
}

// 1 m/s^2 at 0.15 Hz needs 1.13 m of travel: it must go.  1 m/s^2 at 2 Hz needs 6 mm: it stays.
// Half of the variance goes, plus what the filter takes from 2 Hz: below (0.5/2)^8 of it.
TEST(RideTest, TheSlowPartThatNeedsTooMuchTravelIsRemovedAndReported) {
  const auto profile = ride_of({{0.15, 1.0}, {2.0, 1.0}}, 60.0);
  const MotionTrajectory sut(profile, PlatformLimits{});
  EXPECT_GT(sut.report().corner_hz, 0.15);
  EXPECT_LT(sut.report().corner_hz, 0.5);
  EXPECT_LE(sut.report().peak_position_m, 0.15);
  // The lowest corner that fits uses nearly the whole travel.
  EXPECT_GT(sut.report().peak_position_m, 0.145);
  EXPECT_NEAR(sut.report().removed_share, 0.5, 0.03);
  EXPECT_NEAR(sut.report().removed_slow_share, 0.5, 0.03);
}

TEST(RideTest, TheCornerFoundIsTheLowestThatFits) {
  const auto profile = ride_of({{0.15, 1.0}, {2.0, 1.0}}, 60.0);
  const double corner_hz = MotionTrajectory(profile, PlatformLimits{}).report().corner_hz;
  auto lower = profile;
  lower.band_low_hz = 0.98 * corner_hz;
  EXPECT_GT(MotionTrajectory(lower, PlatformLimits{}).report().corner_hz, 0.98 * corner_hz);
  auto higher = profile;
  higher.band_low_hz = 1.02 * corner_hz;
  EXPECT_EQ(MotionTrajectory(higher, PlatformLimits{}).report().corner_hz, 1.02 * corner_hz);
}

TEST(RideTest, AConstantOffsetMakesNoMotion) {
  auto profile = ride_of({{2.0, 1.0}}, 20.0);
  const MotionTrajectory plain(profile, PlatformLimits{});
  for (double& a : profile.ride_accel_m_s2) a -= 9.81;
  const MotionTrajectory offset(profile, PlatformLimits{});
  for (Tick i = 0; i < 24'000; i += 7) {
    // The mean is a sum of 2e3 values near 10: rounding 1e-12 m/s^2, and 1/(2 pi 0.1)^2 of it in x.
    ASSERT_NEAR(plain.at(i).position_m, offset.at(i).position_m, 1e-11);
  }
}

TEST(RideTest, RecordsThatCannotBeFollowedAreRefused) {
  const auto refused = [](double hz, double m_s2, void (*spoil)(MotionProfile&)) {
    auto profile = ride_of({{hz, m_s2}}, 20.0);
    spoil(profile);
    EXPECT_THROW(MotionTrajectory(profile, PlatformLimits{}), ConfigError) << hz << " " << m_s2;
  };
  refused(2.0, 1.0, [](MotionProfile& p) { p.ride_accel_m_s2[100] = std::nan(""); });
  refused(2.0, 1.0, [](MotionProfile& p) { p.duration_ticks = 24'000; });  // the record has 23 s
  refused(2.0, 1.0, [](MotionProfile& p) { p.ride_rate_hz = 19.9; });      // less than twice 10 Hz
  refused(2.0, 0.0, [](MotionProfile&) {});
  refused(2.0, 1.0, [](MotionProfile& p) { p.rms_m_s2 = 1.6; });
  // At the highest corner, 8 Hz, still 1000/44 m/s^2; then a spectrum that overflows to NaN.
  refused(5.0, 1000.0, [](MotionProfile& p) { p.band_high_hz = 8.0; });
  refused(3.0, 1.7e308, [](MotionProfile&) {});
  auto slow = ride_of({{2.0, 1.0}}, 20.0);
  slow.ride_rate_hz = 20.1;
  EXPECT_NO_THROW(MotionTrajectory(slow, PlatformLimits{}));
}

std::filesystem::path measured_recordings() {
  if (const char* folder = std::getenv("STILLHAND_DATA")) return folder;
  return std::filesystem::path(STILLHAND_SOURCE).parent_path() / "shared" / "data";
}

// A measured car ride (comma2k19, MIT), lateral acceleration `a_y [m/s^2]`; gravity is on a_z only.
TEST(RideTest, AMeasuredCarRideDrivesThePlatform) {
  const auto file = measured_recordings() / "car_ride.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << "; set STILLHAND_DATA";
  const RideRecord ride = read_ride(file);
  ASSERT_GT(ride.accel_m_s2.size(), 6000u);
  MotionProfile profile;
  profile.kind = MotionKind::kRide;
  profile.rms_m_s2 = 0.0;
  profile.band_low_hz = 0.05;
  profile.band_high_hz = 6.0;  // platform bandwidth, paper III-C
  profile.duration_ticks = 55'000;
  profile.ride_accel_m_s2 = ride.accel_m_s2;
  profile.ride_rate_hz = ride.rate_hz;
  const PlatformLimits limits;
  const MotionTrajectory sut(profile, limits);

  PlatformGuard guard(limits);
  for (Tick i = 0; i < profile.duration_ticks + 2 * profile.ramp_ticks; ++i) {
    const PlatformCommand asked = sut.at(i);
    const PlatformCommand got = guard.step({true, asked});
    ASSERT_EQ(got.flags, kGood) << "tick " << i;
    ASSERT_EQ(got.position_m, asked.position_m) << "tick " << i;
  }
  EXPECT_LE(sut.report().peak_position_m, limits.max_position_m);
  EXPECT_LE(sut.report().peak_m_s2, profile.peak_m_s2);
  EXPECT_GT(sut.report().removed_share, 0.0);
  EXPECT_LT(sut.report().removed_share, 1.0);
  RecordProperty("corner_hz", std::to_string(sut.report().corner_hz));
  RecordProperty("removed_share", std::to_string(sut.report().removed_share));
  RecordProperty("removed_slow_share", std::to_string(sut.report().removed_slow_share));
  RecordProperty("rms_m_s2", std::to_string(sut.report().rms_m_s2));
  RecordProperty("peak_position_m", std::to_string(sut.report().peak_position_m));
}

}  // namespace stillhand::motion::ride_test
