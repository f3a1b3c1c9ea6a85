// SPDX-License-Identifier: Apache-2.0
// The real bus on loopback: a tap hears every sample of the topics that it wants, until it stops.
#include "services/bus/tap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>
#include <vector>

#include "idl/control_loop.h"
#include "idl/session.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::runtime {
namespace {

using support::eventually;

constexpr const char* kProfiles = STILLHAND_SOURCE "/qos/profiles.xml";

class Listener {
 public:
  Listener()
      : tap_({"test-tap", support::own_domain(), kProfiles, "",
              [](const std::string& topic) { return topic != topics::kRigTruth.name; },
              [this](const FoundWriter& writer, const TappedSample& sample) {
                const std::lock_guard lock(mutex_);
                sequences_[writer.topic].push_back(sample.sequence);
                worst_ns_ = std::max(worst_ns_, std::abs(sample.logged_ns - sample.source_ns));
              }}) {
    tap_.start();
  }
  [[nodiscard]] std::vector<std::int64_t> sequences(const topics::Topic& topic) const {
    const std::lock_guard lock(mutex_);
    const auto found = sequences_.find(std::string(topic.name));
    return found == sequences_.end() ? std::vector<std::int64_t>{} : found->second;
  }
  [[nodiscard]] std::int64_t worst_ns() const {
    const std::lock_guard lock(mutex_);
    return worst_ns_;
  }
  Tap& tap() { return tap_; }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<std::int64_t>> sequences_;
  std::int64_t worst_ns_ = 0;
  Tap tap_;
};

// 1 to `count`
std::vector<std::int64_t> first(std::int64_t count) {
  std::vector<std::int64_t> all;
  for (std::int64_t sequence = 1; sequence <= count; ++sequence) all.push_back(sequence);
  return all;
}

TEST(TapTest, ItHearsEverySampleOfWhatItWantsUntilItStops) {
  constexpr std::size_t kTicks = 200;
  Listener sut;
  Bus::Options options;
  options.service = "rig";
  options.domain = support::own_domain();
  options.profiles = kProfiles;
  Bus bus(options);
  auto stream = bus.publisher<stillhand_msgs::RawSample>(topics::kRawSample);       // best effort
  auto other = bus.publisher<stillhand_msgs::RigTruth>(topics::kRigTruth);          // not wanted
  auto event = bus.publisher<stillhand_msgs::Event>(topics::kEvent);                // reliable
  auto state = bus.publisher<stillhand_msgs::TrialControl>(topics::kTrialControl);  // latched
  bus.start();
  const auto matched = [&bus](const topics::Topic& topic) {
    const auto all = bus.report();
    return std::ranges::find(all, &topic, &EndpointReport::topic)->matched;
  };
  ASSERT_TRUE(eventually([&] {
    return matched(topics::kRawSample) == 1 && matched(topics::kEvent) == 1 &&
           matched(topics::kTrialControl) == 1;
  }));
  stillhand_msgs::Event noted;
  stillhand_msgs::TrialControl control;
  // Best effort keeps few samples: the next one goes out once this one has come.
  for (std::size_t tick = 0; tick < kTicks; ++tick) {
    stillhand_msgs::RawSample sample;
    sample.tick(static_cast<Tick>(tick));
    stream.write(sample);
    stillhand_msgs::RigTruth truth;
    other.write(truth);
    if (tick % 50 == 0) event.write(noted);
    ASSERT_TRUE(eventually([&] { return sut.sequences(topics::kRawSample).size() > tick; }));
  }
  state.write(control);
  ASSERT_TRUE(eventually([&] { return !sut.sequences(topics::kTrialControl).empty(); }));
  ASSERT_TRUE(eventually([&] { return sut.sequences(topics::kEvent).size() == 4; }));
  EXPECT_EQ(sut.sequences(topics::kRawSample), first(kTicks));
  EXPECT_EQ(sut.sequences(topics::kEvent), first(4));
  EXPECT_EQ(sut.sequences(topics::kTrialControl), first(1));
  EXPECT_TRUE(sut.sequences(topics::kRigTruth).empty());
  EXPECT_EQ(sut.tap().unattributed(), 0u);
  EXPECT_EQ(sut.tap().trouble(), std::vector<std::string>());
  // Both stamps are of the system's clock.
  EXPECT_LT(sut.worst_ns(), 5 * kNsPerSecond);

  sut.tap().stop();
  // Once another has heard some, the first would have heard the sample before them.
  Listener running;
  ASSERT_TRUE(eventually([&] { return matched(topics::kRawSample) >= 1; }));
  ASSERT_TRUE(eventually([&] {
    stillhand_msgs::RawSample sample;
    stream.write(sample);
    return running.sequences(topics::kRawSample).size() >= 10;
  }));
  EXPECT_EQ(sut.sequences(topics::kRawSample).size(), kTicks);
}

}  // namespace
}  // namespace stillhand::runtime
