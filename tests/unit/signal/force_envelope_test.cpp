// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/force_envelope.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::signal::force_envelope_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ForceLimits limits() { return {20.0, 1000.0, 40}; }

// Brings the envelope to a force.
ForceEnvelope at_force(double force_n) {
  ForceEnvelope sut(limits());
  for (int n = 0; n < 100; ++n) sut.step(force_n, true);
  return sut;
}

TEST(ForceEnvelopeTest, FollowsByNoMoreThanTheSlewLimitATick) {
  ForceEnvelope sut(limits());
  const auto near = sut.step(0.9, true);
  EXPECT_EQ(near.force_n, 0.9);
  EXPECT_EQ(near.flags, kGood);
  const auto far = sut.step(5.0, true);
  EXPECT_DOUBLE_EQ(far.force_n, 1.9);
  EXPECT_EQ(far.flags, Flags{kSlewLimited});
}

TEST(ForceEnvelopeTest, NeverExceedsTheLargestForce) {
  ForceEnvelope sut = at_force(1e300);
  const auto out = sut.step(-kInfinity, true);
  EXPECT_LE(std::abs(out.force_n), 20.0);
  ForceEnvelope high = at_force(35.0);
  const auto held = high.step(35.0, true);
  EXPECT_EQ(held.force_n, 20.0);
  EXPECT_EQ(held.flags, Flags{kSaturated});
}

TEST(ForceEnvelopeTest, IsExactlyZeroWithinTheRampFromEveryState) {
  for (const double force_n : {20.0, -20.0, 7.3, -0.001, 5e-324, 1e-310}) {
    for (const int interrupted_after : {0, 1, 17, 39}) {
      ForceEnvelope sut = at_force(force_n);
      for (int n = 0; n < interrupted_after; ++n) sut.step(force_n, false);
      // A short permission in between starts the ramp again.
      if (interrupted_after > 0) sut.step(force_n, true);
      double last = 0.0;
      for (int n = 0; n < 40; ++n) last = sut.step(force_n, false).force_n;
      EXPECT_EQ(last, 0.0) << force_n << " after " << interrupted_after;
      const auto rest = sut.step(force_n, false);
      EXPECT_EQ(rest.force_n, 0.0);
      EXPECT_EQ(rest.flags, kGood);
    }
  }
}

TEST(ForceEnvelopeTest, RampIsStraightAndFlagged) {
  ForceEnvelope sut = at_force(20.0);
  for (int n = 1; n < 40; ++n) {
    const auto out = sut.step(20.0, false);
    EXPECT_NEAR(out.force_n, 20.0 - 0.5 * n, 1e-14);
    EXPECT_EQ(out.flags, Flags{kRampingDown});
  }
}

TEST(ForceEnvelopeTest, NotANumberCountsAsNotPermitted) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    ForceEnvelope sut = at_force(10.0);
    const auto out = sut.step(bad, true);
    EXPECT_DOUBLE_EQ(out.force_n, 10.0 * 39.0 / 40.0);
    EXPECT_EQ(out.flags, kInputInvalid | kRampingDown);
  }
}

TEST(ForceEnvelopeTest, BoundsHoldForAnySequence) {
  ForceEnvelope sut(limits());
  Gaussian draw(11, 2);
  double last = 0.0;
  for (int n = 0; n < 1'000'000; ++n) {
    const double u = draw.uniform();
    const double wanted = u < 0.01 ? kNan : u < 0.02 ? kInfinity : 30.0 * draw();
    const auto out = sut.step(wanted, draw.uniform() > 0.05);
    ASSERT_LE(std::abs(out.force_n), 20.0);
    // 1 N a tick permitted, 20/40 N a tick in the ramp; rounding of one addition.
    ASSERT_LE(std::abs(out.force_n - last), 1.0 + 4e-15);
    last = out.force_n;
  }
}

TEST(ForceEnvelopeTest, LimitsOutsideTheirRangeAreRefused) {
  EXPECT_THROW(ForceEnvelope({61.0, 1000.0, 40}), ConfigError);
  EXPECT_THROW(ForceEnvelope({kNan, 1000.0, 40}), ConfigError);
  EXPECT_THROW(ForceEnvelope({20.0, 0.0, 40}), ConfigError);
  EXPECT_THROW(ForceEnvelope({20.0, 1000.0, 51}), ConfigError);
}

}  // namespace
}  // namespace stillhand::signal::force_envelope_test
