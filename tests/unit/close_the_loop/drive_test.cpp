// SPDX-License-Identifier: Apache-2.0
// The stick's own equation, Eq. CL-5, on a stick that is moved by a known force.
#include "apps/close_the_loop/verdict/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/core/contract/units.hpp"
#include "services/core/signal/delay_line.hpp"
#include "tests/support/feedthrough_records.hpp"

namespace stillhand::close_the_loop::drive_test {
namespace {

struct Late {
  std::size_t motor = 2;
  std::size_t cell = 0;
};

// f = m r alpha + b r omega + F sign(omega) + ripple - f_m, the motor's command late by
// `late.motor` ticks, the cell by `late.cell`; the angle as an encoder of 4096 counts gives it.
recording::Recording moved_stick(Late late, double friction_n, double ripple_n) {
  constexpr std::size_t kTicks = 60'000;
  const DeclaredDrive drive;
  const double r = drive.stick.lever_m;
  const auto x = support::band_noise(kTicks, 1000.0, 0.3, 2.0, 0.02, 21);
  const auto motor = support::band_noise(kTicks, 1000.0, 0.7, 2.0, 5.0, 22);
  recording::Recording out;
  out.source = "stick";
  out.rate_hz = 1000.0;
  out.columns = {{"theta", "rad", {}}, {"f", "N", {}}, {"f_motor", "N", {}}};
  std::vector<double> force(kTicks, 0.0);
  for (std::size_t n = 2; n < kTicks; ++n) {
    const double v = (x[n] - x[n - 1]) * 1000.0;
    const double a = (x[n] - 2.0 * x[n - 1] + x[n - 2]) * 1e6;
    const double theta = x[n] / r;
    const double acts = n >= late.motor ? motor[n - late.motor] : 0.0;
    force[n] = drive.stick.drive_mass_kg * a + drive.stick.viscous_damping_n_s_m * v +
               (drive.stick.coulomb_friction_n + friction_n) * (v > 0.0 ? 1.0 : -1.0) +
               ripple_n * std::sin(kTwoPi * theta / 0.08) - acts;
  }
  const double count = kTwoPi / 4096.0;
  for (std::size_t n = 0; n < kTicks; ++n) {
    out.time_s.push_back(static_cast<double>(n) * 1e-3);
    out.columns[0].values.push_back(std::round(x[n] / r / count) * count);
    out.columns[1].values.push_back(n >= late.cell ? force[n - late.cell] : 0.0);
    out.columns[2].values.push_back(motor[n]);
  }
  return out;
}

TEST(DriveTest, ADelayIsFoundToTheMillisecondAndInItsPlace) {
  const DeclaredDrive declared{{}, 0.002};
  const auto none = measure_latency(moved_stick({2, 0}, 0.0, 0.0), declared);
  ASSERT_TRUE(none);
  EXPECT_NEAR(none->motor_s, 0.002, 1e-3);
  EXPECT_NEAR(none->cell_s, 0.0, 1e-3);
  EXPECT_LT(none->explained_n, 0.02);
  const auto motor = measure_latency(moved_stick({32, 0}, 0.0, 0.0), declared);
  EXPECT_NEAR(motor->motor_s, 0.032, 1e-3);
  EXPECT_EQ(motor->cell_s, 0.0);
  EXPECT_GT(motor->explained_n, 0.5);
  const auto cell = measure_latency(moved_stick({2, 45}, 0.0, 0.0), declared);
  EXPECT_NEAR(cell->cell_s, 0.045, 1e-3);
  EXPECT_EQ(cell->motor_s, 0.002);
}

TEST(DriveTest, WithoutAMotorThereIsNoLatency) {
  recording::Recording still = moved_stick({}, 0.0, 0.0);
  still.columns[2].values.assign(still.row_count(), 0.0);
  EXPECT_FALSE(measure_latency(still, {}));
  recording::Recording shorter = moved_stick({}, 0.0, 0.0);
  shorter.time_s.resize(100);
  EXPECT_FALSE(measure_latency(shorter, {}));
}

TEST(DriveTest, WhatNobodyDeclaredIsFound) {
  const DeclaredDrive declared{{}, 0.002};
  // The declared friction is taken off with a smooth sign: a little of it is left.
  const recording::Recording nothing_trial = moved_stick({}, 0.0, 0.0);
  const auto nothing = diagnose_drive({&nothing_trial}, declared, {});
  EXPECT_LT(nothing.baseline_error.rmse, 0.1);
  const recording::Recording friction_trial = moved_stick({}, 1.2, 0.0);
  const auto friction = diagnose_drive({&friction_trial}, declared, {});
  ASSERT_EQ(friction.effects.size(), 1u);
  EXPECT_EQ(friction.effects[0].effect.kind, "coulomb_friction");
  EXPECT_EQ(friction.effects[0].channel, "omega");
  const recording::Recording ripple_trial = moved_stick({}, 0.0, 1.0);
  const auto ripple = diagnose_drive({&ripple_trial}, declared, {});
  ASSERT_EQ(ripple.effects.size(), 1u);
  EXPECT_EQ(ripple.effects[0].effect.kind, "position_ripple");
  EXPECT_NEAR(ripple.effects[0].effect.value(0), 1.0 / 0.08, 0.1);
}

}  // namespace
}  // namespace stillhand::close_the_loop::drive_test
