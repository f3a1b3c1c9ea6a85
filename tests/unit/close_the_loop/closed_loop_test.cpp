// SPDX-License-Identifier: Apache-2.0
// The order of the loop's trials and its ends, with a session that runs nothing.
#include "apps/close_the_loop/session/closed_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "apps/close_the_loop/session/session.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::close_the_loop::closed_loop_test {
namespace {

using testing::ElementsAre;

// Notes what it is asked for.
class NotedSession final : public Session {
 public:
  TrialRun run(const session::PlannedTrial& planned, const std::string& label) override {
    labels.push_back(label);
    EXPECT_EQ(label.substr(0, 1), session::name_of(planned.label));
    TrialRun run;
    run.label = label;
    run.number = planned.trial.number;
    run.metrics.rms_error_mm = label == "C'" ? followed_mm : 5.0;
    return run;
  }
  identification::FeedthroughModel identify(const TrialRun& pegged) override {
    identified.push_back(pegged.label);
    if (refuses) throw ConfigError("identification", "noise", "motion");
    identification::FeedthroughModel model;
    model.control = {1000.0, {-3.0, 0.5}, {1.0, -0.25}};
    return model;
  }
  std::string use(const cancellation::ControlModel& model) override {
    follows.push_back(model.adapts.has_value());
    return {};
  }

  bool refuses = false;
  std::vector<std::string> labels;
  std::vector<std::string> identified;
  double followed_mm = 5.0;   ///< error of C'
  std::vector<bool> follows;  ///< each model that was given
};

LoopOptions without_rounds() {
  LoopOptions options;
  options.protocol.conditions = session::parse_conditions("A,B,C");
  options.protocol.identify_s = 5.0;
  options.protocol.trial_s = 5.0;
  options.most_rounds = 0;
  return options;
}

TEST(ClosedLoopTest, IdentificationComesFirstAndEveryConditionOnce) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    NotedSession session;
    LoopOptions options = without_rounds();
    options.protocol.seed = seed;
    const LoopResult sut = close_loop(session, options);
    ASSERT_EQ(session.labels.size(), 5u);
    EXPECT_EQ(session.labels.front(), "I");
    EXPECT_EQ(session.labels.back(), "C'");
    EXPECT_EQ(std::set<std::string>(session.labels.begin(), session.labels.end()),
              (std::set<std::string>{"A", "B", "C", "C'", "I"}));
    EXPECT_THAT(session.identified, ElementsAre("I"));
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(sut.trials[i].label, session.labels[i]);
  }
}

TEST(ClosedLoopTest, ATrialIsFoundByItsLabel) {
  NotedSession session;
  const LoopResult sut = close_loop(session, without_rounds());
  for (const char* label : {"I", "A", "B", "C", "C'"}) EXPECT_EQ(sut.trial(label).label, label);
  std::set<std::int64_t> numbers;
  for (const TrialRun& each : sut.trials) numbers.insert(each.number);
  EXPECT_EQ(numbers.size(), 4u) << "no number is used twice, but C' is the trial of C again";
  EXPECT_EQ(sut.trial("C'").number, sut.trial("C").number);
}

TEST(ClosedLoopTest, ABetterFollowedModelIsTheYardstick) {
  NotedSession session;
  session.followed_mm = 4.0;
  const LoopResult sut = close_loop(session, without_rounds());
  EXPECT_THAT(session.follows, ElementsAre(true));
  EXPECT_TRUE(sut.control_model.adapts);
  EXPECT_TRUE(sut.followed_model.adapts);
}

TEST(ClosedLoopTest, WithoutARoundThePapersModelStays) {
  NotedSession session;
  const LoopResult sut = close_loop(session, without_rounds());
  EXPECT_TRUE(sut.rounds.empty());
  EXPECT_THAT(session.follows, ElementsAre(true, false)) << "C', then the paper's again";
  EXPECT_EQ(sut.control_model.denominator, (std::vector<double>{1.0, -0.25}));
  ASSERT_EQ(sut.control_model.inputs.size(), 1u);
  EXPECT_EQ(sut.control_model.inputs[0].numerator, (std::vector<double>{-3.0, 0.5}));
  EXPECT_FALSE(sut.control_model.adapts);
}

TEST(ClosedLoopTest, EveryTrialIsAnnouncedBeforeItRuns) {
  NotedSession session;
  LoopOptions options = without_rounds();
  std::vector<std::string> steps;
  options.progress = [&](const std::string& step) {
    EXPECT_EQ(steps.size(), session.labels.size());
    steps.push_back(step);
    return true;
  };
  static_cast<void>(close_loop(session, options));
  ASSERT_EQ(steps.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_TRUE(steps[i].ends_with(session.labels[i]));
}

TEST(ClosedLoopTest, AnInterruptEndsTheLoopBeforeTheNextTrial) {
  for (std::size_t after = 0; after < 5; ++after) {
    NotedSession session;
    LoopOptions options = without_rounds();
    options.progress = [&](const std::string&) { return session.labels.size() < after; };
    EXPECT_THROW(close_loop(session, options), diagnosis::Interrupted);
    EXPECT_EQ(session.labels.size(), after);
  }
}

TEST(ClosedLoopTest, AnInterruptEndsTheLoopBeforeTheDiagnosis) {
  NotedSession session;
  LoopOptions options = without_rounds();
  options.most_rounds = 3;
  std::string last;
  options.aside = [](const auto&) { FAIL() << "the diagnosis has begun"; };
  options.progress = [&](const std::string& step) {
    last = step;
    return session.labels.size() < 5;
  };
  EXPECT_THROW(close_loop(session, options), diagnosis::Interrupted);
  EXPECT_NE(last.find("diagnosis"), std::string::npos) << last;
  EXPECT_EQ(session.labels.size(), 5u);
}

TEST(ClosedLoopTest, AnIdentificationThatFailsEndsTheLoop) {
  NotedSession session;
  session.refuses = true;
  EXPECT_THROW(close_loop(session, without_rounds()), ConfigError);
  EXPECT_THAT(session.labels, ElementsAre("I"));
}

// A cursor 5 mm off, all the time: an error of 5 mm, within the box of +-15 mm.
TEST(ClosedLoopTest, MetricsAreThoseOfTargetAndCursor) {
  session::PlannedTrial planned{};
  planned.trial.duration_ticks = 10'000;
  recording::Recording measured;
  std::vector<double> target(10'000);
  for (std::size_t n = 0; n < target.size(); ++n) {
    measured.time_s.push_back(static_cast<double>(n) * 1e-3);
    target[n] = 0.02 * std::sin(1.3e-3 * static_cast<double>(n));
  }
  const auto metrics = [&](double off_m) {
    std::vector<double> cursor = target;
    for (double& x : cursor) x += off_m;
    measured.columns = {{"x_r", "m", target}, {"x_p", "m", cursor}};
    return metrics_of(measured, planned);
  };
  // Rounding of differences of numbers near 0.02 m: 1e-15 mm.
  EXPECT_NEAR(metrics(0.005).rms_error_mm, 5.0, 1e-9);
  EXPECT_EQ(metrics(0.005).dwell_ratio, 1.0);
  EXPECT_NEAR(metrics(-0.02).rms_error_mm, 20.0, 1e-9);
  EXPECT_EQ(metrics(-0.02).dwell_ratio, 0.0);
}

}  // namespace
}  // namespace stillhand::close_the_loop::closed_loop_test
