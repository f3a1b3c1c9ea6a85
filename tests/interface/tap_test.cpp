// SPDX-License-Identifier: Apache-2.0
// The real bus on loopback: a tap that reads in batches hears what one hears that Fast DDS feeds.
#include "services/bus/tap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <set>
#include <thread>
#include <tuple>

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

/// What does not depend on when the listener got its turn.
using Heard = std::tuple<std::string, std::int64_t, std::int64_t, std::vector<std::byte>>;

class Listener {
 public:
  explicit Listener(bool batched)
      : tap_({"test-tap", support::own_domain(), kProfiles, "", batched,
              [](const std::string& topic) { return topic != topics::kRigTruth.name; },
              [this](const FoundWriter& writer, const TappedSample& sample) {
                const std::lock_guard lock(mutex_);
                heard_.insert({writer.id,
                               sample.sequence,
                               sample.source_ns,
                               {sample.bytes.begin(), sample.bytes.end()}});
                worst_ns_ = std::max(worst_ns_, std::abs(sample.logged_ns - sample.source_ns));
              }}) {
    tap_.start();
  }
  [[nodiscard]] std::multiset<Heard> heard() const {
    const std::lock_guard lock(mutex_);
    return heard_;
  }
  [[nodiscard]] std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return heard_.size();
  }
  [[nodiscard]] std::int64_t worst_ns() const {
    const std::lock_guard lock(mutex_);
    return worst_ns_;
  }
  Tap& tap() { return tap_; }

 private:
  mutable std::mutex mutex_;
  std::multiset<Heard> heard_;
  std::int64_t worst_ns_ = 0;
  Tap tap_;
};

TEST(TapTest, ReadInBatchesItHearsTheSame) {
  constexpr std::size_t kTicks = 200;
  Listener plain(false), batched(true);
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
    return matched(topics::kRawSample) == 2 && matched(topics::kEvent) == 2 &&
           matched(topics::kTrialControl) == 2;
  }));
  // Best effort keeps few samples: the next one goes out once both have taken this one.
  std::size_t wanted = 0;
  for (std::size_t tick = 0; tick < kTicks; ++tick) {
    stillhand_msgs::RawSample sample;
    sample.tick(static_cast<Tick>(tick));
    stream.write(sample);
    stillhand_msgs::RigTruth truth;
    other.write(truth);
    if (tick % 50 == 0) {
      stillhand_msgs::Event told;
      told.text(std::string(100, 'x'));
      event.write(told);
      ++wanted;
    }
    ++wanted;
    ASSERT_TRUE(eventually([&] { return plain.count() >= wanted && batched.count() >= wanted; }));
  }
  stillhand_msgs::TrialControl control;
  state.write(control);
  const std::size_t all = kTicks + 4 + 1;
  ASSERT_TRUE(eventually([&] { return plain.heard().size() >= all; })) << plain.heard().size();
  ASSERT_TRUE(eventually([&] { return batched.heard().size() >= all; })) << batched.heard().size();
  EXPECT_EQ(plain.heard(), batched.heard());
  EXPECT_EQ(batched.tap().past_dds(), kTicks);
  EXPECT_EQ(plain.tap().past_dds(), 0u);
  EXPECT_EQ(batched.tap().unattributed(), 0u);
  EXPECT_EQ(batched.tap().trouble(), std::vector<std::string>());
  // The kernel's stamp is of the clock that the writer's is of.
  EXPECT_LT(batched.worst_ns(), 5 * kNsPerSecond);

  batched.tap().stop();
  const std::size_t before = batched.heard().size();
  // Another that reads in batches, too: once it has heard some, the first would have heard the
  // sample before them.
  Listener running(true);
  ASSERT_TRUE(eventually([&] { return matched(topics::kRawSample) >= 2; }));
  ASSERT_TRUE(eventually([&] {
    stillhand_msgs::RawSample sample;
    stream.write(sample);
    return running.heard().size() >= 10;
  }));
  EXPECT_EQ(batched.heard().size(), before);
}

}  // namespace
}  // namespace stillhand::runtime
