// SPDX-License-Identifier: Apache-2.0
// A difference model sample by sample.
#include "services/cancellation/parts/model_line.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "services/contract/config_error.hpp"

namespace stillhand::cancellation {
namespace {

const signal::DifferenceModel kModel{1000.0, {-0.3, 0.2, 0.05, -0.1}, {1.0, -2.1, 1.55, -0.4}};

// Oracle: signal::simulated(), which is another form of the same sum.
TEST(ModelLineTest, GivesTheFreeRunOfItsModel) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> draw;
  std::vector<double> input(2000);
  for (double& u : input) u = draw(engine);
  const std::vector<double> expected = signal::simulated(kModel, input);
  ModelLine sut(kModel);
  for (std::size_t n = 0; n < input.size(); ++n) {
    ASSERT_NEAR(sut.step(input[n]), expected[n], 1e-9) << "n = " << n;
  }
  sut.reset();
  EXPECT_DOUBLE_EQ(sut.step(input[0]), expected[0]);
}

TEST(ModelLineTest, GivesNothingWithoutAModel) {
  ModelLine sut;
  EXPECT_EQ(sut.step(1.0), 0.0);
  EXPECT_EQ(sut.step(1.0), 0.0);
}

TEST(ModelLineTest, RefusesWhatItCannotRun) {
  signal::DifferenceModel unstable = kModel;
  unstable.denominator = {1.0, -1.1, 0.0, 0.0};
  EXPECT_THROW(ModelLine{unstable}, ConfigError);
  signal::DifferenceModel slow = kModel;
  slow.rate_hz = 50.0;
  EXPECT_THROW(ModelLine{slow}, ConfigError);
  signal::DifferenceModel uneven = kModel;
  uneven.numerator.pop_back();
  EXPECT_THROW(ModelLine{uneven}, ConfigError);
}

}  // namespace
}  // namespace stillhand::cancellation
