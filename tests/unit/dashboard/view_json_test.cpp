// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/view/view_json.hpp"

#include <gtest/gtest.h>

#include "tests/support/session_file.hpp"

namespace stillhand::dashboard::view_json_test {

constexpr std::int64_t kMs = 1'000'000;

// A status of the canceller, which reads `sensed` and something that nobody knows.
stillhand_msgs::ServiceStatus status(std::uint64_t samples, std::uint64_t cycle_misses) {
  stillhand_msgs::TopicStatus sensed, stranger;
  sensed.topic("stillhand/sensed");
  sensed.matched(1);
  sensed.samples(samples);
  sensed.cycle_misses(cycle_misses);
  sensed.latency_p99_us(321.0);
  stranger.topic("stranger");
  stillhand_msgs::ServiceStatus status;
  status.rig(1);
  status.service("cancellation");
  status.pid(7);
  status.topics().push_back(sensed);
  status.topics().push_back(stranger);
  return status;
}

class GraphJsonTest : public ::testing::Test {
 protected:
  template <typename Message_>
  void take(const topics::Topic& topic, const Message_& message, std::int64_t at_ms) {
    const auto source = sut_.add(
        {std::string(topic.name), std::string(topic.type), "stillhand/1/cancellation", false});
    const auto bytes = to_cdr(message);
    sut_.take({source, ++sequence_, at_ms * kMs, at_ms * kMs, bytes});
  }
  Json edge(const std::string& topic, const std::string& service) {
    const Json graph = graph_json(sut_);
    for (const Json& row : graph.at("topics")) {
      if (row.at("topic") != topic) continue;
      for (const Json& reader : row.at("readers")) {
        if (reader.at("service") == service) return reader;
      }
    }
    return {};
  }

  std::uint32_t sequence_ = 0;
  MessageFeed sut_{FeedOptions{}};
};

TEST_F(GraphJsonTest, HoldsTheCatalogueBeforeAnybodyIsThere) {
  EXPECT_EQ(edge("stillhand/sensed", "motion"), Json({{"service", "motion"}}));
  EXPECT_TRUE(edge("stillhand/sensed", "rig").is_null());
  const Json graph = graph_json(sut_);
  EXPECT_EQ(graph.dump().find("trial_assignment"), std::string::npos);  // it is blinded
  EXPECT_TRUE(graph.at("qos_mismatches").empty());
}

TEST_F(GraphJsonTest, AnEdgeIsLateByItsReadersOwnCountSinceThatGrew) {
  take(topics::kServiceStatus, status(100, 0), 1000);
  take(topics::kServiceStatus, status(200, 2), 1100);
  take(topics::kServiceStatus, status(300, 2), 1200);
  const Json reader = edge("stillhand/sensed", "cancellation");
  EXPECT_EQ(reader.at("cycle_misses"), 2);
  EXPECT_EQ(reader.at("matched"), 1);
  EXPECT_EQ(reader.at("latency_p99_us"), 321.0);
  EXPECT_EQ(reader.at("late"), Json({{"first_ms", 1100.0}, {"last_ms", 1100.0}}));
  EXPECT_TRUE(reader.at("lost").at("first_ms").is_null());
  EXPECT_EQ(graph_json(sut_).dump().find("stranger"), std::string::npos);
}

TEST_F(GraphJsonTest, AMismatchIsToldWithItsPolicyAndSinceWhen) {
  stillhand_msgs::Event event;
  event.rig(1);
  event.kind(stillhand_msgs::EVENT_INCOMPATIBLE_QOS);
  event.source("cancellation");
  event.topic("stillhand/sensed");
  event.text("RELIABILITY");
  take(topics::kEvent, event, 1500);
  take(topics::kEvent, event, 1600);
  const Json want{{"service", "cancellation"},
                  {"topic", "stillhand/sensed"},
                  {"policy", "RELIABILITY"},
                  {"since_ms", 1500.0}};
  EXPECT_EQ(graph_json(sut_).at("qos_mismatches"), Json::array({want}));
}

TEST(SpectrumJsonTest, IsNullWithoutASegmentAndFiniteNumbersWithOne) {
  ForceRecord record;
  EXPECT_TRUE(spectrum_json(record).is_null());
  for (Tick tick = 0; tick < 9000; ++tick) {
    record.measured(tick, tick % 100 < 50 ? 1.0 : -1.0);
    record.predicted(tick, 0.0);
  }
  const Json spectrum = spectrum_json(record);
  EXPECT_EQ(spectrum.at("segments"), 3);
  for (const Json& value : spectrum.at("residual_n2_hz")) EXPECT_TRUE(value.is_number());
}

}  // namespace stillhand::dashboard::view_json_test
