// SPDX-License-Identifier: Apache-2.0
// Whether the model goes on to hold, Eq. CC-20 to CC-22, on a hand that is a spring, a damper and a
// mass, and moves by itself, too.
#include "services/core/cancellation/model_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "tests/support/feedthrough_records.hpp"

namespace stillhand::cancellation::model_watch_test {
namespace {

constexpr HandCompliance kStiffer{1.5, 14.0, 1500.0, 0.1};  // than the average hand

/// The hand is moved by the true feedthrough, `gain(tick)` times the prediction, by the motor,
/// which takes the prediction away, and by forces of its own.
class Hand {
 public:
  explicit Hand(double seconds, std::uint64_t seed = 1)
      : predicted_n_(support::band_noise(count(seconds), 1000.0, 0.7, 2.0, 6.0, seed)),
        own_n_(support::band_noise(count(seconds), 1000.0, 0.1, 3.0, 2.0, seed + 1)) {}

  [[nodiscard]] Tick ticks() const { return static_cast<Tick>(predicted_n_.size()); }

  ModelWatch::Input at(Tick tick, double gain) {
    const auto n = static_cast<std::size_t>(tick);
    const double force_n = (gain - 1.0) * predicted_n_[n] + own_n_[n];
    const double x_m = lag_.step(force_n / kStiffer.stiffness_n_m).x;
    return {tick, 0, true, predicted_n_[n], predicted_n_[n], x_m / kStiffer.lever_m};
  }

 private:
  static std::size_t count(double seconds) { return static_cast<std::size_t>(1000.0 * seconds); }

  std::vector<double> predicted_n_, own_n_;
  signal::SecondOrderLag lag_{std::sqrt(1500.0 / 1.5), 14.0 / (2.0 * std::sqrt(1500.0 * 1.5)),
                              1e-3};
};

struct Found {
  Tick at = -1;
  ModelWatch::Change change{};
  int count = 0;
};

Found watch(
    double seconds, const std::function<double(Tick)>& gain,
    const std::function<void(ModelWatch::Input&)>& spoil = [](auto&) {}) {
  Hand hand(seconds);
  ModelWatch sut(0.1, kStiffer);
  Found found;
  for (Tick tick = 0; tick < hand.ticks(); ++tick) {
    ModelWatch::Input input = hand.at(tick, gain(tick));
    spoil(input);
    const auto change = sut.step(input);
    if (!change) continue;
    if (++found.count == 1) found.change = *change;
    if (found.count == 1) found.at = tick;
  }
  return found;
}

double changed(Tick tick) { return tick < 120'000 ? 0.9 : 1.5; }

// Nor does one that was never good: it is what it was.
TEST(ModelWatchTest, AModelThatHoldsRaisesNoAlarm) {
  for (const double gain : {1.0, 0.6}) {
    EXPECT_EQ(watch(900.0, [gain](Tick) { return gain; }).count, 0) << gain;
  }
}

TEST(ModelWatchTest, FindsAChangeSinceWhenItIsAndHowLarge) {
  const Found found = watch(240.0, changed);
  ASSERT_EQ(found.count, 1);
  EXPECT_GT(found.at, 120'000);
  EXPECT_LT(found.at, 200'000);
  // Blocks of 4 s: the change may begin within one, and the CUSUM leaves zero a few before or
  // after.
  EXPECT_NEAR(static_cast<double>(found.change.since), 120'000.0, 16'000.0);
  EXPECT_NEAR(found.change.share, 1.5 - 0.9, 0.06);
}

TEST(ModelWatchTest, WatchesOnlyWhileTheMotorCancels) {
  EXPECT_EQ(watch(240.0, changed, [](ModelWatch::Input& input) { input.acts = false; }).count, 0);
}

TEST(ModelWatchTest, AnotherModelIsLearntFromItsBeginning) {
  const auto another = [](ModelWatch::Input& input) { input.model = input.tick < 120'000 ? 0 : 1; };
  EXPECT_EQ(watch(240.0, changed, another).count, 0);
}

TEST(ModelWatchTest, LostTicksAndUnsoundSamplesAreNoChange) {
  Hand hand(400.0);
  ModelWatch sut(0.1);
  for (Tick tick = 0; tick < hand.ticks(); ++tick) {
    ModelWatch::Input input = hand.at(tick, 1.0);
    if (tick % 30'000 < 500) continue;
    if (tick % 30'000 == 10'000) input.theta_rad = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(sut.step(input)) << tick;
  }
}

}  // namespace
}  // namespace stillhand::cancellation::model_watch_test
