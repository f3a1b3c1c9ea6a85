// SPDX-License-Identifier: Apache-2.0
// Recordings as a laboratory has them, from the file to the verdict.  What is rough must cost a
// note, not the verdict.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "apps/libraries/measurement/grid.hpp"
#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/recording/csv.hpp"
#include "services/core/signal/random.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::rough_recordings_test {

constexpr std::size_t kCount = 6000;
constexpr double kPeriod_s = 0.01;

// f = body(a_y) + 1.5 a_z + noise, 60 s.
struct Rows {
  Rows() {
    const Body body = made::four_pole_body();
    const auto a_y = made::ride(kCount, 1);
    const auto a_z = made::ride(kCount, 2);
    auto f = made::answer(body, a_y);
    const auto noise = made::white(kCount, 3);
    for (std::size_t n = 0; n < kCount; ++n) f[n] += 1.5 * a_z[n] + 0.3 * noise[n];
    table.columns = {{"a_y", "m/s^2", a_y}, {"a_z", "m/s^2", a_z}, {"f", "N", f}};
    for (std::size_t n = 0; n < kCount; ++n) {
      table.time_s.push_back(kPeriod_s * static_cast<double>(n));
    }
  }

  void lose(std::size_t first, std::size_t count) {
    const auto cut = [&](std::vector<double>& x) {
      x.erase(x.begin() + static_cast<std::ptrdiff_t>(first),
              x.begin() + static_cast<std::ptrdiff_t>(first + count));
    };
    cut(table.time_s);
    for (recording::Column& column : table.columns) cut(column.values);
  }

  // The kind and channel that come first among those that explain something.
  [[nodiscard]] std::string verdict() const {
    const Measurement measurement =
        measurement::on_grid(recording::parse_csv(recording::to_csv(table), "rough"), 10'000'000);
    check(measurement);
    const Diagnosis found = diagnose(measurement, {});
    EXPECT_TRUE(std::isfinite(found.final_error.rmse));
    for (const FoundEffect& effect : found.effects) {
      if (effect.effect.kind != "transients") return effect.effect.kind + " " + effect.channel;
    }
    return found.verdict();
  }

  recording::Recording table;
};

constexpr const char* kPlanted = "coupled_input a_z";

TEST(RoughRecordingsTest, AsItIsTheEffectIsNamed) { EXPECT_EQ(Rows().verdict(), kPlanted); }

TEST(RoughRecordingsTest, JitteredStampsCostNoVerdict) {
  Rows sut;
  signal::Gaussian draw(5, 0);
  for (double& t_s : sut.table.time_s) t_s += 0.2 * kPeriod_s * (draw.uniform() - 0.5);
  EXPECT_EQ(sut.verdict(), kPlanted);
}

TEST(RoughRecordingsTest, GapsAndAMissingStretchCostNoVerdict) {
  Rows sut;
  sut.lose(4500, 700);  // 7 s
  sut.lose(3000, 20);
  for (std::size_t n = 2500; n > 100; n -= 97) sut.lose(n, 1 + n % 3);
  EXPECT_EQ(sut.verdict(), kPlanted);
}

// Values that come again while time goes on: the clock hides it, the force and its cause agree.
TEST(RoughRecordingsTest, AStretchThatIsThereTwiceCostsNoVerdict) {
  Rows sut;
  for (recording::Column& column : sut.table.columns) {
    std::copy_n(column.values.begin() + 1500, 500, column.values.begin() + 2000);
  }
  EXPECT_EQ(sut.verdict(), kPlanted);
}

// A fifth of the record clips at the force's own deviation.
TEST(RoughRecordingsTest, ASaturatedStretchCostsNoVerdict) {
  Rows sut;
  std::vector<double>& f = sut.table.columns[2].values;
  const double limit = made::rms_of(f);
  for (std::size_t n = 3000; n < 4200; ++n) f[n] = std::clamp(f[n], -limit, limit);
  EXPECT_EQ(sut.verdict(), kPlanted);
}

TEST(RoughRecordingsTest, AForceThatStandsStillForTwoSecondsCostsNoVerdict) {
  Rows sut;
  std::vector<double>& f = sut.table.columns[2].values;
  for (std::size_t n = 3000; n < 3200; ++n) f[n] = f[3000];
  EXPECT_EQ(sut.verdict(), kPlanted);
}

}  // namespace stillhand::diagnosis::rough_recordings_test
